"""An identified arm as YAML: names, placements, ten parameters a link, effects.

The ten parameters stand in the order of Pinocchio's ``Inertia.FromDynamicParameters``; placement and axis
of each joint are those of a ``JointModelRevoluteUnaligned`` or ``JointModelPrismaticUnaligned``. Every
value is written as JSON, which is YAML as well, so that no digit and no name is lost.
"""

import json
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from jaxswarm.robot.model import Robot

ORDER = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")


def yaml_text(
    robot: Robot, effects: Iterable[Any] = (), width: Sequence[float] | None = None
) -> str:
    """The text of the file.

    Args:
        robot: Robot with the link parameters to write.
        effects: Objects with ``effect``, ``joint``, ``other`` and ``values``, as in a model.
        width: Width of every joint's smooth sign [rad/s or m/s], where effects use one.
    """
    lines = [f"robot: {_value(robot.name)}", f"gravity: {_value(robot.gravity)}  # m/s^2"]
    lines += [f"# parameters: {', '.join(ORDER)}; kg, kg m, kg m^2 about the joint's origin"]
    lines += ["joints:"]
    for i, joint in enumerate(robot.joints):
        parent = None if robot.parents[i] < 0 else robot.joints[robot.parents[i]]
        gain = float(robot.drive_gain[i])
        entries = {
            "name": joint,
            "kind": robot.kinds[i],
            "parent": parent,
            "rotation": robot.rotation[i],
            "translation": robot.translation[i],
            "axis": robot.axis[i],
            "parameters": robot.parameters[i],
            "drive_gain": None if np.isnan(gain) else gain,
        }
        lines += [
            f"{'  - ' if k == 0 else '    '}{name}: {_value(value)}"
            for k, (name, value) in enumerate(entries.items())
        ]
    if width is not None:
        lines += [f"sign_width: {_value(width)}  # sign(x) of a joint is tanh(x / sign_width)"]
    effects = list(effects)
    lines += ["effects:" if effects else "effects: []"]
    for item in effects:
        where = {
            name: None if index is None else robot.joints[index]
            for name, index in (("joint", item.joint), ("other", item.other))
        }
        entries = {"effect": item.effect, "law": item.law.summary, **where, "values": item.values}
        lines += [
            f"{'  - ' if k == 0 else '    '}{name}: {_value(value)}"
            for k, (name, value) in enumerate(entries.items())
        ]
    return "\n".join(lines) + "\n"


def _value(x: Any) -> str:
    if isinstance(x, dict):
        return json.dumps({name: float(value) for name, value in x.items()})
    if x is None or isinstance(x, str | float):
        return json.dumps(x, ensure_ascii=False)
    return json.dumps(np.asarray(x, float).tolist())
