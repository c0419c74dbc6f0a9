"""What was found about the channels of a log, asked again without the stretches in which something happened.

The checks of a log know no events. A load held for 6 s of a log of 16 s was told as the zero of a joint that
read 0.23 rad too small, which left 9.6 % of the torque where 12 % were left without it; outside of those 6 s
nothing is wrong with that zero.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from jaxswarm.errors import InputError
from jaxswarm.identify.checks.channels import enough
from jaxswarm.identify.checks.check_log import against_robot
from jaxswarm.identify.checks.guesses import ENCODER_ZERO
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.rough_fit import ROWS_THAT_HOLD
from jaxswarm.identify.checks.samples import samples_of
from jaxswarm.identify.estimation.validate import outside
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.run import findings
from jaxswarm.logs.finding import Finding
from jaxswarm.logs.log import Log, take
from jaxswarm.logs.segments import prepare_segments

# Of the fitted logs or of those to score on, and which of them.
Place = tuple[str, int]


def doubtful(fitted: Sequence[Log], scored: Sequence[Log]) -> dict[Place, Log]:
    """Logs of which something was found that an event can look like: a zero, with which the work goes on."""
    logs = {("logs", k): log for k, log in enumerate(fitted)}
    logs |= {("validation_logs", k): log for k, log in enumerate(scored)}
    return {place: log for place, log in logs.items() if _zeros(log.findings)}


def told_again(
    told: Mapping[str, Any], result: Mapping[str, Any], logs: Mapping[Place, Log], model: Model
) -> dict:
    """What a result says of its logs, with zeros of joints asked again outside of what happened in them.

    Args:
        told: The logs, the validation logs and the findings, as :func:`jaxswarm.identify.run.told_of` has them.
        result: The errors on validation logs, with the stretches [s] that were not scored.
        logs: Those of :func:`doubtful`.
        model: The final model, with the events of the fitted logs.
    """
    told = {**told, "logs": [*told["logs"]], "validation_logs": [*told["validation_logs"]]}
    for (kind, number), log in logs.items():
        if kind == "logs":
            windows = [
                (term.values["start"], term.values["end"])
                for term in model.terms
                if term.law.in_one_log
                and "start" in term.values
                and int(term.values.get("log", 0)) == number
            ]
        else:
            events = result["error"]["validation"][number]["after"].get("events", ())
            windows = [(event["start"], event["end"]) for event in events]
        again = without_events(log, windows, model)
        told[kind][number] = {**told[kind][number], "notes": list(again.notes)}
        old, new = findings([log]), findings([again])
        kept = [one for one in told["findings"] if one in new or one not in old]
        told["findings"] = [*kept, *(one for one in new if one not in old)]
    return told


def without_events(log: Log, windows: Sequence[tuple[float, float]], model: Model) -> Log:
    """The log with what its rest bears out of the zeros that were told of its joints.

    Args:
        log: A checked log, with its notes.
        windows: Begins and ends [s] of what happened, from the begin of the log.
        model: For its robot and frequencies.

    Returns:
        The log; where something happened, its zeros are those that the samples outside of that tell. One whose
        rest is too little for a check keeps what was told.
    """
    if not windows:
        return log
    try:
        calm = take(log, outside(log.t - log.t[0], windows))
        motions = prepare_segments(calm, model.filtering)[1]
    except InputError:  # too short
        return log
    samples = samples_of(motions)
    few = not enough(model.robot, samples)
    if few or Rough(model.robot, samples).rows_per_parameter < ROWS_THAT_HOLD:
        return log  # what does not show there may be so for all that
    old = [one.note for one in _zeros(log.findings)]
    found = _zeros(against_robot(model.robot, motions))
    others = [one for one in log.findings if one.check != ENCODER_ZERO]
    notes = [note for note in log.notes if note not in old]
    return replace(log, notes=(*notes, *(one.note for one in found)), findings=(*others, *found))


def _zeros(findings: Iterable[Finding]) -> list[Finding]:
    return [one for one in findings if one.check == ENCODER_ZERO]
