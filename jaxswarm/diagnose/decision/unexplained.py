r"""Structure that no law explains: what the residual depends on, and a smooth term for it.

The residual of each joint is regressed on smooth random features of every single variable and pair of
variables, by ridge regression fitted to one half of the time and scored on the other. Features are
:math:`\cos(\omega^T x + \varphi)` with x standardized (A. Rahimi, B. Recht, NIPS 2007), freed of what the
model absorbs, so that a share of the error is claimed only if the model cannot follow it by refitting.
A second variable is named only if it raises the held-out share clearly over the first alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from jaxswarm import cores
from jaxswarm.diagnose.decision.rules import SECOND_VARIABLE, STRUCTURE, STRUCTURE_SIGNIFICANCE
from jaxswarm.diagnose.decision.significance import slope_p_value
from jaxswarm.diagnose.folds.joint_rows import JointRows, joint_rows
from jaxswarm.diagnose.folds.other_motion import regions
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import Model, linear_values, with_linear_values
from jaxswarm.identify.forward.smooth import QUANTITIES, Smooth, features

# Features of one and two variables; and how many times as narrow, and of how many more, those of a joint's own
# position are once more: what sits at one place, a magnet of 0.15 rad on 1.3 rad of motion, is half hidden from
# functions as wide as the motion, and laws of the catalog stood in for it.
_FEATURES = {1: 14, 2: 96}
_NARROW, _OF_NARROW = 4.0, 48


@dataclass(frozen=True)
class Unexplained:
    """Structure left on one joint.

    Attributes:
        joint: Index.
        depends_on: Names such as ``q_joint1``, most important first.
        share: Share of the joint's held-out squared error that a smooth function of them takes off.
        p_value: One-sided, over blocks.
        smooth: The smooth function on the decimated clock, whole fit [N m], shape (T,).
        variables: Values of the named variables, shape (T, m).
        term: The same as a term that predicts other motion; None if it depends on time or temperature.
        change: Change of the model's columns' values that goes with it, shape (p,).
        elsewhere: Share that it takes off on motion it was not fitted to: on the worst other log, or without
            any in regions of the states held out in turn; below zero where it adds error, None if unknown.
    """

    joint: int
    depends_on: tuple[str, ...]
    share: float
    p_value: float
    smooth: np.ndarray
    variables: np.ndarray
    term: Smooth | None
    change: np.ndarray
    elsewhere: float | None = None


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


def find_unexplained(
    found: Estimate, crossfit: CrossFit, seed: int = 0, joints: Sequence[int] | None = None
) -> list[Unexplained]:
    """Joints (all, or those given) whose residual the motion predicts although no law passed."""
    asked = range(crossfit.weight.shape[1]) if joints is None else joints
    known = crossfit.structure
    if unknown := [j for j in asked if (seed, j) not in known]:
        table = _table(found)
        looked = cores.each(lambda j: _look(found, crossfit, j, table, seed), unknown)
        known.update(zip([(seed, j) for j in unknown], looked, strict=True))
    return [known[seed, j] for j in asked if known[seed, j] is not None]


def own_position(
    found: Estimate, crossfit: CrossFit, joint: int, seed: int = 0
) -> tuple[float, float]:
    """Share of a joint's held-out squared error that a narrow function of its own position takes off, and p."""
    own = f"q_{found.model.robot.joints[joint]}"
    of, weight = _Of((own,), narrow=True), crossfit.weight[:, joint, None]
    rows = _features([_table(found)[own]], _waves(of, seed)) * weight
    return _held_out([joint_rows(fold, joint) for fold in crossfit.halves], crossfit.block, rows)


def _table(found: Estimate) -> dict[str, "_Input"]:
    """All variables that vary."""
    joints = found.model.robot.joints
    width = {f"dq_{j}": w for j, w in zip(joints, found.model.width, strict=True)}
    variables = {n: x for n, x in residual_variables(found).items() if np.ptp(x) > 1e-9}
    # A velocity also enters by its direction: friction jumps at zero.
    return {n: _input(x, width.get(n)) for n, x in variables.items()}


def _look(
    found: Estimate, crossfit: CrossFit, joint: int, table: dict[str, "_Input"], seed: int
) -> Unexplained | None:
    """The structure of one joint."""
    halves = [joint_rows(fold, joint) for fold in crossfit.halves]
    weight = crossfit.weight[:, joint, None]

    def tried(of: "_Of") -> tuple[float, float]:
        rows = _features([table[n] for n in of.names], _waves(of, seed)) * weight
        return _held_out(halves, crossfit.block, rows)

    own = found.model.robot.joints[joint]
    narrow = [_Of((n,), narrow=True) for n in (f"q_{own}",) if n in table]
    singles = [(tried(of), of) for of in [*(_Of((n,)) for n in table), *narrow]]
    singles.sort(key=lambda item: -item[0][0])
    best, pick = singles[0]
    # Pairs with each of the three most telling variables, and with the joint's own velocity.
    telling = list(dict.fromkeys(item[1].names[0] for item in singles))[:3]
    leads = dict.fromkeys([*telling, f"dq_{own}"])
    pairs = [(a, b) for a in leads for b in table if a in table and b != a]
    told = sorted(((tried(of), of) for of in map(_Of, pairs)), key=lambda item: -item[0][0])
    asked = len(singles) + len(told)
    if told and told[0][0][0] > best[0] + SECOND_VARIABLE:
        best, pick = told[0]
    share, p_value = best
    if share < STRUCTURE or p_value * asked > STRUCTURE_SIGNIFICANCE:
        return None
    return _unexplained(found, crossfit, joint, pick, (share, p_value * asked), table, seed)


