r"""Where the fit of declared nonlinear parameters begins, of laws that have several minima.

Gauss-Newton steps go to the nearest minimum. A spring on a lever that began at its nominal angle, a quarter of
a turn from the true one, ended at a bound. A law that says how many points a first look at it needs is tried
at all of them, and begins where its columns, freed of what the rest of the model takes up, explain most.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.decomposition import lstsq
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.lattice import lattice_of, ordered, points_of, seen_of
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.least_squares import solved
from jaxswarm.identify.estimation.sign_width import best_widths
from jaxswarm.identify.forward.columns import Rigid, rigid_of
from jaxswarm.identify.forward.own_columns import own_columns
from jaxswarm.identify.forward.regression import build_regression
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot

# Directions of a law weaker than this part of its own size are what the rest of the model takes up.
_TAKEN_UP = 1e-4


def with_starts(
    robot: Robot, terms: tuple[Term, ...], motions: Sequence[Motion]
) -> tuple[Term, ...]:
    """The terms with values of nonlinear parameters to begin from, one term after the other.

    Those whose values are given keep them, and so do those of laws that one minimum is known of.

    Args:
        robot: Kinematics.
        terms: Declared laws.
        motions: Prepared logs with torque.
    """
    asked = [t for t in terms if _has_several_minima(t)]
    if not asked:
        return terms
    rigids = [rigid_of(robot, m) for m in motions]
    rest = tuple(
        replace(t, values={**{p.name: p.nominal for p in t.law.nonlinear}, **t.values})
        for t in terms
        if t not in asked
    )
    width = tuple(best_widths(robot, rest, motions, rigids))
    begun = []
    for term in asked:
        placed = _placed(robot, rest, term, motions, rigids, width)
        rest = (*rest, placed)
        begun.append(placed)
    # In their order: the values that a term begins with may be part of its identity (a ripple's order).
    in_turn = iter(begun)
    return tuple(next(in_turn) if t in asked else t for t in terms)


def _has_several_minima(term: Term) -> bool:
    law = term.law
    return (
        isinstance(law, TorqueLaw)
        and law.grid_size is not None
        and not (law.uses_load or law.in_one_log)
        and not any(p.name in term.values for p in law.nonlinear)
    )


def _placed(
    robot: Robot,
    rest: tuple[Term, ...],
    term: Term,
    motions: Sequence[Motion],
    rigids: Sequence[Rigid],
    width: tuple[float, ...],
) -> Term:
    """A term at the point of its lattice where it explains most of what the rest leaves."""
    law, joint = term.law_of(TorqueLaw), term.index
    regression = build_regression(robot, rest, motions, width, rigids=rigids)
    fit = solved(regression)
    held = regression.columns[:, :, fit.base.kept] / fit.sigma[:, None]
    q, _ = np.linalg.qr(held.reshape(-1, fit.base.size))
    own = q.reshape(held.shape)[:, joint]
    left = fit.residual[:, joint] / fit.sigma[joint]
    share = regression.shares[:, joint]
    names = [p.name for p in ordered(law)]
    dims, points = len(names), points_of(law)
    low, span = seen_of(law, [m.q[:, joint] for m in motions], dims)
    best, values = -1.0, {}
    for point in lattice_of(dims, points, (points, dims))[0]:
        place = dict(zip(names, low + span * point, strict=True))
        tried = {p.name: float(p.decode(place[p.name])) for p in ordered(law)}
        there = replace(term, values=tried)
        rows = [m.decimator.apply(own_columns(there, m, width, None)[:, joint]) for m in motions]
        gain = _explained(share[:, None] * np.concatenate(rows), own, left)
        if gain > best:
            best, values = gain, tried
    return replace(term, values=values)


def _explained(columns: np.ndarray, own: np.ndarray, left: np.ndarray) -> float:
    """What columns (T, k) explain of a residual (T,) beside what a basis (T, b) takes up of them."""
    size = np.linalg.norm(columns, axis=0)
    if not np.isfinite(size).all() or not (size > 0.0).any():
        return 0.0
    columns = columns[:, size > 0.0] / size[size > 0.0]
    held, inner = own.T @ columns, columns.T @ left
    gram = columns.T @ columns - held.T @ held
    return float(inner @ lstsq(gram, inner, rcond=_TAKEN_UP))
