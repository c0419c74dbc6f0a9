"""Robots of the public: which are read, and whether their torques are Pinocchio's."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

# Torques of two programs that add the same numbers in another order.
_EQUAL = 1e-9


class Outcome(NamedTuple):
    """One file: what Pinocchio and what this program say, and how far their torques are apart."""

    file: str
    pinocchio: bool
    read: bool
    apart: float | None
    why: str


def installed() -> list[Path]:
    """URDF files of packages on the path of Python, such as example-robot-data."""
    found: list[Path] = []
    for place in map(Path, filter(None, sys.path)):
        if place.name in ("site-packages", "dist-packages") or (place / "cmeel.prefix").is_dir():
            found += below(place)
    return found


def below(place: Path) -> list[Path]:
    """URDF files in a folder, one of each content: packages hold copies of each other's robots."""
    files = sorted(path.resolve() for path in place.rglob("*.urdf"))
    return sorted({path.read_bytes(): path for path in reversed(files)}.values())


def compare(files: list[Path]) -> Iterator[Outcome]:
    """Read every file with both programs and compare torques at a random state."""
    import pinocchio as pin

    from jaxswarm.errors import InputError
    from jaxswarm.robot import RobotOptions, inverse_dynamics, load_robot
    from jaxswarm.robot.urdf import read_urdf

    for path in files:
        try:
            model = pin.buildModelFromUrdf(str(path))
        except Exception as error:  # whatever its parser raises
            model, why = None, str(error).splitlines()[0][:80]
        if model is not None and model.njoints < 2:
            continue  # a single body has no joint torque to compare
        try:
            robot = load_robot(str(path))
            if model is not None and set(robot.joints) != set(list(model.names)[1:]):
                # Joints that mimic others are held here; by some of Pinocchio's versions they move.
                moving = [j.name for j in read_urdf(path).joints if j.kind != "fixed"]
                robot = load_robot(str(path), RobotOptions(joints=tuple(moving)))
        except InputError as error:
            yield Outcome(path.name, model is not None, False, None, str(error)[-90:])
            continue
        if model is None:
            yield Outcome(path.name, False, True, None, why)
            continue
        if set(list(model.names)[1:]) != set(robot.joints):
            apart = set(list(model.names)[1:]) ^ set(robot.joints)
            yield Outcome(path.name, True, True, None, f"other joints: {sorted(apart)[:4]}")
            continue
        rng = np.random.default_rng(0)
        q, dq, ddq = rng.normal(size=(3, robot.num_joints))
        config, order = [], []
        for name, joint in zip(list(model.names)[1:], list(model.joints)[1:], strict=True):
            k = robot.joints.index(name)
            order.append(k)
            config += [np.cos(q[k]), np.sin(q[k])] if joint.nq == 2 else [q[k]]
        gravity = np.asarray(robot.gravity)
        model.gravity.linear = gravity
        tau = pin.rnea(model, model.createData(), np.array(config), dq[order], ddq[order])
        ours = np.asarray(inverse_dynamics(robot, q, dq, ddq))[order]
        apart = float(np.abs(ours - tau).max() / max(1.0, np.abs(tau).max()))
        yield Outcome(path.name, True, True, apart, "")


def table(files: list[Path]) -> str:
    """How many are read and equal, and a row for every file that is not."""
    rows = list(compare(files))
    able = [row for row in rows if row.pinocchio]
    equal = [row for row in able if row.apart is not None and row.apart < _EQUAL]
    share = 100.0 * len(equal) / max(len(able), 1)
    lines = [
        "| robots (URDF) | number |",
        "|---|---|",
        f"| files | {len(rows)} |",
        f"| read by Pinocchio | {len(able)} |",
        f"| of these read here, torques equal to {_EQUAL:g} | {len(equal)} ({share:.1f} %) |",
        f"| read here alone | {sum(row.read and not row.pinocchio for row in rows)} |",
    ]
    bad = [row for row in able if row not in equal]
    if bad:
        lines += ["", "| not equal | why |", "|---|---|"]
        lines += [f"| {row.file} | {row.why or f'apart by {row.apart:.2g}'} |" for row in bad]
    return "\n".join(lines)
