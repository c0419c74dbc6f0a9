"""Which of several terms that passed is added, and which of the others the data do not tell from it.

References: Q. H. Vuong, Econometrica 57 (1989) for the comparison of rivals; D. Rivers, Q. H. Vuong,
Econometrics J. 5 (2002) for doing it under autocorrelation.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.decomposition import lstsq
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.decision.common_error import p_value_beside_fit
from jaxswarm.diagnose.decision.level import level_of
from jaxswarm.diagnose.decision.of_joints import told_by_joints
from jaxswarm.diagnose.decision.rules import AS_GOOD, ASKED_AGAIN, OVERLAP, SPECIAL_CASE, Rules
from jaxswarm.diagnose.decision.score import score
from jaxswarm.diagnose.decision.worth import Score, adds
from jaxswarm.diagnose.folds.free_parts import coefficients
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.effects.kinds import BodyChange, MeasurementLaw, TransmissionLaw
from jaxswarm.effects.term import Term


def accepted(scores: Sequence[Score], rules: Rules, added: Sequence[Term] = ()) -> list[Score]:
    """Those that pass; what happens once only if nothing that lasts passes and explains more.

    ``added``: what was added before, see :func:`jaxswarm.diagnose.decision.level.level_of`.
    """
    tested = level_of(scores, rules, added)
    passed = with_soft_joints([s for s in scores if tested(s)], scores, tested)
    lasting = [s.gain for s in passed if not s.candidate.term.law.recurring]
    most = max(lasting, default=0.0)
    return [s for s in passed if not s.candidate.term.law.recurring or s.gain >= most]


def with_soft_joints(
    passed: list[Score], scores: Sequence[Score], tested: Callable[[Score], bool]
) -> list[Score]:
    """Those that passed, and the transmissions that by the same measure come near what is judged by all joints.

    A soft base and an error of an encoder are told by all joints, a soft joint by its own alone, for one law of
    a joint may be hidden by what others share. What gives way is another question, for which both are measured
    alike: a shoulder whose drive is 15 times as loud as the others moved all links behind it, took 3 % off its
    own squared error and 1.3 to 1.5 times as much as the base off that of all, which was told in its place. And
    of an encoder and the gear of its joint: one that stiffens as it winds up took 12 % off its own joint, and
    0.75 of what an eccentric encoder took off all; fitted it leaves half of what that does.
    """
    bases = [s.gain for s in passed if _is_soft_base(s.candidate.term)]
    base = max(bases, default=np.inf)
    seen = [s.on_all for s in scores if s.on_all is not None and s not in passed]

    def comes_near(s: Score) -> bool:
        misread = any(tell_one_lag(s, p) and s.gain > ASKED_AGAIN * p.gain for p in passed)
        return (misread or s.gain > base) and tested(s)

    return [*passed, *filter(comes_near, seen)]


def tell_one_lag(one: Score, other: Score) -> bool:
    """Whether one says that a joint's encoder misreads, and the other that its link lags behind its motor."""
    laws = [s.candidate.term.law for s in (one, other)]
    misread = [isinstance(law, MeasurementLaw) and law.excess is not None for law in laws]
    lags = [isinstance(law, TransmissionLaw) for law in laws]
    pair = misread[0] and lags[1] or misread[1] and lags[0]
    return pair and one.candidate.term.joint == other.candidate.term.joint


def _is_soft_base(term: Term) -> bool:
    return isinstance(term.law, BodyChange) and term.law.compliance is not None


def difference(one: Score, other: Score) -> float:
    """Standard errors by which the first gains more per block than the second."""
    change = one.beside(other) - other.beside(one)
    spread = change.std(ddof=1) / np.sqrt(len(change))
    return float(change.mean() / max(spread, 1e-12 * abs(one.blocks).max() + 1e-300))


