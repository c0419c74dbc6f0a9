"""Whether a law that is missing shows where joints rest, and not friction that holds them there.

What a model leaves at rest is taken for dry friction's before anything is added
(:mod:`jaxswarm.identify.estimation.standing`). A law of the position that is missing looks the same there, and
rest is where it is seen best: on a cycle of four points two of five joints were taken for held, and a wrong
reading of one of them was told as two others, beside which the error on other motion grew three times. With the
rest it was named, and all was left within its noise. Nor need any law be missing: of a clean arm a slide creeps
at rest, by a sign whose width motion alone does not tell, and was left at 3.4 times its noise; with it at 0.3.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import ABOVE_NOISE, NEAR
from jaxswarm.diagnose.folds.noise import noise_of
from jaxswarm.diagnose.selection.elsewhere import errors_elsewhere
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.identify.estimation.standing import held, mixed_with, standing
from jaxswarm.logs.motion import Motion

# Rounds of the second search beyond the steps of the first: what every drive has, clocks, and one law.
_MORE_ROUNDS = 3


def with_rest(
    search: Search, motions: Sequence[Motion], searched: Callable[[Sequence[Motion], int], Search]
) -> Search:
    """The search with all rows, where its model explains rest and motion by no more numbers; else the search.

    By more of them where other logs show that these are right.

    It is made only where rows were left out at rest and motion alone is not explained by what was declared.

    Args:
        search: A search that may have left out rest.
        motions: The logs it was given.
        searched: ``searched(motions, most)``: a search of so many rounds on these logs.
    """
    rest = standing(motions)
    known = [m.held for m in search.current.motions]
    left_out = any((h & r).any() for h, r in zip(known, rest, strict=True) if h is not None)
    loud = over_noise(search.current).max() > NEAR
    if not left_out or search.budget.spent or not (search.steps or loud):
        return search
    search.progress("asking whether a law shows where joints rest")
    every = [replace(m, held=np.zeros_like(r)) for m, r in zip(motions, rest, strict=True)]
    # A model that is far from the noise in motion gets there by what rest shows, or not at all.
    again = searched(every, _MORE_ROUNDS + (0 if loud else len(search.steps)))
    nothing = not again.steps and not loud  # what was near with something added lacked it
    if again.ended or again.budget.spent or again.sticking or nothing:
        return search
    near = over_noise(again.current).max() <= NEAR
    left = again.current.fit.residual
    explained = near and not held(left, rest, mixed_with(motions, rest)).any()
    plain = loud or _numbers(again) <= _numbers(search) or _better_elsewhere(search, again)
    return again if explained and plain else search


def _better_elsewhere(search: Search, again: Search) -> bool:
    """Whether the model with rest has lower errors on every other log, and raises none there above the noise.

    Bristles whose friction falls with speed were told as plain ones, which spend two numbers less, while their
    rest was left out: 1.6 times the noise on another log, and 0.9 with all four.
    """
    before, after = search.current, again.current
    noise = noise_of(after)
    told = [
        falls.any() and not (rises & (two > ABOVE_NOISE * noise)).any()
        for _, two, falls, rises, _ in errors_elsewhere(before, after, search.other)
    ]
    return bool(search.other) and all(told)


def _numbers(search: Search) -> int:
    """Numbers that the additions of a search spend."""
    return sum(step.score.candidate.size for step in search.steps)
