"""Names of a robot's standard inertial parameters, in the order of ``robot.parameters.ravel()``."""

from jaxswarm.robot.model import Robot

PARAMETER_SYMBOLS = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
PARAMETER_UNITS = ("kg",) + ("kg m",) * 3 + ("kg m^2",) * 6


def standard_parameter_names(robot: Robot) -> tuple[str, ...]:
    """Return the 10 n names ``m1, mx1, my1, mz1, Ixx1, Ixy1, Iyy1, Ixz1, Iyz1, Izz1, m2, ...``.

    >>> from jaxswarm.robot.builtin import emps
    >>> standard_parameter_names(emps())[:5]
    ('m1', 'mx1', 'my1', 'mz1', 'Ixx1')
    """
    links = range(1, robot.num_joints + 1)
    return tuple(f"{symbol}{link}" for link in links for symbol in PARAMETER_SYMBOLS)
