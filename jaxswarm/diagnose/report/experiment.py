r"""Which motion would tell two rivals apart: both are simulated on candidate motions, the best is named.

Two models that predict the same on the log differ elsewhere. Each candidate motion is run through both;
the one on which their torques differ most, in units of the torque's noise, is the experiment to make.
This is design for discrimination (W. G. Hunter, A. M. Reiner, Technometrics 7 (1965)).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.excitation.columns import plannable
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.logs.filtering import Decimator, derivatives
from jaxswarm.logs.motion import Motion

_RATE = 250.0
# A difference below the first multiple of the noise is not seen in a log; one below the second is rounding.
_TOLD, NO_MOTION = 0.5, 0.01


@dataclass(frozen=True)
class Experiment:
    """A motion that separates two models.

    Attributes:
        text: What to do, in words.
        ratio: RMS difference of the two torques over the noise, on the joint that shows most.
        joint: That joint's index.
    """

    text: str
    ratio: float
    joint: int

    def words(self, joints: Sequence[str]) -> str:
        """Which motion would tell the two apart, or that none within the log's ranges, or none at all, does."""
        if self.ratio < NO_MOTION:
            return (
                "no motion does, they say the same of all: measure what one of them is about by itself, with a "
                "weighed load, a second sensor or the setting of the drive"
            )
        if self.ratio < _TOLD:
            return (
                f"no motion within the ranges of this log tells them (at most {self.ratio:.2g} times the "
                f"torque noise); move {joints[self.joint]} further or faster"
            )
        return (
            f"{self.text}: there the two differ by {self.ratio:.1f} times the torque noise on "
            f"{joints[self.joint]}"
        )


def best_experiment(one: Model, other: Model, motion: Motion, joint: int | None) -> Experiment:
    """Simulate both models on every candidate motion and return the most telling one.

    Args:
        one, other: Models that the log does not tell apart.
        motion: The log, for ranges and the noise.
        joint: The joint in question; None: the arm as a whole.
    """
    noise = np.maximum(motion.sensor_noise, 1e-12)
    best = None
    for text, trial in _candidates(motion, joint):
        apart = model_torque(one, trial) - model_torque(other, trial)
        # A constant or what a refit would absorb at once does not count: only what varies.
        ratio = np.std(apart, axis=0) / noise
        where = int(np.argmax(ratio))
        if best is None or ratio[where] > best.ratio:
            best = Experiment(text, float(ratio[where]), where)
    assert best is not None  # every joint can be moved
    return best


def separating_command(one: Term, other: Term, joints: tuple[str, ...]) -> str:
    """The command that plans a better motion, as the end of a sentence; empty where it cannot."""
    if not all(plannable(term, joints, load_known=True) for term in (one, other)):
        return ""
    pair = f"{one.label(joints)},{other.label(joints)}"
    return (
        "; the best motion within the limits of the robot plans: jaxswarm excite --robot ROBOT "
        f"--limits LIMITS.toml --separate {pair} --given model.json --out DIR"
    )


def _candidates(motion: Motion, joint: int | None):
    """Motions an engineer can command, within the ranges of the log."""
    names = motion.joints
    low, high = motion.q.min(axis=0), motion.q.max(axis=0)
    middle, half = 0.5 * (low + high), 0.45 * (high - low)
    top = np.abs(motion.dq).max(axis=0)
    picked = range(len(names)) if joint is None else [joint]
    for j in picked:
        for share in (0.02, 0.1, 0.4, 0.9):
            speed = max(share * top[j], 1e-4)
            period = 4.0 * max(half[j], 1e-3) / speed
            t = np.arange(0, min(max(period, 8.0), 60.0), 1 / _RATE)
            wave = half[j] * (2 / np.pi) * np.arcsin(0.999 * np.sin(2 * np.pi * t / period))
            yield (
                f"move {names[j]} alone back and forth over {2 * half[j]:.2g} at a constant "
                f"{speed:.2g} per second, {t[-1]:.0f} s",
                _motion(motion, t, middle, {j: wave}),
            )
        t = np.arange(0, 20.0, 1 / _RATE)
        small = min(0.02, 0.2 * max(half[j], 1e-3))
        yield (
            f"reverse {names[j]} alone by {2 * small:.2g} twice a second for 20 s",
            _motion(motion, t, middle, {j: small * np.sin(4 * np.pi * t)}),
        )
        beat = half[j] * np.sin(2 * np.pi * t * top[j] / (2 * np.pi * max(half[j], 1e-3)))
        yield (
            f"swing {names[j]} alone at full speed for 20 s",
            _motion(motion, t, middle, {j: beat}),
        )
        posed = {i: (half[i] if i != j else half[j] * np.sin(0.8 * t)) for i in range(len(names))}
        yield (
            f"swing {names[j]} slowly with the other joints held at the end of their range",
            _motion(motion, t, middle, posed),
        )
    t = np.arange(0, 300.0, 10 / _RATE)
    warm = {i: half[i] * np.sin(2 * np.pi * t * (0.11 + 0.03 * i)) for i in range(len(names))}
    yield (
        "repeat one motion of all joints for five minutes from cold",
        _motion(motion, t, middle, warm),
    )
    t = np.arange(0, 20.0, 1 / _RATE)
    fast = {
        i: half[i] * np.sin(2 * np.pi * t * top[i] / (2 * np.pi * max(half[i], 1e-3)))
        for i in range(len(names))
    }
    yield "swing all joints at full speed for 20 s", _motion(motion, t, middle, fast)


def _motion(log: Motion, t: np.ndarray, middle: np.ndarray, waves: dict) -> Motion:
    q = np.tile(middle, (len(t), 1))
    for j, wave in waves.items():
        q[:, j] += wave
    dq, ddq = derivatives(q, 1.0 / (t[1] - t[0]), 2)
    return replace(
        log, t=t, q=q, dq=dq, ddq=ddq, tau=None, channels={}, decimator=Decimator(np.ones(1), 1)
    )
