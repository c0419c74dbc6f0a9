"""The width of every joint's smooth sign: where to start, within what it moves, and which joints share one.

A gear that turns at 1 rad/s and a slide at 0.1 m/s reverse within other velocities, so turning and sliding
joints have widths of their own. Joints of one kind share a width unless the data clearly say otherwise: the
width decides what a resting joint's friction is, a log that hardly rests tells it to 5 to 20 % only, and on
motion with long rests such an error is worth more than all else (measured on q01 and q02 of the practice
logs: own widths left 3 to 13 times the error of shared ones on unseen motion).
"""

from collections.abc import Sequence
from dataclasses import replace

import jax
import numpy as np

from jaxswarm import cores
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.free_parameters import Place, with_values
from jaxswarm.identify.estimation.least_squares import solved
from jaxswarm.identify.estimation.standing import comes_near_rest, never_slow, tells_sign
from jaxswarm.identify.forward.columns import Rigid, is_kept
from jaxswarm.identify.forward.measuring_chain import term_block
from jaxswarm.identify.forward.regression import Regression, build_regression
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot

# Widths as parts of the typical speed: tried at the start, and the range for the refinement. A sharp
# sign is one that no sample sees.
_SHARP, _FROM, _TO, _COUNT = 1e-6, 1e-3, 0.2, 12
_RANGE = (3e-4, 0.4)
# Width of a joint on which no law depends on the direction, as a part of its speed; and the least speed
# [rad/s or m/s] to count in.
_USUAL, _STILL = 0.01, 1e-6
# The width of its kind is no start for a joint of whose squared error another leaves less than this part: one
# ten times the other's (0.02 and 0.2 rad/s) left a fortieth. Nor are widths so many times apart fitted as one.
_OF_ITS_KIND, _FAR = 0.5, 3.0


def typical_speed(motions: Sequence[Motion]) -> np.ndarray:
    """Median RMS speed of the logs, joint by joint [rad/s or m/s], (n,)."""
    speed = np.median([np.sqrt(np.mean(m.dq**2, axis=0)) for m in motions], axis=0)
    return np.maximum(speed, _STILL)


def width_groups(
    robot: Robot, terms: Sequence[Term], motions: Sequence[Motion]
) -> list[tuple[int, ...]]:
    """Joints with directed friction whose width these logs tell, those of one kind together.

    With them those that race through zero and tell next to nothing: the width is that of their kind. As a part
    of its speed that of a wrist was 9 % off, and its error on point-to-point motion 1.8 times the others'.
    Where no other joint of their kind tells it, those that come near rest do.
    """
    told, fast, near = (f(motions) for f in (tells_sign, never_slow, comes_near_rest))
    joints = {t.joint for t in terms if t.law.uses_direction and t.joint is not None}
    telling = told | (fast & near)
    kinds = dict.fromkeys(robot.kinds[j] for j in sorted(joints) if telling[j])
    return [
        tuple(j for j in sorted(joints) if robot.kinds[j] == kind and (told[j] or fast[j]))
        for kind in kinds
    ]


def alike(groups: Sequence[tuple[int, ...]], width: Sequence[float]) -> list[tuple[int, ...]]:
    """Groups of joints without those whose widths are far from the group's, each of which is a group.

    >>> alike([(0, 1, 2)], (0.01, 0.2, 0.012))
    [(0, 2), (1,)]
    """
    parts = []
    for group in groups:
        middle = np.exp(np.median(np.log([width[j] for j in group])))
        near = tuple(j for j in group if 1.0 / _FAR <= width[j] / middle <= _FAR)
        parts += [near] * bool(near) + [(j,) for j in group if j not in near]
    return parts


def sharing(groups: Sequence[tuple[int, ...]], width: Sequence[float]) -> list[tuple[int, ...]]:
    """Groups of joints cut into those whose joints have one width.

    >>> sharing([(0, 1, 2), (3,)], (0.01, 0.2, 0.01, 0.2))
    [(0, 2), (1,), (3,)]
    """
    return [
        tuple(j for j in group if width[j] == one)
        for group in groups
        for one in dict.fromkeys(width[j] for j in group)
    ]


def width_range(motions: Sequence[Motion], joints: Sequence[int]) -> tuple[float, float]:
    """Least and largest width of joints that share one, for the refinement."""
    speed = typical_speed(motions)[list(joints)]
    return _RANGE[0] * float(speed.min()), _RANGE[1] * float(speed.max())


