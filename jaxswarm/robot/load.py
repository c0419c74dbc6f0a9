"""One door to every robot: a built-in name, a URDF file or a TOML file."""

from pathlib import Path

from jaxswarm.errors import InputError, nearest
from jaxswarm.robot.builtin import BUILTIN_ROBOTS
from jaxswarm.robot.model import Robot
from jaxswarm.robot.toml import load_toml
from jaxswarm.robot.urdf import load_urdf

_READERS = {".urdf": load_urdf, ".xml": load_urdf, ".toml": load_toml}


def load_robot(spec: str | Path) -> Robot:
    """Return the robot that a name or a path stands for.

    Args:
        spec: A name in ``BUILTIN_ROBOTS``, or a path that ends in ``.urdf``, ``.xml`` (URDF) or
            ``.toml``.

    Raises:
        InputError: If the name is unknown, the file is missing or does not describe a robot.

    >>> load_robot("ur10e").num_joints
    6
    """
    name = str(spec)
    if name in BUILTIN_ROBOTS:
        return BUILTIN_ROBOTS[name]()
    path = Path(name)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(
            f"unknown robot {name!r}: give a built-in name, a .urdf or a .toml file. "
            + nearest(name, BUILTIN_ROBOTS)
        )
    if not path.is_file():
        raise InputError(f"robot file {name!r} does not exist: correct the path.")
    return reader(path)
