"""Every number of a model or a report with its name, so that two of them can be put side by side."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.base_parameters import find_base
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.forward.names import column_names
from jaxswarm.identify.physical.physical_model import base_matrix, random_columns
from jaxswarm.identify.report.summary import term_parameters
from jaxswarm.robot import standard_parameter_names


@dataclass(frozen=True)
class Value:
    """One number of a result: what it is, its value, standard error (None where unknown) and unit."""

    place: str
    name: str
    value: float
    std_error: float | None
    unit: str


def _effect_values(effects: list[dict]) -> list[Value]:
    found = []
    for effect in effects:
        other = f":{effect['other']}" if effect.get("other") else ""
        place = effect["effect"] + ("" if effect["joint"] is None else f"@{effect['joint']}{other}")
        for name, row in effect["parameters"].items():
            found.append(Value(place, name, _known(row), row.get("std_error"), row["unit"]))
    return found


def _known(row: Mapping) -> float:
    """The value of a row; NaN, which JSON cannot say, where it has none."""
    return np.nan if row["value"] is None else row["value"]


def values_of_report(result: Mapping) -> list[Value]:
    """Base parameters of the rigid body, where there are some, and effects of a report."""
    rigid = [
        Value("rigid_body", row["expression"], _known(row), row.get("std_error"), row["unit"])
        for row in result.get("base_parameters", ())
        if row["effect"] == "rigid_body"
    ]
    return rigid + _effect_values(result["effects"])


def values_of_model(model: Model) -> list[Value]:
    """Base parameters of the arm itself, whatever basis the log gave, and effects."""
    robot = model.robot
    links = 10 * robot.num_joints
    base = find_base(random_columns(robot).reshape(-1, links), standard_parameter_names(robot))
    values = base.reduce(np.asarray(robot.parameters).ravel())
    names = column_names(robot, model.terms)
    covariance = None if model.uncertainty is None else model.uncertainty.on(names)
    errors: list[float | None] = [None] * base.size
    if covariance is not None:
        matrix = base_matrix(base)
        variance = np.diag(matrix @ covariance[:links, :links] @ matrix.T)
        errors = [float(e) for e in np.sqrt(np.maximum(variance, 0.0))]
    rigid = [
        Value("rigid_body", text, float(value), error, "")
        for text, value, error in zip(base.expressions(), values, errors, strict=True)
    ]
    effects = [
        {
            "effect": term.effect,
            "joint": None if term.joint is None else robot.joints[term.joint],
            "other": None if term.other is None else robot.joints[term.other],
            "parameters": term_parameters(term, robot, _errors(model, term, names, covariance)),
        }
        for term in model.terms
    ]
    return rigid + _effect_values(effects)


def _errors(model: Model, term: Term, names: tuple[str, ...], covariance) -> dict | None:
    """Standard errors of a term's linear parameters by name, where the model knows them."""
    if covariance is None or model.uncertainty is None:
        return None
    joints, known = model.robot.joints, set(model.uncertainty.columns)
    pairs = zip(term.linear_names(joints), term.columns(joints), strict=True)
    return {
        name: float(np.sqrt(covariance[names.index(column), names.index(column)]))
        for name, column in pairs
        if column in known
    }
