"""What an estimate says about every parameter: value, error, verdict; as plain data for JSON and tables."""

import numpy as np

from jaxswarm.effects.base import Effect
from jaxswarm.effects.kinds import ExternalTorque
from jaxswarm.effects.term import Term, physical_unit
from jaxswarm.identify.estimation.base_parameters import BaseParameters
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.event_rows import event_columns
from jaxswarm.robot.model import Robot
from jaxswarm.robot.names import PARAMETER_UNITS

# Below this relative standard error, or this share of the torque, a parameter is called determined.
_RELATIVE, _TORQUE_SHARE = 0.1, 0.005
# A share of a column below this is rounding.
_MERGED = 1e-6
# Verdicts that ask for no second look.
SOUND = frozenset({"determined", "negligible"})
# Half a 95 % interval in standard errors; places of mass and moments of inertia among a link's ten.
_HALF, _NEVER_NEGATIVE = 1.96, (0, 4, 6, 9)


def units(robot) -> tuple[str, ...]:
    """Torque unit of every joint: N m, or N for a prismatic one."""
    return tuple("N" if kind == "prismatic" else "N m" for kind in robot.kinds)


def base_parameter_table(found: Estimate) -> list[dict]:
    """One row per base parameter: name, expression, value, std_error, relative error, verdict.

    Verdicts: ``determined``; ``negligible`` (standard error above 10 % of the value, but all of its interval
    is worth less than 0.5 % of the torque); ``weak`` (standard error above 10 % of the value and worth more
    than 0.5 % of the torque, or below zero where no body is, within its interval); ``impossible`` (below zero
    there by more than that); ``at bound`` (physics holds it there, the data would go beyond).
    """
    solution, regression = found.fit, found.regression
    size = np.sqrt((regression.torque**2).mean())
    effect = np.sqrt((regression.columns[:, :, solution.base.kept] ** 2).mean(axis=(0, 1)))
    positive = _positive(solution.base, 10 * found.model.robot.num_joints)
    rows = []
    for k, (column, text) in enumerate(
        zip(solution.base.kept, solution.base.expressions(), strict=True)
    ):
        value, error = float(solution.values[k]), float(solution.std_error[k])
        relative = error / abs(value) if value else np.inf
        if solution.at_bound[k]:
            verdict = "at bound"
        elif positive[k] and value < 0.0:
            verdict = "weak" if value + _HALF * error > 0.0 else "impossible"
        elif relative <= _RELATIVE:
            verdict = "determined"
        elif (abs(value) + _HALF * error) * effect[k] <= _TORQUE_SHARE * size:
            verdict = "negligible"
        elif error * effect[k] <= _TORQUE_SHARE * size:
            verdict = "determined"
        else:
            verdict = "weak"
        name, _, law = solution.base.names[column].partition(":")
        rows.append(
            {
                "name": name,
                "effect": law or "rigid_body",
                "expression": text,
                "value": value,
                "std_error": error,
                "relative_error": relative,
                "unit": _unit(found, int(column)),
                "verdict": verdict,
            }
        )
    return rows


def _positive(base: BaseParameters, rigid: int) -> np.ndarray:
    """Whether a base parameter is a sum of masses and moments of inertia alone, which no body has below zero.

    Args:
        base: The base parameters.
        rigid: Number of columns of the rigid body, the first ones.
    """
    columns = np.arange(len(base.names))
    sound = (columns < rigid) & np.isin(columns % 10, _NEVER_NEGATIVE)
    merged = np.where(sound[base.dropped], base.merge < -_MERGED, np.abs(base.merge) > _MERGED)
    return sound[base.kept] & ~merged.any(axis=1)


def unidentified(found: Estimate) -> list[dict]:
    """Parameters the data cannot give alone: merged into others, or never excited."""
    base = found.fit.base
    events = event_columns(found.model.robot, found.model.terms)
    merged = []
    for k, column in enumerate(base.dropped):
        into = [base.names[base.kept[i]] for i in np.flatnonzero(np.abs(base.merge[:, k]) > 1e-6)]
        merged.append(
            {
                "name": base.names[column],
                "verdict": "not identifiable",
                "reason": f"only together with {', '.join(n.split(':')[0] for n in into)}",
            }
        )
    dead = [
        {"name": base.names[c], "verdict": "not identifiable", "reason": "no torque in this motion"}
        for c in base.dead
        if not events[c]
    ]
    return merged + dead


def term_parameters(term: Term, robot: Robot, errors: dict[str, float] | None = None) -> dict:
    """Parameters of a term with value, standard error and unit, derived ones and torques included.

    Those that do nothing at its values are left out.
    """
    law: Effect = term.law
    kind = "revolute" if term.joint is None else robot.kinds[term.joint]
    told = [p for p in law.parameters if p.name not in law.silent(term.values)]
    rows = [(p.name, term.values[p.name], physical_unit(p.unit, kind)) for p in told]
    if law.derived is not None:
        derived = law.derived(term.values).items()
        rows += [(name, value, physical_unit(unit, kind)) for name, (value, unit) in derived]
    # An external torque is one on every joint beside the parameters of its law.
    own = {name for name, _, _ in rows}
    torques = zip(term.linear_names(robot.joints), linear_units(term, robot), strict=True)
    rows += [(n, term.values.get(n, 0.0), unit) for n, unit in torques if n not in own]
    return {
        name: {
            "value": float(value),
            "std_error": None if errors is None else errors.get(name),
            "unit": unit,
        }
        for name, value, unit in rows
    }


def linear_units(term: Term, robot: Robot) -> list[str]:
    """Units of the values that a term's columns multiply, in their order."""
    if isinstance(term.law, ExternalTorque):
        return list(units(robot))
    kind = "revolute" if term.joint is None else robot.kinds[term.joint]
    return [physical_unit(p.unit, kind) for p in term.law.linear]


def with_intervals(table: dict) -> dict:
    """The table of :func:`term_parameters` with a 95 % interval wherever a standard error is known."""
    for row in table.values():
        error = row["std_error"]
        if error is not None and np.isfinite(error):
            row["interval_95"] = [row["value"] - 1.96 * error, row["value"] + 1.96 * error]
    return table


def correlation(found: Estimate) -> np.ndarray:
    """Correlation matrix of the base parameters (zero rows where one is at its bound)."""
    scale = np.where(found.fit.std_error > 0, found.fit.std_error, 1.0)
    return found.fit.covariance / np.outer(scale, scale)


def _unit(found: Estimate, column: int) -> str:
    robot = found.model.robot
    if column < 10 * robot.num_joints:
        return PARAMETER_UNITS[column % 10]
    own = [unit for term in found.model.terms for unit in linear_units(term, robot)]
    return own[column - 10 * robot.num_joints]
