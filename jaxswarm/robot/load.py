"""One door to every robot: a built-in name, or a file in URDF, MJCF, SDF or TOML, with options."""

import os
from pathlib import Path

from jaxswarm.errors import InputError, nearest
from jaxswarm.robot.build import build_description, description_of
from jaxswarm.robot.builtin import BUILTIN_ROBOTS
from jaxswarm.robot.joints import Description
from jaxswarm.robot.mjcf import describe_mjcf
from jaxswarm.robot.model import Robot
from jaxswarm.robot.options import RobotChoice, RobotOptions, apply_options
from jaxswarm.robot.sdf import describe_sdf
from jaxswarm.robot.toml import read_toml
from jaxswarm.robot.urdf import describe_urdf
from jaxswarm.robot.xmltree import parse_xml, read_bytes

# A hundred joints are a humanoid with hands; beyond, one sample's regressor has a million numbers.
MAX_JOINTS = 300


def load_robot(spec: str | Path | RobotChoice, options: RobotOptions | None = None) -> Robot:
    """Return the robot that a name or a path stands for.

    Args:
        spec: A name in ``BUILTIN_ROBOTS``, or a path that ends in ``.urdf``, ``.sdf``, ``.xml`` (any
            of both, or MJCF) or ``.toml``; or either together with options.
        options: Joints of interest, locked ones, a tool, gravity.

    Raises:
        InputError: If the name is unknown, the file is missing or does not describe a robot, or an
            option names what the robot has not.

    >>> load_robot("ur10e", RobotOptions(lock=(("joint6", 0.5),))).num_joints
    5
    """
    name = os.fspath(spec)
    try:
        robot = build_description(describe_robot(spec, options))
    except InputError as error:
        raise InputError(str(error) if name in str(error) else f"{name}: {error}") from error
    if robot.num_joints > MAX_JOINTS:
        raise InputError(
            f"{name}: has {robot.num_joints} moving joints, at most {MAX_JOINTS} can be computed: "
            "choose those of interest with --joints."
        )
    return robot


def describe_robot(
    spec: str | Path | RobotChoice, options: RobotOptions | None = None
) -> Description:
    """Return the joints that a name or a path stands for, options applied; see :func:`load_robot`."""
    if isinstance(spec, RobotChoice):
        options = spec.options
    return apply_options(_read(str(spec)), options or RobotOptions())


def _read(name: str) -> Description:
    if name in BUILTIN_ROBOTS:
        return description_of(BUILTIN_ROBOTS[name]())
    path = Path(name)
    if path.suffix.lower() not in (".urdf", ".xml", ".xacro", ".mjcf", ".sdf", ".toml"):
        raise InputError(
            f"unknown robot {name!r}: give a built-in name, a .urdf, .sdf, .xml (MJCF) or .toml file. "
            + nearest(name, BUILTIN_ROBOTS)
        )
    try:
        found = path.is_file()
    except (OSError, ValueError):  # a name too long, or with a null character
        found = False
    if not found:
        raise InputError(f"robot file {name!r} does not exist: correct the path.")
    if path.suffix.lower() == ".toml":
        return read_toml(path)
    data = read_bytes(path)
    kind = parse_xml(data, name, "URDF, MJCF or SDF").tag
    if kind == "mujoco":
        return describe_mjcf(path)
    if kind == "sdf":
        return describe_sdf(data, name)
    return describe_urdf(data, name)
