"""All that is computed once a selection has ended; the report words and draws it, and fits nothing."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.diagnose.decision.remainder import Remainder, remainders
from jaxswarm.diagnose.decision.rules import GAINS_MORE, Rules
from jaxswarm.diagnose.decision.unexplained import Unexplained, with_smooth_terms
from jaxswarm.diagnose.decision.verdict import NO_PROOF, OTHER_MOTION, REGIONS
from jaxswarm.diagnose.decision.worth import Score, passes
from jaxswarm.diagnose.folds.noise import noise_of
from jaxswarm.diagnose.folds.other_motion import regions
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.refit import refit_with
from jaxswarm.diagnose.selection.step import Addition, Step
from jaxswarm.diagnose.selection.unseen_errors import UnseenErrors
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Motion

# Rivals of an effect that are told, the nearest first.
_MOST_RIVALS = 2


@dataclass(frozen=True)
class Undecided:
    """A rival that the data do not tell from an added effect.

    Attributes:
        step: The added effect.
        rival: What it was worth.
        model: The model with the rival in place of the effect.
    """

    step: Step
    rival: Score
    model: Model


@dataclass(frozen=True)
class Outcome:
    """The end of a diagnosis in numbers.

    Attributes:
        diagnosis: What the selection found.
        left: Structure that no law explains.
        remains: What is left on every joint, against its noise.
        noise: Standard deviation of the noise below the torque cutoff [N m or N], (n,).
        before, after: Errors of the declared and of the final model on unseen motion.
        smooth: Errors with the smooth terms for what no law explains; None: there are none, or no
            validation log.
        validation: Errors on every validation log.
        steps: Errors before and after every step, then before and after every discovered law.
        undecided: Rivals that the data do not tell from what was added.
        proof: On what motion the outcome is shown.
    """

    diagnosis: Diagnosis
    left: tuple[Unexplained, ...]
    remains: tuple[Remainder, ...]
    noise: np.ndarray
    before: dict
    after: dict
    smooth: dict | None
    validation: list[dict]
    steps: tuple[tuple[dict, dict], ...]
    undecided: tuple[Undecided, ...]
    proof: str


def outcome_of(
    diagnosis: Diagnosis,
    left: Sequence[Unexplained] = (),
    validation: Sequence[Motion] = (),
    laws: Sequence[Addition] = (),
) -> Outcome:
    """Compute what the report tells.

    Args:
        diagnosis: The outcome of the selection.
        left: Structure that remains.
        validation: Logs to score on.
        laws: Discovered laws, with the fits around them, as steps.
    """
    final = diagnosis.final
    errors = UnseenErrors(validation, diagnosis.declared, final)
    smooth = any(item.term is not None for item in left)
    return Outcome(
        diagnosis,
        tuple(left),
        remainders(final),
        noise_of(final),
        errors.of(diagnosis.declared),
        errors.of(final),
        errors.with_model(with_smooth_terms(final, left)) if smooth else None,
        errors.validation,
        tuple((errors.of(s.before), errors.of(s.after)) for s in (*diagnosis.steps, *laws)),
        tuple(one for step in diagnosis.steps for one in _undecided(step, diagnosis.rules)),
        _proof(final, validation),
    )


def _undecided(step: Step, rules: Rules) -> list[Undecided]:
    """The nearest rivals of an added effect that a fit can hold, and what gains more but may be chance."""
    found = []
    for rival in (*step.rivals, *_that_gain_more(step, rules))[:_MOST_RIVALS]:
        other = refit_with(step.before, rival)
        if other is not None:
            found.append(Undecided(step, rival, other.model))
    return found


def _that_gain_more(step: Step, rules: Rules) -> list[Score]:
    """Runners-up that gain more than what was added, and may be chance as it may not.

    Stribeck friction of p = 1e-17 took 0.36 off a joint in 13 s, an error of the link 0.92 at p = 0.003.
    What an earlier model holds otherwise is a change, which no other law is.
    """

    def may_be(s: Score) -> bool:
        law = s.candidate.term.law
        contained = step.added.effect in law.contains or step.added.effect in law.extends
        return not (contained or law.recurring) and passes(replace(s, p_value=0.0), 1, rules)

    if step.rest is not None:
        return []
    told = {s.candidate.term.identity for s in step.rivals}
    more = [s for s in step.others if s.relative_gain(step.score) > GAINS_MORE]
    return [s for s in more if s.candidate.term.identity not in told and may_be(s)]


def _proof(final: Estimate, validation: Sequence[Motion]) -> str:
    """On what motion the outcome is shown."""
    if validation:
        return OTHER_MOTION
    return NO_PROOF if regions(final) is None else REGIONS
