"""What began in the middle of a fitted log, in another one: at the same second, not at all, or from its start.

A seal that went at the eighth second of one log was whole in the log before it and is gone in those after. Of
jumps that were in one log of two alone, all were refused, as other logs were predicted with the jump at the
same second.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.logs.motion import Motion

# How a log may stand to what began in another one.
AS_FITTED, NOT_BEGUN, ALL_ALONG = "as fitted", "not begun", "all along"
# Time [s] before a log, by which what began there has come about.
_BEFORE = 1.0


def in_state_of(model: Model, motions: Sequence[Motion]) -> Model:
    """The model of a log: whatever begins in it as fitted, not at all, or all along, as leaves least.

    Args:
        model: The model.
        motions: Stretches of one log that was not fitted.
    """
    here = model.during(None)
    for _, _, chosen in _choices(model, motions):
        here = chosen
    return here


def states_of(model: Model, motions: Sequence[Motion]) -> dict[Term, str]:
    """Which of the three is chosen, of every term that begins."""
    return {term: state for term, state, _ in _choices(model, motions)}


def _choices(model: Model, motions: Sequence[Motion]) -> Iterator[tuple[Term, str, Model]]:
    """Every term that begins with the best of its three states, and the model with it.

    Events of fitted logs are in none.
    """
    model = model.during(None)
    for term in model.terms:
        if term.law.begins is None:
            continue
        others = tuple(t for t in model.terms if t is not term)
        before = min(float(m.t[0]) for m in motions) - _BEFORE
        early = replace(term, values={**term.values, term.law.begins: before})
        kept = tuple(early if t is term else t for t in model.terms)
        models = {
            AS_FITTED: model,
            NOT_BEGUN: replace(model, terms=others),
            ALL_ALONG: replace(model, terms=kept),
        }
        # The first of those that leave as little, so that one that begins after the log stays as fitted.
        state = min(models, key=lambda state: _left(models[state], motions, term.index))
        model = models[state]
        yield term, state, model


def _left(model: Model, motions: Sequence[Motion], joint: int) -> float:
    """Sum of the squared residual of a joint below the torque's cutoff."""
    left = 0.0
    for motion in motions:
        predicted = motion.decimator.apply(model_torque(model.on_joint(joint), motion))
        rows = slice(None) if motion.lost is None else ~motion.lost_rows
        left += float(((motion.low_torque - predicted)[rows, joint] ** 2).sum())
    return left
