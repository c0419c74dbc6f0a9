r"""Structure that no law explains: what the residual depends on, and a smooth term for it.

The residual of each joint is regressed on smooth random features of every single variable and pair of
variables, by ridge regression fitted to one half of the time and scored on the other. Features are
:math:`\cos(\omega^T x + \varphi)` with x standardized (A. Rahimi, B. Recht, NIPS 2007), freed of what the
model absorbs, so that a share of the error is claimed only if the model cannot follow it by refitting.
A second variable is named only if it raises the held-out share clearly over the first alone; beside time stand
the states that say nearly as much.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxswarm import cores
from jaxswarm.diagnose.decision.rules import SECOND_VARIABLE, STRUCTURE, STRUCTURE_SIGNIFICANCE
from jaxswarm.diagnose.decision.smooth_rows import (
    Share,
    SmoothOf,
    Variable,
    held_out_share,
    load_of,
    smooth_rows,
    table_of,
    waves_of,
)
from jaxswarm.diagnose.decision.telling import most_telling
from jaxswarm.diagnose.folds.joint_rows import joint_rows
from jaxswarm.diagnose.folds.other_motion import regions
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import Model, linear_values, with_linear_values
from jaxswarm.identify.forward.smooth import QUANTITIES, Smooth


@dataclass(frozen=True)
class Unexplained:
    """Structure left on one joint.

    Attributes:
        joint: Index.
        depends_on: Names such as ``q_joint1``, most important first; ``load_joint1`` is the torque of the
            rigid body.
        share: Share of the joint's held-out squared error that a smooth function of them takes off.
        p_value: One-sided, over blocks.
        smooth: The smooth function on the decimated clock, whole fit [N m], shape (T,).
        variables: Values of the named variables, shape (T, m).
        term: The same as a term that predicts other motion; None if it depends on time, temperature or load.
        change: Change of the model's columns' values that goes with it, shape (p,).
        elsewhere: Share that it takes off on motion it was not fitted to: on the worst other log, or without
            any in regions of the states held out in turn; below zero where it adds error, None if unknown.
        or_states: Where time is named, states that say nearly as much, and their share; None if none do.
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
    or_states: tuple[tuple[str, ...], float] | None = None


def find_unexplained(
    found: Estimate, crossfit: CrossFit, seed: int = 0, joints: Sequence[int] | None = None
) -> list[Unexplained]:
    """Joints (all, or those given) whose residual the motion predicts although no law passed."""
    asked = range(crossfit.weight.shape[1]) if joints is None else joints
    known = crossfit.structure
    if unknown := [j for j in asked if (seed, j) not in known]:
        table = table_of(found)
        looked = cores.each(lambda j: _look(found, crossfit, j, table, seed), unknown)
        known.update(zip([(seed, j) for j in unknown], looked, strict=True))
    return [known[seed, j] for j in asked if known[seed, j] is not None]


def _look(
    found: Estimate, crossfit: CrossFit, joint: int, table: dict[str, Variable], seed: int
) -> Unexplained | None:
    """The structure of one joint."""
    halves = [joint_rows(fold, joint) for fold in crossfit.halves]
    weight = crossfit.weight[:, joint, None]

    load = load_of(found, joint)
    known = {**table, **load}

    def tried(of: SmoothOf) -> Share:
        rows = smooth_rows([known[n] for n in of.names], waves_of(of, seed)) * weight
        return held_out_share(halves, crossfit.block, rows)

    own = found.model.robot.joints[joint]
    (best, pick), states, asked = most_telling(tried, table, own)
    # A load is a function of all positions: it is named where it says more than any two of them do.
    # A joint that stands all the time has no velocity that varies.
    pairs = [(n,) for n in load] + [(v, n) for n in load if (v := f"dq_{own}") in table]
    loads = [SmoothOf(names) for names in pairs]
    for share, of in [(tried(of), of) for of in loads]:
        if share.share > best.share + SECOND_VARIABLE:
            best, pick, states = share, of, None
    asked += len(loads)
    worth = best._replace(p_value=min(1.0, best.p_value * asked))
    if worth.share < STRUCTURE or worth.p_value > STRUCTURE_SIGNIFICANCE:
        return None
    item = _unexplained(found, crossfit, joint, pick, worth, known, seed)
    return replace(item, or_states=states and (states[1].names, states[0].share))


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
    of: SmoothOf,
    worth: Share,
    table: dict[str, Variable],
    seed: int,
) -> Unexplained:
    """Fit the smooth function of the picked variables on all rows; ``worth`` is what it is worth."""
    pick, waves = of.names, waves_of(of, seed)
    inputs = [table[n] for n in pick]
    weight, whole = crossfit.weight[:, joint, None], crossfit.whole
    rows = smooth_rows(inputs, waves) * weight
    a, _ = joint_rows(whole, joint).coefficients(rows, worth.ridge)
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
            np.array([one.lower for one in inputs]), np.array([one.upper for one in inputs]),
            x.mean(axis=0), np.maximum(x.std(axis=0), 1e-12), *waves,
            tuple(found.model.width[joints.index(own)] for _, own in places), a,
        )  # fmt: skip
    smooth = smooth_rows(inputs, waves) @ a
    elsewhere = (
        None if term is None else _in_other_regions(found, crossfit, joint, rows, worth.ridge)
    )
    return Unexplained(joint, pick, worth.share, worth.p_value, smooth, x, term, change, elsewhere)


def _in_other_regions(
    found: Estimate, crossfit: CrossFit, joint: int, rows: np.ndarray, ridge: float
) -> float | None:
    """Share that weighted features (T, f) take off in regions of states they were not fitted to."""
    label = regions(found)
    if label is None:
        return None
    gain = before = 0.0
    for one in np.unique(label):
        own = joint_rows(crossfit.whole.trained_on(label != one), joint)
        (said,) = own.predicted(rows[own.train], rows[~own.train], (ridge,))
        left = own.unseen - said
        gain += float((own.unseen**2 - left**2).sum())
        before += float((own.unseen**2).sum())
    return gain / max(before, 1e-300)