def is_special_case(inner: Candidate, outer: Candidate, crossfit: CrossFit) -> bool:
    """Whether ``outer`` can do all that ``inner`` does: then it is its generalization, no rival.

    A law that contains another one is that one where its search ends there: a spring was told as undecided from
    one with a slack part of no width, which has one column more to bend and none in its candidate.

    What a sensor picks up of another joint is no case of a torque that acts: of a partner that has inertia and
    viscous friction alone it is a coupling by both of them, and was told as certain.
    """
    if outer.term.joint != inner.term.joint:
        return False
    if inner.term.effect in outer.term.law.contains:
        return True
    law = inner.term.law
    if outer.size <= inner.size or (isinstance(law, MeasurementLaw) and law.crosses):
        return False
    fold = crossfit.whole
    a = fold.free_part(inner.columns[0]).reshape(-1, inner.columns[0].shape[2])
    b = fold.free_part(outer.columns[0]).reshape(-1, outer.columns[0].shape[2])
    b = b / np.maximum(np.linalg.norm(b, axis=0), 1e-300)
    left = a - b @ lstsq(b, a, rcond=1e-6)
    return bool(np.linalg.norm(left) < SPECIAL_CASE * np.linalg.norm(a))


def overlap(one: Candidate, other: Candidate, crossfit: CrossFit) -> float:
    """Correlation of what two candidates take off the residual, 1 if they say the same."""
    fold = crossfit.whole
    said = []
    for candidate in (one, other):
        free = fold.free_part(candidate.columns[0])
        said.append((free @ coefficients(free, fold)).ravel())
    size = np.linalg.norm(said[0]) * np.linalg.norm(said[1])
    return float(said[0] @ said[1] / size) if size > 0 else 0.0


def beats(one: Score, other: Score, rules: Rules, crossfit: CrossFit) -> bool:
    """Whether the first explains what the second leaves, and the second nothing that the first leaves.

    Encompassing by held-out prediction: G. E. Mizon, J.-F. Richard, Econometrica 54 (1986).
    """

    def more(new: Score, old: Score) -> bool:
        beside = crossfit.with_columns(old.candidate.columns)
        left = score(new.candidate, beside).judged_as(new)
        return adds(replace(left, p_value=p_value_beside_fit(left, beside)), rules)

    return more(one, other) and not more(other, one)


def plainness(s: Score) -> tuple[int, int]:
    """Numbers that a candidate spends, and those of them that bend its shape: the fewer the plainer.

    The candidate of a drive that distorts its torque has the usual shape, for which nobody searches.
    """
    law = s.candidate.term.law
    usual = isinstance(law, MeasurementLaw) and law.distortion is not None
    return s.candidate.size, 0 if usual else len(law.nonlinear)


def _as_good(one: Score, best: Score) -> bool:
    return one.beside(best).sum() > AS_GOOD * best.beside(one).sum()


def choose(passed: list[Score], rules: Rules, crossfit: CrossFit) -> tuple[Score, list[Score]]:
    """The best of those that passed, and its rivals: those the data do not tell from it.

    The best is the one that gains most, but for a law of the arm all of which laws of its joints say
    (:func:`jaxswarm.diagnose.decision.of_joints.told_by_joints`); of laws that show on its joint, the one that
    gains most there.
    Rivals say the same as the best, gain within ``rules.tie`` standard errors of it, and are beaten by
    none of the others. Among them the one with the fewest parameters is chosen, and of those the one with the
    fewest that bend its shape: a spring before a cubic one.
    """
    ranked = sorted(passed, key=lambda s: -s.gain)
    while told_by_joints(ranked[0], ranked[1:], rules, crossfit):
        ranked = ranked[1:]
    first = ranked[0]
    alike = [first, *(s for s in ranked[1:] if s.shows_with(first))]
    best = max(alike, key=lambda s: s.beside(first).sum())
    close = [
        s
        for s in ranked
        if s is best
        or (
            overlap(best.candidate, s.candidate, crossfit) > OVERLAP
            and (difference(best, s) < rules.tie or _as_good(s, best))
        )
    ]
    standing = [
        s for s in close if not any(beats(r, s, rules, crossfit) for r in close if r is not s)
    ]
    chosen = min(standing or close, key=lambda s: (plainness(s), -s.beside(best).sum()))
    rivals = [
        s
        for s in standing
        if s is not chosen and not is_special_case(chosen.candidate, s.candidate, crossfit)
    ]
    return chosen, rivals
