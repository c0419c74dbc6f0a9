"""A law at both of its ends at once, where neither end shows while the model does without the other.

What a cable does to one joint bends the bodies that both share, and hides what it does to the other. On a world
with one over two joints, 5 and 35 times the noise were left, no end passed (p = 0.001 and 1), and an encoder's
zero did; with both ends 0.9 times the noise is left.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import NEAR
from jaxswarm.diagnose.decision.score import score
from jaxswarm.diagnose.decision.worth import Score, passes
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.diagnose.selection.refit import refit_in_place
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import step_between, with_errors
from jaxswarm.diagnose.selection.survives import survives
from jaxswarm.diagnose.selection.tenable import can_be, is_certain


def add_both_ends(search: Search, passed: Sequence[Score]) -> bool:
    """Add the law whose two ends explain most together, if that is more than any that passed; whether it was.

    Asked are joints of which one at least is far from its noise: what the other has left may be hidden in the
    bodies that both share. Either end has to pass beside the other one and beside the laws of its joint that
    it contains, as two springs are no cable; but what is large on one joint may be small on the other: of a
    cable that one end told with a share of 0.97 the other had 0.19, p = 4e-19, and a spring and an encoder's
    zero were told for it.
    """
    best = max((s.gain for s in passed), default=0.0)
    found = [p for p in _pairs(search) if p[0] > best]
    for _, one, other in sorted(found, key=lambda p: -p[0]):
        first, second = one.candidate.term, other.candidate.term
        current = search.current
        middle = refit_in_place(current, first)
        after = refit_in_place(middle, second)
        ends = [with_errors(t, after) for t in (first, second)]
        if not all(e is not None and can_be(*e) and is_certain(*e) for e in ends):
            continue
        whys = [survives(current, after, s.joint, search.other, search.rules) for s in (one, other)]
        if any(whys):
            search.refuse(first, next(w for w in whys if w), by_all=bool(search.other))
            continue
        search.steps += [step_between(one, current, middle), step_between(other, middle, after)]
        search.current = after
        return True
    return False


def _pairs(search: Search) -> list[tuple[float, Score, Score]]:
    """Both ends of laws that pass beside each other, with what they gain together."""
    current, crossfit = search.current, search.folds
    far = over_noise(current) > NEAR
    asked = {s.candidate.term.place: s for s in search.scores}
    ends = {
        (law, joint, other): s
        for (law, joint, other), s in asked.items()
        if s.candidate.term.law.mutual and far[[joint, other]].any()
    }
    told = []
    for one, two in combinations(ends, 2):
        if one != (two[0], two[2], two[1]):
            continue
        first, second = (
            _beside(ends[a], ends[b], asked, crossfit) for a, b in ((one, two), (two, one))
        )
        if all(passes(s, len(search.scores), search.rules) for s in _sized(first, second)):
            gain = ends[two].gain + _score(ends[one], crossfit, ends[two]).gain
            told.append((gain, first, second))
    return told


def _sized(*ends: Score) -> list[Score]:
    """Ends that count as one law: each is told by itself, and as large as the larger one."""
    most = {n: max(getattr(s, n) for s in ends) for n in ("share", "over_noise", "over_torque")}
    return [replace(s, **most) for s in ends]


def _beside(end: Score, other: Score, asked: Mapping[tuple, Score], crossfit: CrossFit) -> Score:
    """An end scored beside the other one and beside the laws it contains."""
    term = end.candidate.term
    inner = [asked.get((name, term.joint, None)) for name in term.law.contains]
    return _score(end, crossfit, other, *(s for s in inner if s is not None))


def _score(end: Score, crossfit: CrossFit, *beside: Score) -> Score:
    folds = zip(*(s.candidate.columns for s in beside), strict=True)
    columns = tuple(np.concatenate(parts, axis=2) for parts in folds)
    return score(end.candidate, crossfit.with_columns(columns))
