"""World ``k``: everything drawn from its number, its runs, and what is true of them.

A draw is thrown away, and the next one of the same number taken, if a run diverges (tracking error beyond
0.5 rad or 0.1 m), or if a torque is beyond ``SANE`` times the joint's RMS torque of usual motion.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from benchmarks.worlds import control, motion
from benchmarks.worlds.along import effect_torques
from benchmarks.worlds.arm import Arm
from benchmarks.worlds.families import draw_arm, joint_scales
from benchmarks.worlds.laws import EVENTS, LAWS, Effect
from benchmarks.worlds.place import allowed_friction, place_effects
from benchmarks.worlds.plan import Plan, plan
from benchmarks.worlds.record import Logging, draw_logging, quantum, record
from benchmarks.worlds.simulate import DivergedError, Run, simulate
from benchmarks.worlds.strength import (
    STRENGTHS,
    Ground,
    make_ground,
    size_effect,
    strengths,
)

SEED = 20261
SANE = 15.0
_ATTEMPTS = 30
# The drive interpolates its encoder this many bits finer than the logger stores.
DRIVE_BITS = 4
SCORED_SECONDS = 12.0
# Worlds whose user has a second log, of other motion, to validate on.
_SHARE_CHECKED = 1 / 3
_SHARE_OF_FRICTION = 0.8


@dataclass(frozen=True)
class World:
    """One world with its runs: training, two tests, and where there is one the user's second log."""

    number: int
    attempt: int
    plan: Plan
    arm: Arm
    declared: tuple[tuple[str, int], ...]
    effects: tuple[Effect, ...]
    control: control.Control
    logging: Logging
    motions: dict[str, motion.Motion]
    runs: dict[str, Run]
    told: list[dict]

    @cached_property
    def compliance(self) -> np.ndarray:
        return joint_scales(self.arm)[0] - self.arm.rotor

    def present(self, name: str) -> tuple[Effect, ...]:
        """The effects in a run: a contact or a load happens in the training run alone."""
        return tuple(e for e in self.effects if name == "train" or e.kind not in EVENTS)

    @property
    def edited(self) -> Effect | None:
        """The effect that the edit test deletes: the last that is there in a test run."""
        return next(reversed(self.present("test_ptp")), None)

    def run(self, name: str, effects: tuple[Effect, ...] | None = None) -> Run:
        """A run of one of the motions, with these effects in place of all."""
        effects = self.present(name) if effects is None else effects
        step = quantum(self.logging, self.arm) / 2**DRIVE_BITS
        return simulate(self.arm, effects, self.control, self.motions[name], step, self.compliance)

    def log(self, name: str, run: Run, effects: tuple[Effect, ...] | None = None):
        """A run as logged, and its hidden channels; training logs with all defects of the logger."""
        effects = self.present(name) if effects is None else effects
        torque = effect_torques(self.arm, run, effects).sum(axis=0)
        rng = np.random.default_rng([SEED, self.number, len(effects), *name.encode()])
        plain = name != "train"
        return record(run, self.arm, effects, self.logging, self.control, torque, rng, plain)


def make_world(number: int, longest: float | None = None, held: bool = False) -> World:
    """The first draw of this number that can be run.

    Args:
        number: Of the world.
        longest: Time [s] at which its training run ends, which is then its only one; None: as drawn.
        held: Whether dry friction holds joints at rest.
    """
    for attempt in range(_ATTEMPTS):
        try:
            return _draw(number, attempt, longest, held)
        except DivergedError:
            continue
    raise RuntimeError(f"world {number}: no draw of {_ATTEMPTS} could be run")


