r"""Simulated logs with one effect that is not declared, none, or one that no catalog holds.

The size of an effect is its ratio: RMS of its torque, orthogonal to what the declared model can absorb (and the
law that it extends, if it does), over the white torque noise of its joint. A case is visible at a ratio of one
half. Amplitudes are solved for from the wanted ratio; soft joints and backlash come from the forward simulation
with fixed parameters.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import jax.numpy as jnp
import numpy as np
from scipy import signal

from benchmarks.diagnosis_drawn import BETWEEN_TWO, DRAWN, KNOWN, LATER, WHOLE_ARM, Drawn
from benchmarks.diagnosis_misread import SILENT, extended_misreadings
from benchmarks.diagnosis_rests import halting_motion
from benchmarks.diagnosis_soft import closed_loop
from jaxswarm.effects.base import REGISTRY
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.measuring_chain import assemble
from jaxswarm.identify.synthetic import fourier_motion, random_links, synthetic_log
from jaxswarm.logs.filtering import Decimator
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import Motion
from jaxswarm.robot import Robot, rx60

NOISE = np.array([0.25, 0.30, 0.15])
WIDTH = 0.01
VISIBLE = 0.5
RATIOS = (0.25, 0.5, 1.0, 3.0, 10.0)


# Softness [N m/rad, N m s/rad] and dead zone [rad], mild to severe.
SOFT = {
    "joint_elasticity": [
        {"k": k, "d": 0.02 * np.sqrt(k) * 5} for k in (6e3, 3e3, 1500.0, 700.0, 350.0)
    ],
    "backlash": [{"gap": g} for g in (1e-3, 2e-3, 5e-3, 1e-2, 2e-2)],
}
# The same for springs that harden, by the twist of twice the torque: from far beyond the usual one.
STIFFENING = {
    "hardening_elasticity": [
        {"k": 3e3, "eh": twist, "d": 5.0} for twist in (0.04, 0.02, 0.01, 0.005, 0.0025)
    ]
}
SPRUNG = SOFT | STIFFENING
UNLISTED = ("position_friction", "crossed_velocity", "position_viscous")
CLEAN = ("white", "colored", "quantized")


@dataclass(frozen=True)
class Case:
    """One log to make: effect, its level (index), joint, noise level and seed; or times the visible ratio."""

    effect: str
    level: int
    joint: int
    noise: float
    seed: int
    times: float | None = None

    @property
    def name(self) -> str:
        return f"{self.effect}-{self.level}-{self.joint}-{self.noise:g}-{self.seed}"


def all_cases(fast: bool) -> list[Case]:
    """All cases of the suite, or about twenty of them."""
    hidden = [*DRAWN, "asymmetric_friction", *SOFT]
    cases = []
    if fast:
        cases += [Case(e, 3, _joint(e, 1 + k), 1.0, k) for k, e in enumerate(hidden)]
        cases += [Case(c, 0, 0, 1.0, 50 + k) for k, c in enumerate(CLEAN)]
        cases += [Case(u, 3, 1, 1.0, 60 + k) for k, u in enumerate(UNLISTED)]
        return cases + [Case(e, 3, 1, 1.0, 70 + k) for k, e in enumerate(STIFFENING)]
    for number, (repeat, level, effect) in enumerate(product(range(5), range(5), hidden)):
        noise = (1.0, 0.5, 2.0)[repeat % 3]
        cases.append(Case(effect, level, _joint(effect, repeat), noise, 1000 + number))
    cases += [Case(CLEAN[k % 3], 0, 0, (1.0, 0.5, 2.0)[k // 3 % 3], 3000 + k) for k in range(210)]
    cases += [
        Case(u, 2 + k % 3, k % 3, 1.0, 4000 + 100 * i + k)
        for i, u in enumerate(UNLISTED)
        for k in range(20)
    ]
    cases += [
        Case(e, k % 5, _joint(e, k // 5), 1.0, 5000 + k) for e in STIFFENING for k in range(25)
    ]
    return cases


def _joint(effect: str, k: int) -> int:
    """Joint 1 of an upright arm carries no gravity, and its rotor merges with its link."""
    if effect in ("load_dependent_friction", "rotor_inertia", "drive_gain", *SPRUNG):
        return 1 + k % 2
    return k % 3


def make_arm(rng: np.random.Generator) -> tuple[Robot, tuple[Term, ...]]:
    """An arm with random links, and the friction its user declares."""
    arm = rx60().replace(parameters=jnp.asarray(random_links(rx60(), rng)))
    declared = tuple(
        Term(effect, j, values={symbol: float(rng.uniform(3.0, 6.0) / (1 + j))})
        for effect, symbol in (("viscous_friction", "b"), ("coulomb_friction", "fc"))
        for j in range(3)
    )
    return arm, declared


def plain_motion(log: Log, state: tuple | None = None) -> Motion:
    """A noise-free log without filtering."""
    q, dq, ddq = state
    low = Decimator(np.ones(1), 1)
    return Motion(
        log.source, log.joints, log.t, q, dq, ddq, log.tau, {}, low, np.inf, np.inf, 0.004, None
    )


def hidden_ratio(
    arm: Robot, declared, motion: Motion, clean: np.ndarray, beside: Sequence[np.ndarray] = ()
) -> np.ndarray:
    """RMS of the part of a torque that the declared model cannot absorb, over the noise, (3,).

    Nor can it with what is given ``beside``, torques (T, 3) of any size.
    """
    pi = np.asarray(arm.parameters).ravel()
    columns = assemble(arm, declared, motion, (WIDTH,) * arm.num_joints, pi)
    columns = np.concatenate([columns, *(x[:, :, None] for x in beside)], axis=2) / NOISE[:, None]
    flat = columns[::4].reshape(-1, columns.shape[2])
    target = (clean / NOISE)[::4].reshape(-1)
    scale = np.maximum(np.linalg.norm(flat, axis=0), 1e-12)
    left = target - flat / scale @ np.linalg.lstsq(flat / scale, target, rcond=1e-10)[0]
    return np.sqrt((left.reshape(-1, 3) ** 2).mean(axis=0))


def make_case(case: Case) -> tuple[Robot, tuple[Term, ...], tuple[Term, ...], Log, np.ndarray]:
    """Arm, declared terms, hidden terms, log, and the ratio per joint for noise of this level."""
    rng = np.random.default_rng(case.seed)
    arm, declared = make_arm(rng)
    if case.effect == "coulomb_friction":
        declared = tuple(t for t in declared if (t.effect, t.joint) != (case.effect, case.joint))
    if case.effect in SPRUNG:
        soft = Term(case.effect, case.joint, values=SPRUNG[case.effect][case.level])
        rotor = Term("rotor_inertia", case.joint, values={"ia": 0.5})
        hidden, declared = (soft,), (*declared, rotor)
        log, state = closed_loop(arm, (*declared, soft), WIDTH, case.seed)
        motion = plain_motion(log, state)
    else:
        moved = _motion(case)
        log = synthetic_log(arm, declared, case.seed, noise=SILENT, moved=moved)
        motion = plain_motion(log, moved[1:])
        hidden, log = _sized(case, arm, declared, motion, log, rng)
    ratio = hidden_ratio(arm, declared, motion, log.tau) / case.noise
    return arm, declared, hidden, noisy(case, log, rng), ratio


def _motion(case: Case) -> tuple[np.ndarray, ...]:
    """Random motion of three joints; with rests where the effect shows after them alone."""
    law = REGISTRY.get(case.effect)
    make = halting_motion if law is not None and law.rests else fourier_motion
    return make(3, np.random.default_rng(case.seed))


def _sized(case, arm, declared, motion, base, rng):
    """The hidden term with its amplitude solved for from the wanted ratio."""
    if case.effect in CLEAN:
        return (), base
    wanted = (RATIOS[case.level] if case.times is None else case.times * VISIBLE) * case.noise
    if case.effect in UNLISTED:
        j, q, dq = case.joint, motion.q, motion.dq
        sign = np.tanh(dq[:, j] / WIDTH)
        shape = {
            "position_friction": np.cos(2.0 * q[:, j]) * sign,
            "crossed_velocity": np.sin(2.0 * q[:, (j + 1) % 3]) * sign,
            "position_viscous": np.sin(2.5 * q[:, j] + 0.4) * dq[:, j],
        }[case.effect]
        extra = np.zeros_like(base.tau)
        extra[:, j] = shape
        one = hidden_ratio(arm, declared, motion, extra).max()
        return (), replace(base, tau=base.tau + extra * wanted / one)

    def log_with(size):
        terms = _terms(case, declared, drawn, size)
        return terms, synthetic_log(arm, terms, case.seed, noise=SILENT, moved=moved)

    moved = (base.t, motion.q, motion.dq, motion.ddq)
    hidden = KNOWN.get(case.effect, Drawn("", {}))
    drawn = {k: draw(rng) for k, draw in hidden.others.items()}
    size = hidden.size
    told = (*declared, *_extended(case, drawn))
    beside = extended_misreadings(case.effect, arm, declared, base, moved)
    for _ in range(3):
        terms, log = log_with(size)
        ratio = hidden_ratio(arm, told, motion, log.tau, beside).max()
        if ratio < 1e-3 * size:  # the declared model absorbs it whatever its size
            break
        size = min(size * wanted / ratio, hidden.most)
    terms, log = log_with(size)
    return tuple(t for t in terms if t.effect == case.effect and t.joint in (case.joint, None)), log


def _extended(case, drawn) -> tuple[Term, ...]:
    """The law beside which alone a law is asked: only what it adds to that one tells it."""
    name = next(iter(REGISTRY[case.effect].extends if case.effect in LATER else ()), "")
    if not isinstance(REGISTRY.get(name), TorqueLaw):
        return ()
    usual = REGISTRY[name].nominal()
    return (Term(name, case.joint, values={k: drawn.get(k, v) for k, v in usual.items()}),)


def _terms(case, declared, drawn, size):
    if case.effect == "asymmetric_friction":
        old = {t.effect: t for t in declared if t.joint == case.joint}
        b, fc = old["viscous_friction"].values["b"], old["coulomb_friction"].values["fc"]
        values = {"fc_pos": fc, "fc_neg": fc, "b_pos": b + size, "b_neg": b}
        return (
            *(t for t in declared if t.joint != case.joint),
            Term(case.effect, case.joint, values=values),
        )
    amplitude = KNOWN[case.effect].amplitude
    value = 1.0 + size if amplitude == "gain" else size
    joint = None if case.effect in WHOLE_ARM else case.joint
    other = (case.joint + 1) % 3 if case.effect in BETWEEN_TWO else None
    values = {**drawn, amplitude: value}
    return (*declared, Term(case.effect, joint, other, values))


def noisy(case: Case, log: Log, rng: np.random.Generator) -> Log:
    """Sensor noise: white; colored torque; or quantized position and torque."""
    sd = NOISE * case.noise
    q = log.q + rng.normal(size=log.q.shape) * 2e-5
    white = rng.normal(size=log.q.shape) * sd
    if case.effect == "colored":
        white = signal.lfilter([np.sqrt(1 - 0.9**2)], [1.0, -0.9], white, axis=0)
    tau = log.tau + white
    if case.effect == "quantized":
        q = np.round(log.q / 2e-4) * 2e-4
        tau = np.round((log.tau + 0.3 * white) / (2 * sd)) * 2 * sd
    return replace(log, q=q, tau=tau)
