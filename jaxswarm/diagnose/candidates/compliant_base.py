"""A base that gives way as a candidate, with the masses that only a base that sways feels."""

from collections.abc import Callable

import numpy as np

from jaxswarm.decomposition import lstsq
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.swaying_base import with_swing
from jaxswarm.diagnose.folds.free_parts import coefficients
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.columns import is_kept
from jaxswarm.identify.forward.compliance import felt_once_swayed
from jaxswarm.identify.forward.sway_response import SwayResponse

# What a number that is further fitted has to take off, in squares of its standard error: two of them squared.
_SAVED = 4.0


def compliant_base(lin: Linearization, term: Term) -> Candidate:
    """A base that gives way, to first order about the model's masses, and about those that it alone feels.

    The moment of a base holds masses that no joint of a level arm feels, such as those of its first link, which
    stand in the model at any value: what they change follows as columns with free coefficients, as for a tilt.
    Without them a base that left the first joint with 8.6 times its noise took 0.23 off, and a spring was told;
    with them it takes 0.95.
    """
    fresh = felt_once_swayed(lin.arm, lin.found.fit.base.unfelt[: len(lin.pi)])
    every = np.column_stack([lin.pi, fresh])
    known: dict[int, SwayResponse] = {}

    def response(k: int) -> SwayResponse:
        if k in known:
            return known[k]
        motion = lin.found.motions[k]
        made = SwayResponse(lin.arm, lin.moved[k], motion, every, again=is_kept(motion))
        if is_kept(motion):  # that of a long log is a gigabyte, and is asked for once
            known[k] = made
        return made

    still = _swayed(lin, term, response, fresh.shape[1])
    fold = lin.crossfit.whole
    free = fold.free_part(still.columns[0])
    soft = coefficients(free, fold)
    left = fold.residual - free @ soft
    told = with_swing(lin, term, left, soft[: len(term.law.linear)], response)
    swings = told.law_of(BodyChange).swinging(told.values)
    return _swayed(lin, told, response, fresh.shape[1]) if swings else still


def _swayed(
    lin: Linearization, term: Term, response: Callable[[int], SwayResponse], numbers: int
) -> Candidate:
    """A base with its values, and what masses that it alone feels change where they are worth it.

    ``response``: of a log by its number, by the model's body and so many of those masses.
    """
    law, alone = term.law_of(BodyChange), np.eye(1 + numbers)[0]

    def swayed(k):
        made = response(k).further(term, alone)
        # What the body is by itself is no direction of masses.
        return lin.reported(
            k, np.delete(made, np.s_[len(law.linear) : 2 * len(law.linear)], axis=2)
        )

    own, further = np.split(lin.stack(swayed), [len(law.linear)], axis=2)
    size = len(law.linear) + len(law.swinging(term.values))
    if size > len(law.linear):
        # Where the search ended the fit begins: its softness stays what it is beside these masses.
        soft = [term.values[p.name] for p in law.linear]
        beside = further.reshape(*own.shape[:2], -1, len(soft)) @ np.array(soft)
    else:
        beside = _beside(lin, own, further, numbers)
    if beside is None:
        return Candidate(term, lin.on_all(own), size)
    columns = np.concatenate([own, beside], axis=2)
    return Candidate(term, lin.on_all(columns), size + numbers)


def _beside(
    lin: Linearization, own: np.ndarray, further: np.ndarray, numbers: int
) -> np.ndarray | None:
    """Further columns (T, n, m) without what a law's own (T, n, k) say; None if not worth their numbers.

    So the coefficients of its own are those that it has alone, from where a fit begins. Worth it is what takes
    off more than two standard errors for each number.
    """
    fold = lin.crossfit.whole
    free, more = (fold.free_part(x).reshape(-1, x.shape[2]) for x in (own, further))
    rest = fold.residual.ravel() - free @ lstsq(free, fold.residual.ravel(), rcond=1e-9)
    said = lstsq(free, more, rcond=1e-9)
    apart = more - free @ said
    size = np.maximum(np.linalg.norm(apart, axis=0), 1e-300)
    left = rest - apart @ (lstsq(apart / size, rest, rcond=1e-6) / size)
    price = 1.0 + _SAVED * numbers / lin.crossfit.effective
    return further - own @ said if rest @ rest > price * (left @ left) else None
