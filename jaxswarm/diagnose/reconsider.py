"""Once everything is added, every choice is made again: what one law hid may have misled an earlier one.

An effect was chosen among its competitors while others were still missing. With the others in place, the
model is fitted without it, it and its competitors are asked again, and the winner stays. What nobody
needs any more is dropped.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import jax
import numpy as np

from jaxswarm.diagnose.background import make_background, robust_weight
from jaxswarm.diagnose.decide import Rules, Score, choose, passes, score
from jaxswarm.diagnose.gather import gather
from jaxswarm.diagnose.refit import key_of, refit, refit_with
from jaxswarm.diagnose.stand import Memory, Stand
from jaxswarm.diagnose.step import Step
from jaxswarm.identify.estimate import Estimate
from jaxswarm.identify.terms import Term

# Competitors gained at least this part of what the chosen one gained; so many are asked again.
_NEAR, _MOST = 0.6, 4
# A simpler law may leave this much more of a joint's squared error.
_PRICE = 1.02


def reconsider(
    steps: Sequence[Step],
    current: Estimate,
    asked: int,
    rules: Rules,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> tuple[list[Step], Estimate, bool]:
    """Choose every added effect anew among its competitors, the others in place.

    Args:
        steps: What was added, in order.
        current: The model with all of it.
        asked: Suspects asked in the first round, for the level of the tests.
        rules: Thresholds.
        seed: Seed of the searches.
        progress: Called with one line per effect.

    Returns:
        The steps, the model, and whether an effect was exchanged or dropped.
    """
    done, changed = list(steps), False
    for step in steps:
        rivals = competitors(step)
        terms = {key_of(t): t for t in current.model.terms}
        if not rivals or step.removed or key_of(step.added) not in terms:
            continue
        progress(f"choosing {step.added.label(current.model.robot.joints)} again")
        own = key_of(step.added)
        rest = refit(current, tuple(t for t in current.model.terms if key_of(t) != own))
        background = make_background(rest)
        suspects = tuple(replace(t, values={}) for t in (step.added, *rivals))
        gathered = gather(Stand(rest, background), suspects, jax.random.key(seed), Memory())
        interval = max(m.interval for m in rest.motions)
        scores = [score(c, background, interval) for c in gathered]
        guilty = [s for s in scores if passes(s, asked, rules)]
        place = done.index(step)
        if not guilty:
            if all(s.share < rules.share for s in scores):
                del done[place]
                current, changed = rest, True
            continue
        chosen, near = choose(guilty, rules, background)
        if key_of(chosen.candidate.term) == own:
            done[place] = replace(step, rivals=tuple(near))
            continue
        after = refit_with(rest, chosen)
        if after is None or _cost(after, chosen, rest) > _PRICE * _cost(current, chosen, rest):
            continue
        others = tuple(s for s in sorted(scores, key=lambda s: -s.gain) if s is not chosen)
        added = _find(after, chosen.candidate.term)
        done[place] = replace(step, added=added, score=chosen, rivals=tuple(near), others=others)
        current, changed = after, True
    return (_chain(done) if changed else done), current, changed


def competitors(step: Step) -> list[Term]:
    """Terms that came near a chosen one on its joint when it was added, the best first."""
    near = [
        s
        for s in step.others
        if s.joint == step.score.joint
        and s.gain > _NEAR * step.score.gain
        and s.candidate.term.effect != "contact"
    ]
    known = {key_of(s.candidate.term): s.candidate.term for s in (*step.rivals, *near)}
    return list(known.values())[:_MOST]


def _chain(steps: list[Step]) -> list[Step]:
    """The same steps with the estimates before and after each as the exchanged effects make them."""
    done = []
    for step in steps:
        before = done[-1].after if done else step.before
        gone = {key_of(t) for t in step.removed}
        kept = tuple(t for t in before.model.terms if key_of(t) not in gone)
        after = refit(before, (*kept, step.added))
        done.append(replace(step, added=_find(after, step.added), before=before, after=after))
    return done


def _find(found: Estimate, term: Term) -> Term:
    """A term of a model with its fitted values."""
    return next(t for t in found.model.terms if key_of(t) == key_of(term))


def _cost(found: Estimate, chosen: Score, weights: Estimate) -> float:
    """Squared error of the joint in question, rare large residuals bounded."""
    weight = robust_weight(weights.fit.residual)
    return float(np.square((found.fit.residual * weight)[:, chosen.joint]).sum())
