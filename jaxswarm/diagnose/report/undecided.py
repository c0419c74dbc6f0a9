"""Pairs of laws that a log does not tell apart, each with the motion that would: ``undecided``."""

import numpy as np

from jaxswarm.diagnose.report.experiment import NO_MOTION, best_experiment, separating_command
from jaxswarm.diagnose.report.place import place
from jaxswarm.diagnose.selection.outcome import Outcome, Undecided
from jaxswarm.effects.alike import has
from jaxswarm.effects.term import Term


def undecided(outcome: Outcome, joints: tuple[str, ...]) -> list[dict]:
    """Rivals of what was added, and what was not added as waves that are hardly seen do better."""
    added = [_of_addition(one, joints) for one in outcome.undecided]
    return added + _of_waves(outcome, joints)


def _pair(one: Term, other: Term, experiment: str, joints: tuple[str, ...]) -> dict:
    names = [one.effect, other.effect]
    if names[0] == names[1]:
        names = [one.label(joints), other.label(joints)]
    return {
        "joint": place(one, joints)["joint"],
        "effects": names,
        "rival": place(other, joints),
        "experiment": experiment,
    }


def _of_addition(one: Undecided, joints: tuple[str, ...]) -> dict:
    """A rival of an added effect, with the motion on which the two would differ most."""
    step, other = one.step, one.rival.candidate.term
    trial = best_experiment(step.after.model, one.model, step.after.motions[0], step.added.joint)
    command = separating_command(step.added, other, joints) if trial.ratio >= NO_MOTION else ""
    return _pair(step.added, other, trial.words(joints) + command, joints)


def _of_waves(outcome: Outcome, joints: tuple[str, ...]) -> list[dict]:
    """For each joint that is far from its noise, the first law that waves did better than."""
    told: dict[int, dict] = {}
    final = outcome.diagnosis.final
    for law, waves, period in outcome.diagnosis.outdone:
        joint = waves.index
        stands = any(has(t, final.model.terms) for t in (law, waves))  # beside what came later
        if stands or outcome.remains[joint].near or joint in told:
            continue
        way = max(float(np.ptp(m.q[:, joint])) for m in final.motions)
        experiment = (
            f"move {joints[joint]} over more than {max(way, period):.2g}, a whole period of "
            f"{waves.effect}, where this log has {way:.2g}"
        )
        told[joint] = _pair(waves, law, experiment, joints)
    return list(told.values())
