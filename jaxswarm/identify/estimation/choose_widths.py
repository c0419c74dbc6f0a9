"""Which widths of the sign are fitted: one for a kind of joint, a joint's own, or what leans on the others'."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.identify.estimation.free_parameters import FreeParameter
from jaxswarm.identify.estimation.gauss_newton import Settled, newton, settle
from jaxswarm.identify.estimation.least_squares import weighted_cost
from jaxswarm.identify.estimation.links_held import LinksHeld, links_can_be_held
from jaxswarm.identify.estimation.own_widths import apart, is_told, told_by_the_others
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.estimation.widths_alone import Alone, free_widths, freed_of, widths_alone

# What a log tells of a width by less than two standard errors it hardly tells: their square over the rows.
_HARDLY_TOLD = 4.0
# Which widths are a joint's own is told to first order, from where the others are: a second pass moved one of a
# world by 8 %, and with it the error of point-to-point motion by 16 %.
_PASSES, _SETTLED = 3, 0.02

# Parts of the way to where widths lean. On a world two hardly told ones were denied the whole way, shared a
# width of a half of theirs instead, and the error of another motion at rest was 2.6 times as large.
_PARTS_OF_THE_WAY = (1.0, 0.5)
# A sign of less than this part of the others' width, in logarithms, is sharper; and steps towards it that a log
# may tell one after the other.
_SHARPER, _STEPS = 0.4, 5


def _moved(problem: Problem, here: Settled, moving, width: Sequence[float] | np.ndarray) -> Settled:
    """The fit from one near by, with other widths (n,) to begin with."""
    place = here.place._replace(width=tuple(map(float, width)))
    return newton(problem, moving, settle(problem, place, here.theta, here.solution.sigma))


def choose_widths(
    problem: Problem, here: Settled, moving: list[FreeParameter], groups: Sequence[tuple[int, ...]]
) -> tuple[Settled, list[FreeParameter], list[FreeParameter]]:
    """The fit with the widths that its log tells, what is free there, and widths that are held but not known.

    What leans on others is held where it has come to. As if it were known, the height of Stribeck's curve had
    an error of 0.009 N m where it was 0.08 off.

    Args:
        problem: What stays the same.
        here: A fit with one width for all joints of a group, or with those of a model that knew less.
        moving: What is free there.
        groups: Joints of a kind with directed friction.
    """
    if not links_can_be_held(here.place.terms):
        return _widths_of(problem, here, moving, groups)
    fixed = LinksHeld.about(problem, here)
    free = fixed.free(here.place.terms, [one for one in moving if one.joints])
    there, free, held = _widths_of(fixed, here, free, groups)
    moving = problem.free(there.place.terms, [one for one in free if one.joints])
    if there.place.width != here.place.width:
        here = _moved(problem, there, moving, there.place.width)
    return here, moving, held


def _widths_of(
    problem: Problem, here: Settled, moving: list[FreeParameter], groups: Sequence[tuple[int, ...]]
) -> tuple[Settled, list[FreeParameter], list[FreeParameter]]:
    """What :func:`choose_widths` gives, by fits of what this problem lets move."""
    held: list[FreeParameter] = []
    here = _shared_again(problem, here, moving)
    for _ in range(_PASSES):
        before = here.place.width
        here, moving, held, own = _chosen(problem, here, moving, groups)
        if not groups or np.abs(np.log(np.divide(here.place.width, before))).max() < _SETTLED:
            break
    return _no_sharper_than_told(problem, here, moving, held, groups, own)


def _chosen(
    problem: Problem, here: Settled, moving: list[FreeParameter], groups: Sequence[tuple[int, ...]]
) -> tuple[Settled, list[FreeParameter], list[FreeParameter], Alone | None]:
    """The same, from what the log tells to first order about the widths of a fit; and that of the one it gives.

    None where that is another one than was asked.
    """
    own = widths_alone(problem, here, groups)
    freed = freed_of(groups, own, here.place.width)
    rest = [tuple(j for j in group if j not in freed) for group in groups]
    split = [*(group for group in rest if group), *((j,) for j in sorted(freed))]
    if freed:
        moving = problem.free(
            here.place.terms, free_widths(problem.motions, split, here.place.width)
        )
        here = newton(problem, moving, here)
        own = widths_alone(problem, here, groups)
    if not own:
        return here, moving, [], own
    there, moving, held = _leaning(problem, here, moving, groups, split, freed, own)
    return there, moving, held, own if there is here else None


def _no_sharper_than_told(problem: Problem, here: Settled, moving, held, groups, own: Alone | None):
    """The fit in which no sign is sharper than the log tells, where others' are told; what is free, what held.

    A sign may run on to where no sample sees it any more, and all that is known is that it is sharper than the
    others'. At rest the sharpest of all errs most: on a world one ended 18 times too sharp, and left its joint
    on point-to-point motion with five times the declared model's error. So it is as sharp as is told on the
    way from where the others' are: 1.2 times too sharp there, and of 50 fits of 30 logs one other changed, by
    less sharp a sign that had been 4 times too sharp.
    """
    width = here.place.width
    differing = [g for g in groups if np.ptp(np.log([width[j] for j in g])) > _SHARPER]
    if not differing:
        return here, moving, held
    own = widths_alone(problem, here, groups) if own is None else own
    leant = {j for one in held for j in one.joints}
    sharp: dict[int, float] = {}
    for group in differing:
        known = [j for j in group if j in own and is_told(own[j][1])]
        if known:
            weights = [own[j][1] ** -2 for j in known]
            usual = float(np.average([np.log(width[j]) for j in known], weights=weights))
            untold = set(group).intersection(own) - {*known, *leant}
            sharp |= {j: usual for j in untold if np.log(width[j]) < usual - _SHARPER}
    if not sharp:
        return here, moving, held
    split = [tuple(j for j in one.joints if j not in sharp) for one in moving if one.joints]
    free = problem.free(
        here.place.terms, free_widths(problem.motions, [g for g in split if g], width)
    )
    there = _as_far_as_told(problem, here, free, groups, sharp)
    ended = free_widths(problem.motions, [(j,) for j in sorted(sharp)], there.place.width)
    return there, free, [*held, *ended]


def _as_far_as_told(problem: Problem, here: Settled, moving, groups, usual) -> Settled:
    """The fit with some widths where the log tells them last, on the way from logarithms that are ``usual``.

    Where it tells nothing there either, one stays as it is.
    """
    first, told = here.place.width, usual
    for _ in range(_STEPS):
        width = list(here.place.width)
        for j, y in told.items():
            width[j] = float(np.exp(y))
        here = _moved(problem, here, moving, width)
        own = widths_alone(problem, here, groups)
        told = {
            j: own[j][0]
            for j in told
            if j in own and is_told(own[j][1]) and own[j][0] < np.log(width[j]) - _SETTLED
        }
        if not told:
            break
    still = [j for j, y in usual.items() if here.place.width[j] == float(np.exp(y))]
    if not still:
        return here
    width = [first[j] if j in still else w for j, w in enumerate(here.place.width)]
    return _moved(problem, here, moving, width)


def _shared_again(problem: Problem, here: Settled, moving: list[FreeParameter]) -> Settled:
    """The fit with one width for joints that share a parameter, where theirs are no longer apart.

    They were beside a model that lacked something: an order of a ripple was told before the friction beside it,
    which gave its joint 1.4 times the width of the others, and by that each of these one of its own. With both
    laws there each was what noise had made of it, and both were taken back for what a wrist's did elsewhere.
    """
    width = np.array(here.place.width)
    sharing = [list(f.joints) for f in moving if np.ptp(width[list(f.joints) or [0]]) > 0]
    own = widths_alone(problem, here, sharing)
    for group in sharing:
        told = [own[j] for j in group if j in own and np.isfinite(own[j][1])]
        if len(told) > 1:
            y, doubt = np.array(told).T
            shared = np.average(y, weights=1.0 / doubt**2)
            if not len(apart(y - shared, doubt)):
                width[group] = np.exp(shared)
    if np.array_equal(width, here.place.width):
        return here
    return _moved(problem, here, moving, width)


def _leaning(problem: Problem, here: Settled, moving, groups, split, freed, own):
    """The fit with widths that lean on each other, if the log allows it; what is free there, what is held."""
    told = told_by_the_others(groups, freed, here.place.width, own)
    known = [g for g in split if all(told[j] == here.place.width[j] for j in g)]
    if len(known) == len(split):
        return here, moving, []
    sigma = here.solution.sigma
    one = weighted_cost(here.residual, sigma)
    # What a joint tells is told to first order, and may lead too far. Of a cost that grows with the square of
    # the way, what is denied the whole is denied every part of it.
    for part in _PARTS_OF_THE_WAY:
        leant = tuple(a * (b / a) ** part for a, b in zip(here.place.width, told, strict=True))
        free = problem.free(here.place.terms, free_widths(problem.motions, known, leant))
        there = _moved(problem, here, free, leant)
        two = weighted_cost(there.residual, sigma)
        if two <= (1.0 + part**2 * _HARDLY_TOLD / len(here.residual)) * one:
            leaning = [(j,) for group in split if group not in known for j in group]
            return there, free, free_widths(problem.motions, leaning, leant)
    return here, moving, []
