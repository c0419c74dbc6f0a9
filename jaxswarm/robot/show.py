"""What was read of a robot, and a picture of its skeleton."""

from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.robot.joints import Limits
from jaxswarm.robot.load import describe_robot, load_robot
from jaxswarm.robot.model import Robot
from jaxswarm.robot.options import RobotChoice
from jaxswarm.robot.placements import rotation_about

_BONE, _AXIS, _MASS = "#5b6770", "#d1495b", "#2e6f95"
_DPI = 110
# Entries of an axis below this are rounding of the angles in the file.
_ROUNDING = 1e-6


def link_poses(robot: Robot, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return rotation (n, 3, 3) and origin (n, 3) of the links in the base frame, in numpy."""
    rotations: list[np.ndarray] = []
    origins: list[np.ndarray] = []
    for i, (kind, parent) in enumerate(zip(robot.kinds, robot.parents, strict=True)):
        above = rotations[parent] if parent >= 0 else np.eye(3)
        start = origins[parent] if parent >= 0 else np.zeros(3)
        axis, place = np.asarray(robot.axis[i]), above @ np.asarray(robot.rotation[i])
        origin = start + above @ np.asarray(robot.translation[i])
        if kind == "revolute":
            rotations.append(place @ rotation_about(axis, q[i]))
        else:
            rotations.append(place)
            origin = origin + place @ axis * q[i]
        origins.append(origin)
    return np.stack(rotations), np.stack(origins)


def summary(choice: RobotChoice) -> dict[str, Any]:
    """Return what was read of a robot, ready for JSON.

    Axes and origins are at q = 0 in base axes, masses those of the links with all that is fixed to them.

    Raises:
        InputError: If the robot cannot be read.
    """
    robot = load_robot(choice)
    limits = _limits(choice)
    rotation, origin = link_poses(robot, np.zeros(robot.num_joints))
    rows = []
    for i, joint in enumerate(robot.joints):
        axis = rotation[i] @ robot.axis[i]
        parent = robot.parents[i]
        rows.append(
            {
                "joint": joint,
                "kind": robot.kinds[i],
                "parent": "base" if parent < 0 else robot.joints[parent],
                "axis": np.where(np.abs(axis) < _ROUNDING, 0.0, axis).tolist(),
                "origin": origin[i].tolist(),
                **limits[joint]._asdict(),
                "mass": float(robot.parameters[i][0]),
            }
        )
    return {
        "robot": robot.name,
        "gravity": np.asarray(robot.gravity).tolist(),
        "mass": float(np.sum(robot.parameters[:, 0])),
        "joints": rows,
        "notes": list(robot.notes),
    }


def _limits(choice: RobotChoice) -> dict[str, Limits]:
    return {joint.name: joint.limits for joint in describe_robot(choice).joints}


def draw(choice: RobotChoice, path: Path) -> None:
    """Draw the skeleton at q = 0, or the nearest position within the limits, as PNG."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    robot, known = load_robot(choice), _limits(choice)
    bounds = np.array([known[joint][:2] for joint in robot.joints])
    q = np.fmin(np.fmax(0.0, bounds[:, 0]), bounds[:, 1])
    rotation, origin = link_poses(robot, q)
    figure = Figure(figsize=(8.0, 6.0), dpi=_DPI)
    FigureCanvasAgg(figure)
    axes: Any = figure.add_axes((0.0, 0.02, 0.72, 0.92), projection="3d")
    mass = np.asarray(robot.parameters)[:, 0]
    heavy = mass > 0.0
    center = origin.copy()
    first = np.asarray(robot.parameters)[heavy, 1:4] / mass[heavy, None]
    center[heavy] += np.einsum("nij,nj->ni", rotation[heavy], first)
    points = np.concatenate([np.zeros((1, 3)), origin, center])
    middle, half = (points.max(0) + points.min(0)) / 2, np.ptp(points, axis=0).max() / 2 or 1.0
    axes.computed_zorder = False
    _skeleton(axes, robot, rotation, origin, 0.28 * half)
    if heavy.any():
        sizes = 20.0 + 130.0 * mass[heavy] / mass.max()
        axes.scatter(*center[heavy].T, s=sizes, color=_MASS, alpha=0.5, linewidth=0)
    for side, low, high in zip("xyz", middle - half, middle + half, strict=True):
        getattr(axes, f"set_{side}lim")(low, high)
        getattr(axes, f"set_{side}label")(f"{side} [m]")
    axes.set_box_aspect((1, 1, 1))
    axes.view_init(elev=18, azim=-55)
    figure.suptitle(_plain(robot.name), x=0.03, ha="left", fontsize=12)
    _legend(figure, robot, q, bool(heavy.any()))
    figure.savefig(path, format="png")


def _skeleton(axes, robot: Robot, rotation: np.ndarray, origin: np.ndarray, length: float) -> None:
    """Draw the bones, and each joint's axis with its number at the tip."""
    axes.scatter(0, 0, 0, s=70, marker="s", color=_BONE)
    for i, parent in enumerate(robot.parents):
        start = origin[parent] if parent >= 0 else np.zeros(3)
        axes.plot(*np.stack([start, origin[i]]).T, color=_BONE, linewidth=3, solid_capstyle="round")
        axis = rotation[i] @ np.asarray(robot.axis[i]) * length
        marker = "o" if robot.kinds[i] == "revolute" else "D"
        axes.scatter(*origin[i], s=28, marker=marker, color=_BONE)
        axes.quiver(
            *origin[i], *axis, color=_AXIS, linewidth=1.6, arrow_length_ratio=0.25, zorder=5
        )
        # Joints that share an origin have their numbers at different distances.
        shared = sum(np.allclose(origin[i], origin[k], atol=0.2 * length) for k in range(i))
        tip = origin[i] + axis * (1.15 + 0.22 * shared)
        # On a patch of its own a number is read even where the axis runs along a bone.
        patch = {"facecolor": "white", "edgecolor": "none", "pad": 0.6, "alpha": 0.85}
        axes.text(*tip, str(i + 1), color=_AXIS, fontsize=9, bbox=patch, zorder=10)


def _legend(figure, robot: Robot, q: np.ndarray, heavy: bool, most: int = 30) -> None:
    """List the joints by number, and what the signs mean."""
    lines = [
        f"{i + 1}  {_plain(joint)}" + (f"  at {q[i]:.3g}" if q[i] else "")
        for i, joint in enumerate(robot.joints[:most])
    ]
    if robot.num_joints > most:
        lines.append(f"and {robot.num_joints - most} more")
    lines += ["", "red: axis of motion", "circle: revolute, diamond: prismatic", "square: base"]
    lines += ["blue: centers of mass"] * heavy
    figure.text(0.72, 0.9, "\n".join(lines), va="top", fontsize=8)


def _plain(text: str) -> str:
    """Return text in which nothing starts a formula, shortened for the margin."""
    text = text if len(text) <= 32 else f"{text[:29]}..."
    return text.replace("$", r"\$")
