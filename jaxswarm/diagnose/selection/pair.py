"""Two laws where one was bent into their sum.

A law with free exponents may bend itself into the sum of two. Where structure is left on its joint,
each competitor is put in its place and it is asked for again beside it; the pair stays if it predicts
unseen blocks clearly better than the bent law did.
"""

from collections.abc import Sequence

import numpy as np
import scipy

from jaxswarm.diagnose.candidates.position_laws import imitates
from jaxswarm.diagnose.decision.evaluate import score_if_passing
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.diagnose.selection.refit import refit, refit_with
from jaxswarm.diagnose.selection.step import Step, chain, competitors, find_term
from jaxswarm.effects.alike import has
from jaxswarm.identify.estimation.estimate import Estimate


def pair(
    steps: Sequence[Step],
    current: Estimate,
    joints: Sequence[int],
    asked: int,
    rules: Rules,
    seed: int = 0,
) -> tuple[list[Step], Estimate] | None:
    """The first effect that is better told as two: the steps and the model with the pair; else None.

    Args:
        joints: Where structure is left.
        steps, current, asked, rules, seed: As for :func:`reconsider`.
    """
    for number, step in enumerate(steps):
        own, rivals = step.added.identity, competitors(step)
        there = {t.identity for t in current.model.terms}
        if step.score.joint not in joints or step.removed or own not in there or not rivals:
            continue
        rest = refit(current, tuple(t for t in current.model.terms if t.identity != own))
        for rival in rivals:
            one = score_if_passing(rest, rival, asked, rules, seed)
            first = None if one is None else refit_with(rest, one)
            if one is None or first is None:
                continue
            two = score_if_passing(first, step.added, asked, rules, seed)
            both = None if two is None else refit_with(first, two)
            # What comes second may hold what the first one says, and take its place.
            if two is None or both is None or not has(rival, both.model.terms):
                continue
            if imitates(find_term(both, rival), both.model.terms, both.motions):
                continue
            if not _predicts_better(both, current, step.score.joint, asked, rules):
                continue
            others = tuple(s for s in step.others if s.candidate.term.identity != rival.identity)
            found = [
                Step(find_term(first, rival), one, (), others, step.before, first, ()),
                Step(find_term(both, step.added), two, (), others, first, both, ()),
            ]
            return chain([*steps[:number], *found, *steps[number + 1 :]]), both
    return None


def _predicts_better(new: Estimate, old: Estimate, joint: int, asked: int, rules: Rules) -> bool:
    """Whether a model leaves clearly less on unseen blocks of a joint."""
    former = cross_fit(old)
    count = int(former.block.max()) + 1

    def blocks(crossfit: CrossFit) -> np.ndarray:
        total = np.zeros(count)
        for half in crossfit.halves:
            # A row in which friction holds the joint has no weight.
            out = ~half.train & (crossfit.weight[:, joint] > 0.0)
            left = half.residual[out, joint] / crossfit.weight[out, joint]
            np.add.at(total, former.block[out], (left * former.weight[out, joint]) ** 2)
        return total

    before, after = blocks(former), blocks(cross_fit(new))
    fall = before - after
    spread = fall.std(ddof=1) / np.sqrt(count)
    chance = scipy.special.stdtr(count - 1, -fall.mean() / max(spread, 1e-300))
    return bool(fall.sum() > rules.share * before.sum() and chance * asked < rules.significance)
