"""Changes as values with doubts and bounds, and the earlier model with them in it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.decision.rules import CHANGE_DOUBT
from jaxswarm.diagnose.decision.worth import Score, runners_up
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.diagnose.selection.change_fit import Coefficients, fit_changes
from jaxswarm.diagnose.selection.changed_model import apply_change
from jaxswarm.diagnose.selection.earlier_model import earlier_covariance
from jaxswarm.effects.term import Term, physical_unit
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.events import window_errors
from jaxswarm.identify.estimation.least_squares import Fit
from jaxswarm.identify.forward.model import Model

# A candidate with columns in units of torque, what it was worth when it was chosen, and its runners-up.
Picked = tuple[Candidate, Score, tuple[Score, ...]]


@dataclass(frozen=True)
class Change:
    """One thing that changed since the model was identified.

    Attributes:
        term: Effect and joint; its values are the change.
        std_errors: Of the values; NaN where a value cannot be told from others.
        known: Whether the model held the effect already, so that the values are differences.
        score: What it was worth when it was found.
        others: Runners-up.
        now: Where the effect was known, its values with the change in them,
        now_errors: and their standard errors.
        further: Torque (T', n) of a candidate's columns beyond its parameters, such as of masses that
            only another gravity loads; None: there are none.
    """

    term: Term
    std_errors: dict[str, float]
    known: bool
    score: Score
    others: tuple[Score, ...]
    now: dict[str, float] = field(default_factory=dict)
    now_errors: dict[str, float] = field(default_factory=dict)
    further: np.ndarray | None = None


def as_picked(chosen: Score, scores: Sequence[Score], crossfit: CrossFit) -> Picked:
    """A chosen candidate, with the columns of the whole log in units of torque, and its runners-up."""
    candidate = chosen.candidate
    # Rows within an event weigh nothing.
    weight = crossfit.weight[:, :, None]
    raw = np.divide(candidate.columns[0], weight, where=weight > 0, out=0.0 * candidate.columns[0])
    others = runners_up(chosen, scores)
    return replace(candidate, columns=(raw,) * len(candidate.columns)), chosen, others


def changes_of(before: Estimate, picked: Sequence[Picked]) -> tuple[Change, ...]:
    """Fit all picked changes together on what the earlier model leaves."""
    held = {t.identity: t for t in before.model.terms}
    found = fit_changes(before, [candidate for candidate, _, _ in picked])
    changes, start = [], 0
    for number, (candidate, worth, others) in enumerate(picked):
        own = slice(start, start + candidate.columns[0].shape[2])
        start = own.stop
        term = candidate.term
        values, errors = _values(term, own, found, before.model.robot.joints)
        if number in found.edges:
            errors |= dict.fromkeys(("start", "end"), found.edges[number])
        term, further = replace(term, values=values), None
        errors |= _window_errors(before, term, found.fit)
        told = len(term.law.candidate_names(before.model.robot.joints))
        if 0 < told < own.stop - own.start:
            further = candidate.columns[0][:, :, told:] @ found.values[own][told:]
        old = held.get(term.identity)
        now, now_errors = ({}, {}) if old is None else _now(before, old, term, own, found)
        changes.append(
            Change(term, errors, old is not None, worth, others, now, now_errors, further)
        )
    return tuple(changes)


def _window_errors(before: Estimate, term: Term, found: Fit) -> dict[str, float]:
    """Standard errors [s] of when a body was picked up and put down; unlike those of a fit they are on rows."""
    told = window_errors(
        term, before.model, found, before.regression, before.motions, before.rigids
    )
    within = before.regression.step[int(term.values.get("log", 0))] / np.sqrt(12.0)
    return {name: float(np.hypot(error, within)) for name, error in told.items()}


def doubt_of_any(changes: Sequence[Change], kinds: tuple[str, ...]) -> str | None:
    """Why changes found together cannot be believed, by the last one that cannot."""
    doubts = [doubt for change in changes if (doubt := doubt_of(change, kinds))]
    return doubts[-1] if doubts else None


def doubt_of(change: Change, kinds: tuple[str, ...]) -> str | None:
    """Why a change cannot be believed: a value beyond its bounds, or none that differs from zero.

    Args:
        change: The change.
        kinds: What every joint of the robot is, for units.
    """
    term, errors = change.term, change.std_errors
    values = {**term.values, **change.now}
    spread = {**errors, **change.now_errors}
    for p in term.law.parameters:
        slack = CHANGE_DOUBT * np.nan_to_num(spread.get(p.name, 0.0))
        if not p.lower - slack <= values[p.name] <= p.upper:
            unit = physical_unit(p.unit, "revolute" if term.joint is None else kinds[term.joint])
            return (
                f"{p.name} would be {values[p.name]:.3g} {unit}, outside "
                f"[{p.lower:g}, {p.upper:g}]: no value that it can have"
            )
    places = {p.name for p in term.law.nonlinear}
    told = [n for n, e in errors.items() if np.isfinite(e) and n not in places]
    neutral = term.law.neutral()
    change_of = {n: term.values[n] - neutral.get(n, 0.0) for n in told}
    if told and not any(abs(change_of[n]) > CHANGE_DOUBT * errors[n] for n in told):
        return "is no larger than its doubt, with that of the earlier model in it"
    return None


def _values(term: Term, own: slice, found: Coefficients, joints) -> tuple[dict, dict]:
    """Values and standard errors by name from the coefficients of a term's columns."""
    neutral, names = term.law.neutral(), term.law.candidate_names(joints)
    doubt = np.sqrt(np.diag(found.covariance)[own])
    pairs = zip(names, found.values[own], strict=False)
    # Its choices and its shape are those that its columns were made with; of no swing a base names none.
    told = {n: float(neutral.get(n, 0.0) + x) for n, x in pairs}
    table = {**neutral, **term.values, **told}
    return table, {n: float(x) for n, x in zip(names, doubt, strict=False)} if names else {}


def _now(before: Estimate, old: Term, term: Term, own: slice, found: Coefficients):
    """Values of a term that an earlier model held, with the change in them, and standard errors.

    An error of the earlier value comes out in the change with the other sign and is gone from the sum.
    """
    names = [p.name for p in old.law.linear]
    now = {**old.values, **{n: old.values[n] + term.values[n] for n in names}}
    places = [before.regression.names.index(c) for c in old.columns(before.model.robot.joints)]
    earlier, errors = earlier_covariance(before), {}
    for k, (name, column) in enumerate(zip(names, places, strict=True)):
        row = found.response[own][k]
        total = row.copy()
        total[column] -= 1.0
        drawn = found.covariance[own, own][k, k] - row @ earlier @ row + total @ earlier @ total
        errors[name] = float(np.sqrt(np.maximum(drawn, 0.0)))
    return now, errors


def with_changes(before: Estimate, changes: Sequence[Change]) -> Model:
    """The earlier model with changes in it; how certain it is now is not known."""
    model = before.model
    for change in changes:
        model = apply_change(change.term.law, model, change, before.motions)
    return replace(model, uncertainty=None) if changes else model
