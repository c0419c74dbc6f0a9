"""The names of a model's columns, in their order."""

from jaxswarm.effects.term import Term
from jaxswarm.robot import standard_parameter_names
from jaxswarm.robot.model import Robot


def column_names(robot: Robot, terms: tuple[Term, ...]) -> tuple[str, ...]:
    """Names of all columns: standard parameters, then ``parameter_joint:effect``."""
    names = list(standard_parameter_names(robot))
    for term in terms:
        names.extend(term.columns(robot.joints))
    return tuple(names)