def _draw(number: int, attempt: int, longest: float | None, held: bool) -> World:
    rng = np.random.default_rng([SEED, number, attempt])
    # What the world is about must not depend on the attempt, or hard worlds would become rare.
    wanted = plan(number, np.random.default_rng([SEED, number]))
    arm = allowed_friction(replace(draw_arm(rng), held=held), wanted)
    arm, declared, effects = place_effects(rng, arm, wanted)
    torque = joint_scales(arm)[1]
    bandwidth = 2 * np.pi * rng.uniform(3.0, 7.0)
    kind, rate = str(rng.choice(control.KINDS)), int(rng.choice(control.RATES))
    drive = control.Control(kind, rate, int(rng.integers(2**31)), bandwidth)
    logger = draw_logging(rng, drive, torque)
    seeds = rng.integers(2**31, size=3)
    seconds = round(float(np.exp(rng.uniform(np.log(8.0), np.log(60.0)))), 1)
    seconds = seconds if longest is None else min(seconds, longest)
    motions = {
        "train": motion.Motion(str(rng.choice(motion.FAMILIES)), int(seeds[0]), seconds),
        "test_ptp": motion.Motion("ptp", int(seeds[1]), SCORED_SECONDS),
        "test_fourier": motion.Motion("fourier", int(seeds[2]), SCORED_SECONDS),
    }
    world = World(number, attempt, wanted, arm, declared, (), drive, logger, motions, {}, [])
    run = world.run("train")
    _check(run, torque)
    ground = make_ground(world, run)
    if effects:
        arm, effects = _sized(rng, ground, effects, seconds)
        if wanted.declared == "nothing":
            arm, effects = _dry_friction_told(arm, effects)
        world = replace(world, arm=arm, effects=effects)
        run = world.run("train")
        _check(run, torque)
    told = strengths(world, run, ground.unit)
    if rng.random() < _SHARE_CHECKED:
        check = motion.Motion(str(rng.choice(motion.FAMILIES)), int(rng.integers(2**31)), seconds)
        motions["check"] = check
    runs = {"train": run}
    if longest is not None:
        return replace(world, runs=runs, told=told)
    for name in (n for n in motions if n != "train"):
        runs[name] = world.run(name)
        _check(runs[name], torque)
    return replace(world, runs=runs, told=told)


def _check(run: Run, torque: np.ndarray) -> None:
    if not np.isfinite(run.tau).all() or (np.abs(run.tau) > SANE * torque).any():
        raise DivergedError


def _sized(rng, ground: Ground, effects, seconds: float):
    """The effects with drawn strengths, at times within the run; the arm with enough dry friction."""
    arm, sized = ground.arm, []
    for effect in effects:
        p = dict(effect.params)
        if effect.kind == "contact":
            start = rng.uniform(0.1 * seconds, 0.9 * seconds - p["seconds"])
            p = {"start": start, "end": start + p["seconds"], "tau": p["tau"]}
        if effect.kind == "payload_change":
            p |= {name: p[name] * seconds for name in ("start", "end")}
        if effect.kind == "friction_change":
            p["start"] = p["start"] * min(seconds, SCORED_SECONDS)
        effect = replace(effect, params=p)
        if len(effects) >= 2 * arm.size and effect.kind in ("viscous_friction", "coulomb_friction"):
            sized.append(effect)  # common friction keeps its own size
            continue
        effect = size_effect(effect, float(rng.choice(STRENGTHS)), ground)
        sized.append(effect)
        if LAWS[effect.kind].resists:
            needed = effect.params["fc"] / _SHARE_OF_FRICTION
            own = np.arange(arm.size) == effect.joint
            arm = replace(arm, coulomb=np.where(own, np.maximum(arm.coulomb, needed), arm.coulomb))
    return arm, tuple(sized)


def _dry_friction_told(arm: Arm, effects) -> tuple[Arm, tuple[Effect, ...]]:
    """The arm without dry friction, and the effects with it: what is not declared is an effect."""
    told = []
    for joint in np.flatnonzero(arm.coulomb):
        own = ("coulomb_friction", joint)
        there = sum(e.params["fc"] for e in effects if (e.kind, e.joint) == own)
        told.append(
            Effect("coulomb_friction", int(joint), params={"fc": float(arm.coulomb[joint] + there)})
        )
        effects = tuple(e for e in effects if (e.kind, e.joint) != own)
    return replace(arm, coulomb=np.zeros(arm.size)), (*effects, *told)
