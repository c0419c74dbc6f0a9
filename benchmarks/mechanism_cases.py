"""Logs of RX60 arms with a mechanism on one joint, and of other motion over the same range."""

from dataclasses import dataclass, replace

import numpy as np

from benchmarks.diagnosis_cases import NOISE as UNIT
from benchmarks.diagnosis_cases import hidden_ratio, plain_motion
from benchmarks.mechanisms import MECHANISMS
from jaxswarm.effects.term import Term
from jaxswarm.identify.synthetic import demo_case, fourier_motion, synthetic_log
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import Filtering, Motion, prepare
from jaxswarm.robot import rx60

DURATION, RATE, NOISE = 20.0, 250.0, 0.2
_STRENGTHS = (4.0, 8.0, 16.0)
# Share of another motion that lies within the range of every joint on the first one.
_WITHIN = 0.9
# Every so many cases nothing is hidden.
_CLEAN = 4


class Hidden:
    """A drawn mechanism on a joint and its partner: its torque along any motion, (T, 3)."""

    def __init__(self, rng: np.random.Generator, name: str, q: np.ndarray):
        self.name, self.kind = name, MECHANISMS[name]
        self.joint = int(rng.integers(3))
        self.other = int((self.joint + 1 + rng.integers(2)) % 3)
        self.values = self.kind.draw(rng)
        self.size = 1.0
        if "q0" in self.values:
            way = q[:, self.other if self.kind.place_on_other else self.joint]
            middle, half = 0.5 * (way.max() + way.min()), 0.5 * np.ptp(way)
            self.values["q0"] = middle + half * self.values["q0"]

    @property
    def acts_on(self) -> tuple[int, ...]:
        """Joints that feel it."""
        return (self.joint,) if self.kind.also_on_other is None else (self.joint, self.other)

    def torque(self, q: np.ndarray, dq: np.ndarray) -> np.ndarray:
        """Its torque on all joints, (T, 3)."""
        full = np.zeros_like(q)
        j, o = self.joint, self.other
        args = (self.values, q[:, j], dq[:, j], q[:, o], dq[:, o])
        full[:, j] = self.kind.torque(*args)
        if self.kind.also_on_other is not None:
            full[:, o] = self.kind.also_on_other(*args)
        return self.size * full


@dataclass(frozen=True)
class Prepared:
    """A case ready to be diagnosed.

    Attributes:
        blank: The declared terms.
        hidden: The mechanism; None: nothing is hidden.
        log, elsewhere: The log that is diagnosed, and one of another motion.
        extra: The mechanism's torque on the first, (T, 3).
        train: The first, filtered.
        state, state_elsewhere: Position and velocity of both without noise, each (T, 3).
    """

    blank: tuple[Term, ...]
    hidden: Hidden | None
    log: Log
    elsewhere: Log
    extra: np.ndarray
    train: Motion
    state: tuple[np.ndarray, np.ndarray]
    state_elsewhere: tuple[np.ndarray, np.ndarray]

    def like(
        self, filtering: Filtering, channel: str = "tau_clean", without: Hidden | None = None
    ) -> tuple[Motion, Motion]:
        """The other motion as measured, and with one of its channels for torque, filtered as a model wants.

        That channel comes without the torque of a mechanism, if one is given.
        """
        quiet = self.elsewhere.channels[channel]
        if without is not None:
            quiet = quiet - without.torque(*self.state_elsewhere)
        clean = replace(self.elsewhere, tau=quiet)
        return prepare(self.elsewhere, filtering), prepare(clean, filtering)


def prepared_case(number: int) -> Prepared:
    """Draw the arm, the motions and the mechanism of a case."""
    rng = np.random.default_rng(number)
    arm, declared, _ = demo_case(rx60(), number)
    hidden = None
    if number % _CLEAN != _CLEAN - 1:
        names = list(MECHANISMS)
        hidden = Hidden(rng, names[(number - number // _CLEAN) % len(names)], _motion(number)[1])
        _scale(hidden, arm, declared, number, float(rng.choice(_STRENGTHS)))
    log, extra = _log(arm, declared, hidden, number)
    beyond = _elsewhere(number)
    elsewhere, _ = _log(arm, declared, hidden, beyond)
    blank = tuple(replace(t, values={}) for t in declared)
    states = (_motion(seed)[1:3] for seed in (number, beyond))
    return Prepared(blank, hidden, log, elsewhere, extra, prepare(log), *states)


def _motion(seed: int):
    return fourier_motion(3, np.random.default_rng(seed), DURATION, RATE)


def _elsewhere(seed: int) -> int:
    """Seed of another motion over the same range of all joints."""
    own = _motion(seed)[1]
    low, high = own.min(axis=0), own.max(axis=0)
    others = (seed + 10_000 * k for k in range(1, 500))

    def within(other: int) -> float:
        q = _motion(other)[1]
        return float(((q > low) & (q < high)).mean(axis=0).min())

    return next((one for one in others if within(one) > _WITHIN), seed + 10_000)


def _log(arm, declared, hidden: Hidden | None, seed: int) -> tuple[Log, np.ndarray]:
    """A log with the mechanism, and the mechanism's torque (T, 3)."""
    log = synthetic_log(arm, declared, seed, duration=DURATION, rate=RATE, motion_seed=seed)
    _, q, dq, _ = _motion(seed)
    extra = np.zeros_like(q) if hidden is None else hidden.torque(q, dq)
    plain = log.channels["tau_clean"]
    channels = {"tau_clean": plain + extra, "tau_told": plain}
    return replace(log, tau=log.tau + extra, channels=channels), extra


def _scale(hidden: Hidden, arm, declared, seed: int, strength: float) -> None:
    """Make what the declared model cannot imitate of the mechanism so many times the noise."""
    log = synthetic_log(arm, declared, seed, duration=DURATION, rate=RATE, motion_seed=seed)
    state = _motion(seed)[1:]
    ratio = hidden_ratio(arm, declared, plain_motion(log, state), hidden.torque(*state[:2]))
    hidden.size = strength * NOISE / float((ratio * UNIT).max())
