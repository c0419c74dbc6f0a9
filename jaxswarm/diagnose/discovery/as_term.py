"""A formula as a term of a model: linear constants, names and units, and the columns by which it is scored."""

from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.own_load import with_own_load
from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.sums import Sum, free_columns, held_together, linear, polished
from jaxswarm.effects.dimensions import TORQUE, over, parse_unit, unit_of, unit_text
from jaxswarm.effects.formula import DISCOVERED, Formula
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.postfix import fields_of
from jaxswarm.effects.term import Term

# Names of the linear constants, and bounds that no torque of an arm asks for.
_LINEAR, _MOST = "abdfgh", 1e6
# A refit may go beyond the range that was searched: a scale by this factor, anything else by one range.
_BEYOND = 10.0


def as_term(problem: Joint, formula: Sum) -> Term:
    """The term of a formula on its joint, with the values of the fit to all rows."""
    fold = problem.lin.crossfit.whole
    a = linear(problem, formula, fold, free_columns(problem, formula, fold))
    inner = {p.name: parse_unit(p.unit) for p in formula.constants}
    table = []
    for k, program in enumerate(formula.programs):
        unit = unit_text(over(TORQUE, unit_of(program, inner, problem.units)))
        name = _LINEAR[k]
        table.append(
            Parameter(name, unit, -_MOST, _MOST, True, float(a[k]), f"factor of term {k + 1}")
        )
    table += [_wider(p, formula.values[p.name]) for p in formula.constants]
    law = Formula(formula.programs, tuple(table), validity(problem, formula))
    other = problem.other if law.couples else None
    values = {p.name: p.nominal for p in table}
    return Term(DISCOVERED, problem.joint, other, values, law)


def _wider(p: Parameter, value: float) -> Parameter:
    """A constant with the bounds of a refit, which starts at a value."""
    if p.scale == "log":
        return replace(p, lower=p.lower / _BEYOND, upper=p.upper * _BEYOND, nominal=value)
    span = p.upper - p.lower
    return replace(p, lower=p.lower - span, upper=p.upper + span, nominal=value)


def validity(problem: Joint, formula: Sum) -> tuple[tuple[str, float, float], ...]:
    """Range of every variable that a formula reads."""
    read = dict.fromkeys(name for p in formula.programs for name in fields_of(p))
    used = problem.lin.crossfit.weight[:, problem.joint] > 0.0
    return tuple(
        (name, float(problem.data[name][used].min()), float(problem.data[name][used].max()))
        for name in read
        if name != "direction"
    )


def candidate_of(problem: Joint, formula: Sum) -> tuple[Candidate, Term]:
    """A formula as a candidate of the selection: on every half with the constants found there.

    By the load it is refitted from the arm that it was seen with: from that of a model without it a law by the
    square of the load ended at 40 times the noise.
    """
    lin, term = problem.lin, as_term(problem, formula)
    start = None
    columns = []
    for fold in lin.crossfit.folds:
        own = formula if fold is lin.crossfit.whole else polished(problem, formula, fold)
        placed = replace(term, values={**term.values, **own.values})

        def made(at: Linearization, placed: Term = placed) -> np.ndarray:
            return np.nan_to_num(at.law(placed))

        said = made(lin)
        if term.law.uses_load:
            said = with_own_load(lin, fold, problem.joint, said, made)
        columns.append(said)
    if term.law.uses_load:
        told = held_together(problem, formula, lin.crossfit.whole)
        change = lin.found.fit.base.expand(told.change)
        start = lin.pi + change[: len(lin.pi)]
    size = len(term.found_formula.parameters)
    return Candidate(term, tuple(columns), size, start=start), term
