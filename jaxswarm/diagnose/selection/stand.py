"""Which of the candidates that passed may stand beside what the model has already."""

from collections.abc import Sequence

from jaxswarm.diagnose.candidates.position_laws import imitates, strays
from jaxswarm.diagnose.decision.score import Score
from jaxswarm.diagnose.decision.sharpness import only_friction, only_sharp
from jaxswarm.diagnose.selection.state import Search

_ALONE = "shows in dry friction alone, which may be early or late by itself"
_SHARP = "shows only where the motion is sharper than its samples"
_STRAY = "is no multiple of an order seen through too few periods"
_BENT = "would be, with another law, any torque of one place"


def that_may_stand(search: Search, passed: Sequence[Score]) -> list[Score]:
    """Those that passed without what may not stand beside the model as it is, refused with the reason."""
    model, motions = search.current.model, search.current.motions
    sharp = only_sharp(list(passed), search.current, search.folds, len(search.scores), search.rules)
    stray = [s for s in passed if strays(s.candidate.term, model.terms, motions)]
    bent = [s for s in passed if imitates(s.candidate.term, model.terms, motions)]
    alone = only_friction(passed, search.current, search.folds, len(search.scores), search.rules)
    for found, why in ((sharp, _SHARP), (stray, _STRAY), (bent, _BENT), (alone, _ALONE)):
        for one in found:
            search.refuse(one.candidate.term, why)
    # Should the law that is there be none, these are asked again.
    search.kept_out |= {one.candidate.term.joint for one in bent}
    return [s for s in passed if s not in (*sharp, *stray, *bent, *alone)]
