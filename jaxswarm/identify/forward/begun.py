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


def of_after(model: Model, motions: Sequence[Motion]) -> Model:
    """The model in which whatever begins in a log was there before another one: that of an arm from then on."""
    model = model.during(None)
    kept = (t if t.law.begins is None else _before(t, motions) for t in model.terms)
    return replace(model, terms=tuple(kept))


def in_another_log(
    model: Model, motions: Sequence[Motion], measured: bool
) -> tuple[Model, list[str]]:
    """The model as it predicts a log, and a sentence on everything that does not begin in it as fitted.

    Args:
        model: The model.
        motions: Stretches of one log.
        measured: Whether the log has torque, which tells whether it is of before or of after. Without one
            it is taken to be of after: nothing begins at the same second twice.
    """
    began = {
        t: t.values[t.law.begins] for t in model.during(None).terms if t.law.begins is not None
    }
    if not began:
        return model, []
    if measured:
        choices = list(_choices(model, motions))
        states, here = {term: state for term, state, _ in choices}, choices[-1][2]
    else:
        states, here = dict.fromkeys(began, ALL_ALONG), of_after(model, motions)
    why = "that leaves least of its torque" if measured else "it has no torque to tell by"
    told = {NOT_BEGUN: "not to have begun", ALL_ALONG: "to be there all along"}
    joints = model.robot.joints
    return here, [
        f"{t.label(joints)} began {seconds:.4g} s into a fitted log. In this one it is "
        f"taken {told[states[t]]}: {why}."
        for t, seconds in began.items()
        if states[t] in told
    ]


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
        early = _before(term, motions)
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


def _before(term: Term, motions: Sequence[Motion]) -> Term:
    """A term that had begun before a log."""
    begins = term.law.begins
    assert begins is not None  # callers ask for those that begin
    start = min(float(m.t[0]) for m in motions) - _BEFORE
    return replace(term, values={**term.values, begins: start})


def _left(model: Model, motions: Sequence[Motion], joint: int) -> float:
    """Sum of the squared residual of a joint below the torque's cutoff."""
    left = 0.0
    for motion in motions:
        predicted = motion.decimator.apply(model_torque(model.on_joint(joint), motion))
        rows = slice(None) if motion.lost is None else ~motion.lost_rows
        left += float(((motion.low_torque - predicted)[rows, joint] ** 2).sum())
    return left