def driven_by_friction(robot: Robot, terms: Sequence[Term], theta: np.ndarray) -> set[int]:
    """Joints that dry friction would drive: every law of their direction has come out against its bound.

    Such a sign has no width. That of a joint that lacked drag took on the drag's shape at 0.7 rad/s, with 9 N m
    s/rad of viscous friction and -5 N m of dry: 4 times the noise instead of 22, and the drag was not seen.

    Args:
        robot: Its joints.
        terms: The model's.
        theta: Its linear parameters, (p,), the rigid ones first.
    """
    below: dict[int, bool] = {}
    placed = with_values(Place(tuple(terms), ()), theta[10 * robot.num_joints :], robot.joints)
    for term in placed.terms:
        if term.law.uses_direction and term.joint is not None:
            bounded = [p for p in term.law.linear if np.isfinite(p.lower)]
            # A law without a lower bound may have any sign: it says nothing against physics.
            wrong = bool(bounded) and all(term.values[p.name] < p.lower for p in bounded)
            below[term.joint] = below.get(term.joint, True) and wrong
    return {joint for joint, wrong in below.items() if wrong}


def best_widths(
    robot: Robot,
    terms: tuple[Term, ...],
    motions: Sequence[Motion],
    rigids: Sequence[Rigid],
    pi: np.ndarray | None = None,
    known: tuple[float, ...] | None = None,
) -> tuple[float, ...]:
    """The widths with the smallest residual, from sharp to a fifth of the speed, one per kind of joint.

    A joint to which that of its kind leaves far more than another one has its own: where the sign is ten times
    too sharp, no slope tells that it is too wide.

    All groups take the same part of their median speed at a time: what a joint's sign leaves on the others
    is little beside what it leaves on its own. Widths that the logs do not tell are those ``known``.
    """
    speed = typical_speed(motions)
    groups = width_groups(robot, terms, motions)
    scale = speed.copy()
    for group in groups:
        scale[list(group)] = np.median(speed[list(group)])
    usual = tuple(map(float, _USUAL * scale if known is None else known))
    if not groups:
        return usual
    grid = np.concatenate([[_SHARP], np.geomspace(_FROM, _TO, _COUNT)])
    pi = np.zeros(10 * robot.num_joints) if pi is None else pi
    regression = build_regression(robot, terms, motions, usual, pi, rigids)
    # Rows of a long log do not stand in memory twice.
    whole = all(map(is_kept, motions))
    precise = jax.config.jax_enable_x64  # type: ignore[attr-defined]

    def costs_of(part: float, sigma: np.ndarray | None = None) -> tuple[np.ndarray, ...]:
        """Weights, and what a part leaves of every joint, the second time where friction does not drive it."""
        rows = replace(regression, columns=regression.columns.copy()) if whole else regression
        with jax.enable_x64(precise):  # a thread has settings of its own
            _write_anew(robot, terms, motions, rigids, pi, rows, (part * scale).tolist())
        solution = solved(rows, sigma=sigma)
        sigma = solution.sigma if sigma is None else sigma
        cost = ((solution.residual / sigma) ** 2).sum(axis=0)
        own = cost.copy()
        own[list(driven_by_friction(robot, terms, solution.theta))] = np.inf
        return sigma, cost, own

    sigma, *sharp = costs_of(grid[0])
    others = (cores.each if whole else map)(lambda part: costs_of(part, sigma)[1:], grid[1:])
    costs = [sharp, *others]
    parts, cost, own = np.divide(usual, scale), *np.swapaxes(costs, 0, 1)
    for group in groups:
        shared = (cost if len(group) > 1 else own)[:, list(group)].sum(axis=1)
        if not np.isfinite(shared).any():
            continue
        parts[list(group)] = _best(grid, shared)
        for j in group:
            if own[:, j].min() < _OF_ITS_KIND * cost[np.argmin(shared), j]:
                parts[j] = _best(grid, own[:, j])
    return tuple(map(float, parts * scale))


def _write_anew(
    robot: Robot,
    terms: tuple[Term, ...],
    motions: Sequence[Motion],
    rigids: Sequence[Rigid],
    pi: np.ndarray,
    rows: Regression,
    width: Sequence[float],
) -> None:
    """Write all columns of rows that depend on the widths (n,) of the signs, in place."""
    k = 10 * robot.num_joints
    for term in terms:
        size = len(term.columns(robot.joints))
        if term.law.uses_direction:
            own = [
                term_block(robot, terms, term, m, width, pi, r)
                for m, r in zip(motions, rigids, strict=True)
            ]
            rows.columns[:, :, k : k + size] = rows.counted(np.concatenate(own))
        k += size


def _best(grid: np.ndarray, costs: np.ndarray) -> float:
    """The part with the least cost: the vertex of a parabola in its logarithm, the first point aside."""
    best = int(np.argmin(costs))
    if not (1 < best < len(grid) - 1 and np.isfinite(costs[best - 1 : best + 2]).all()):
        return float(grid[best])
    x, y = np.log(grid[best - 1 : best + 2]), costs[best - 1 : best + 2]
    a, b, _ = np.polyfit(x - x[1], y, 2)
    return float(np.exp(x[1] - b / (2 * a))) if a > 0 else float(grid[best])
