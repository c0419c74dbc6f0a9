"""Every number of a model or a report with its name, so that two of them can be put side by side."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jaxswarm.identify.estimation.base_parameters import find_base
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.physical.physical_model import random_columns
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
            found.append(Value(place, name, row["value"], row.get("std_error"), row["unit"]))
    return found


def values_of_report(result: Mapping) -> list[Value]:
    """Base parameters of the rigid body, where there are some, and effects of a report."""
    rigid = [
        Value("rigid_body", row["expression"], row["value"], row["std_error"], row["unit"])
        for row in result.get("base_parameters", ())
        if row["effect"] == "rigid_body"
    ]
    return rigid + _effect_values(result["effects"])


def values_of_model(model: Model) -> list[Value]:
    """Base parameters of the arm itself, whatever basis the log gave, and effects; no intervals."""
    robot = model.robot
    base = find_base(random_columns(robot).reshape(-1, 10 * robot.num_joints),
                     standard_parameter_names(robot))  # fmt: skip
    values = base.reduce(np.asarray(robot.parameters).ravel())
    rigid = [
        Value("rigid_body", text, float(value), None, "")
        for text, value in zip(base.expressions(), values, strict=True)
    ]
    effects = [
        {
            "effect": term.effect,
            "joint": None if term.joint is None else robot.joints[term.joint],
            "other": None if term.other is None else robot.joints[term.other],
            "parameters": term_parameters(
                term, "revolute" if term.joint is None else robot.kinds[term.joint]
            ),
        }
        for term in model.terms
    ]
    return rigid + _effect_values(effects)
