r"""Smooth functions of one or two variables of a log, and what part of a residual they predict.

Features are :math:`\cos(\omega^T x + \varphi)` with x standardized (A. Rahimi, B. Recht, NIPS 2007), weighted
as the rows of a joint and freed of what the model absorbs.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jaxswarm.diagnose.decision.significance import slope_p_value
from jaxswarm.diagnose.folds.joint_rows import RIDGES, JointRows
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.smooth import features

# Features of one and two variables; and how many times as narrow, and of how many more, those of a joint's own
# position and velocity are once more: what sits at one place, a magnet of 0.15 rad on 1.3 rad of motion, is
# half hidden from functions as wide as the motion, and laws of the catalog stood in for it. Of one of 0.07 rad
# 48 functions four times as narrow told nothing on blocks held out, 96 eight times as narrow 0.96.
_FEATURES = {1: 14, 2: 96}
_NARROW, _OF_NARROW = 8.0, 96
# Range below which a variable is a constant.
VARIES = 1e-9
# Part of all samples at either end of a variable that count as the last value before: half of a log says
# nothing of velocities that only the other half reaches, and a few of these hid a function of the velocity that
# was 0.98 of what was left (0.47 of it found on held-out blocks, p = 0.004; without them 0.82, p = 7e-7).
_TAIL = 0.01


class Variable(NamedTuple):
    """A variable as logged, standardized within its range, and its smooth sign where it may jump at zero."""

    raw: np.ndarray
    standard: np.ndarray
    side: np.ndarray | None
    lower: float
    upper: float


class SmoothOf(NamedTuple):
    """What a smooth function is one of, and whether it may be narrow."""

    names: tuple[str, ...]
    narrow: bool = False


def residual_variables(found: Estimate) -> dict[str, np.ndarray]:
    """Everything a residual may depend on, on the decimated clock: name to (T,)."""
    joints = found.model.robot.joints
    names: dict[str, list] = {}
    for motion in found.motions:
        low = motion.decimator
        kept = low.kept(len(motion.t))
        for j, joint in enumerate(joints):
            names.setdefault(f"q_{joint}", []).append(motion.q[kept, j])
            names.setdefault(f"dq_{joint}", []).append(motion.dq[kept, j])
            names.setdefault(f"ddq_{joint}", []).append(motion.ddq[kept, j])
            heat = motion.channels.get("temperature")
            if heat is not None and heat.ndim == 2 and np.isfinite(heat[:, j]).all():
                names.setdefault(f"temperature_{joint}", []).append(heat[kept, j])
        names.setdefault("t", []).append(motion.t[kept])
    return {name: np.concatenate(parts) for name, parts in names.items()}


def table_of(found: Estimate) -> dict[str, Variable]:
    """All variables that vary."""
    joints = found.model.robot.joints
    width = {f"dq_{j}": w for j, w in zip(joints, found.model.width, strict=True)}
    variables = {n: x for n, x in residual_variables(found).items() if np.ptp(x) > VARIES}
    # A velocity also enters by its direction: friction jumps at zero.
    return {n: variable(x, width.get(n)) for n, x in variables.items()}


def load_of(found: Estimate, joint: int) -> dict[str, Variable]:
    """The torque of the rigid body on a joint [N m or N], by its name; nothing where it is constant."""
    robot = found.model.robot
    rigid = slice(10 * robot.num_joints)
    torque = found.regression.columns[:, joint, rigid] @ found.fit.theta[rigid]
    return (
        {f"load_{robot.joints[joint]}": variable(torque, None)} if np.ptp(torque) > VARIES else {}
    )


def variable(x: np.ndarray, width: float | None) -> Variable:
    """A variable (T,), with the width of its sign if it is a velocity."""
    lower, upper = np.quantile(x, [_TAIL, 1.0 - _TAIL])
    standard = (np.clip(x, lower, upper) - x.mean()) / max(x.std(), 1e-12)
    return Variable(x, standard, None if width is None else np.tanh(x / width), lower, upper)


def waves_of(of: SmoothOf, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and phases of the features."""
    rng, count = np.random.default_rng(seed), len(of.names)
    size = _OF_NARROW if of.narrow else _FEATURES[count]
    frequency = rng.normal(scale=_NARROW if of.narrow else 1.0, size=(count, size))
    return frequency, rng.uniform(0, 2 * np.pi, size)


def smooth_rows(inputs: list[Variable], waves: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Features (T, f) of one or two variables."""
    x = np.stack([one.standard for one in inputs], axis=1)
    sides = [one.side for one in inputs if one.side is not None]
    return features(x, sides, *waves)


class Share(NamedTuple):
    """Share of a joint's squared error held out that a smooth function takes off, its chance, and its ridge."""

    share: float
    p_value: float
    ridge: float


def held_out_share(halves: Sequence[JointRows], block: np.ndarray, rows: np.ndarray) -> Share:
    """What weighted features (T, f) take off a joint's squared error held out, by the best of all ridges."""
    count, ways = int(block.max()) + 1, len(RIDGES)
    gains, before = np.zeros((ways, count)), 0.0
    inner, square = np.zeros((ways, count)), np.zeros((ways, count))
    for half in halves:
        r, own = half.unseen, block[~half.train]
        for way, said in enumerate(half.predicted(rows[half.train], rows[~half.train])):
            gains[way] += np.bincount(own, r**2 - (r - said) ** 2, count)
            inner[way] += np.bincount(own, said * r, count)
            square[way] += np.bincount(own, said**2, count)
        before += float((r**2).sum())
    best = int(np.argmax(gains.sum(axis=1)))
    chance = min(1.0, ways * slope_p_value(inner[best], square[best]))
    return Share(float(gains[best].sum() / before), chance, RIDGES[best])
