"""Which of the candidates that passed may stand beside what the model has already."""

from collections.abc import Sequence

from jaxswarm.diagnose.candidates.position_laws import imitates, is_unseen, strays
from jaxswarm.diagnose.decision.score import Score
from jaxswarm.diagnose.decision.sharpness import (
    FoldsOf,
    only_friction,
    only_sharp,
    refitted_folds,
)
from jaxswarm.diagnose.selection.state import Search

_ALONE = "shows in dry friction alone, which may be early or late by itself"
_SHARP = "shows only where the motion is sharper than its samples"
_STRAY = "is no multiple of an order seen through too few periods"
_UNSEEN = "is an order of which no whole period is seen: move the joint further"
_BENT = "would be, with another law, any torque of one place"


def that_may_stand(search: Search, passed: Sequence[Score]) -> list[Score]:
    """Those that passed without what may not stand beside the model as it is, refused with the reason."""
    model, motions = search.current.model, search.current.motions
    stray = [s for s in passed if strays(s.candidate.term, model.terms, motions)]
    bent = [s for s in passed if imitates(s.candidate.term, model.terms, motions)]
    unseen = [s for s in passed if is_unseen(s.candidate.term, motions)]
    standing = in_all_motion(search, passed)
    for found, why in ((stray, _STRAY), (bent, _BENT), (unseen, _UNSEEN)):
        for one in found:
            search.refuse(one.candidate.term, why)
    # Should the law that is there be none, these are asked again.
    search.kept_out |= {one.candidate.term.joint for one in bent}
    return [s for s in standing if s not in (*stray, *bent, *unseen)]


def in_all_motion(
    search: Search, passed: Sequence[Score], folds_of: FoldsOf = refitted_folds
) -> list[Score]:
    """Those that passed and show in all motion and torque they should show in; others refused with the reason.

    ``folds_of``: makes the folds of the model by the noise of every row.
    """
    current, folds, rules, asked = search.current, search.folds, search.rules, len(search.scores)
    sharp = only_sharp(list(passed), current, folds, asked, rules, folds_of)
    alone = only_friction(passed, current, folds, asked, rules)
    for found, why in ((sharp, _SHARP), (alone, _ALONE)):
        for one in found:
            search.refuse(one.candidate.term, why)
    return [s for s in passed if s not in (*sharp, *alone)]