def with_smooth_terms(found: Estimate, left: Sequence[Unexplained]) -> Model:
    """The model with a smooth term for all structure whose variables another log has too."""
    kept = [(item.change, item.term) for item in left if item.term is not None]
    change = sum((change for change, _ in kept), np.zeros(len(found.fit.theta)))
    model = with_linear_values(found.model, linear_values(found.model) + change)
    return replace(model, smooth=(*model.smooth, *(term for _, term in kept)))


def _unexplained(
    found: Estimate,
    crossfit: CrossFit,
    joint: int,
    of: "_Of",
    worth: tuple[float, float],
    table: dict[str, "_Input"],
    seed: int,
) -> Unexplained:
    """Fit the smooth function of the picked variables on all rows; ``worth`` is its share and its chance."""
    pick, waves = of.names, _waves(of, seed)
    inputs = [table[n] for n in pick]
    weight, whole = crossfit.weight[:, joint, None], crossfit.whole
    rows = _features(inputs, waves) * weight
    a, _ = joint_rows(whole, joint).coefficients(rows)
    torque = np.zeros(crossfit.weight.shape)
    torque[:, joint] = rows @ a
    change = np.zeros(len(found.fit.theta))
    change[found.fit.base.kept] = -whole.absorbed(torque)
    x = np.stack([one.raw for one in inputs], axis=1)
    term = None
    joints = found.model.robot.joints
    places = [tuple(n.split("_", 1)) for n in pick]
    if all(place[0] in QUANTITIES for place in places):
        term = Smooth(
            joint,
            tuple((name, joints.index(own)) for name, own in places),
            x.min(axis=0), x.max(axis=0), x.mean(axis=0), np.maximum(x.std(axis=0), 1e-12),
            *waves, tuple(found.model.width[joints.index(own)] for _, own in places), a,
        )  # fmt: skip
    share, p_value = worth
    smooth = _features(inputs, waves) @ a
    elsewhere = None if term is None else _in_other_regions(found, crossfit, joint, rows)
    return Unexplained(joint, pick, share, min(1.0, p_value), smooth, x, term, change, elsewhere)


def _in_other_regions(
    found: Estimate, crossfit: CrossFit, joint: int, rows: np.ndarray
) -> float | None:
    """Share that weighted features (T, f) take off in regions of states they were not fitted to."""
    label = regions(found)
    if label is None:
        return None
    gain = before = 0.0
    for one in np.unique(label):
        own = joint_rows(crossfit.whole.trained_on(label != one), joint)
        left = own.unseen - own.predicted(rows[own.train], rows[~own.train])
        gain += float((own.unseen**2 - left**2).sum())
        before += float((own.unseen**2).sum())
    return gain / max(before, 1e-300)


class _Input(NamedTuple):
    """A variable as logged, standardized, and its smooth sign where a jump at zero is possible."""

    raw: np.ndarray
    standard: np.ndarray
    side: np.ndarray | None


def _input(x: np.ndarray, width: float | None) -> _Input:
    standard = (x - x.mean()) / max(x.std(), 1e-12)
    return _Input(x, standard, None if width is None else np.tanh(x / width))


class _Of(NamedTuple):
    """What a smooth function is one of, and whether it may be narrow."""

    names: tuple[str, ...]
    narrow: bool = False


def _waves(of: _Of, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies and phases of the features."""
    rng, count = np.random.default_rng(seed), len(of.names)
    size = _OF_NARROW if of.narrow else _FEATURES[count]
    frequency = rng.normal(scale=_NARROW if of.narrow else 1.0, size=(count, size))
    return frequency, rng.uniform(0, 2 * np.pi, size)


def _features(inputs: list[_Input], waves: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Features (T, f) of one or two variables."""
    x = np.stack([one.standard for one in inputs], axis=1)
    sides = [one.side for one in inputs if one.side is not None]
    return features(x, sides, *waves)


def _held_out(
    halves: Sequence[JointRows], block: np.ndarray, rows: np.ndarray
) -> tuple[float, float]:
    """Share of a joint's squared error held out that weighted features (T, f) take off, and its p-value."""
    count = int(block.max()) + 1
    gains, before = np.zeros(count), 0.0
    inner, square = np.zeros(count), np.zeros(count)
    for half in halves:
        r, said = half.unseen, half.predicted(rows[half.train], rows[~half.train])
        own = block[~half.train]
        gains += np.bincount(own, r**2 - (r - said) ** 2, count)
        inner += np.bincount(own, said * r, count)
        square += np.bincount(own, said**2, count)
        before += float((r**2).sum())
    return float(gains.sum() / before), slope_p_value(inner, square)
