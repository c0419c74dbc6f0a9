"""What is asked of a robot beyond its file: joints of interest, locked ones, a tool, gravity.

A locked joint becomes a fixed one at its position, and its link is lumped into the link that carries it.
A joint that mimics another one is locked too, unless it is named among the joints of interest: two joints
that share a coordinate are no tree. Where its master is locked it takes the position that belongs to it.
"""

import dataclasses
from collections.abc import Mapping

import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.robot.checks import LARGEST, unit_axis
from jaxswarm.robot.joints import Description, Joint
from jaxswarm.robot.model import KINDS
from jaxswarm.robot.placements import body_parameters, inertia_matrix, rotation_about

TOOL = "(tool)"


@dataclasses.dataclass(frozen=True)
class RobotOptions:
    """Changes to a robot as its file describes it.

    Attributes:
        joints: Joints of interest; every other one is locked. Empty: all.
        lock: (joint, position in rad or m) pairs.
        tool: Mass in kg, center of mass in m in the frame of the last link, then optionally
            Ixx, Ixy, Iyy, Ixz, Iyz, Izz in kg m^2 about it: 4 or 10 numbers. Empty: none.
        gravity: Acceleration of free fall in base axes in m/s^2, 3 numbers. Empty: the file's.
    """

    joints: tuple[str, ...] = ()
    lock: tuple[tuple[str, float], ...] = ()
    tool: tuple[float, ...] = ()
    gravity: tuple[float, ...] = ()


@dataclasses.dataclass(frozen=True)
class RobotChoice:
    """A robot's name or path together with options; stands wherever the name alone can."""

    spec: str
    options: RobotOptions = RobotOptions()

    def __str__(self) -> str:
        return self.spec

    def __fspath__(self) -> str:
        return self.spec


def parse_options(
    joints: str | None = None,
    lock: str | None = None,
    tool: str | None = None,
    gravity: str | None = None,
) -> RobotOptions:
    """Return the options that texts of the command line stand for.

    >>> parse_options(lock="finger=0.04,wrist").lock
    (('finger', 0.04), ('wrist', 0.0))
    """
    locked = []
    for entry in _names("--lock", lock):
        name, _, value = entry.partition("=")
        locked.append((name.strip(), _numbers(f"--lock {entry}", value or "0", (1,))[0]))
    return RobotOptions(
        joints=_names("--joints", joints),
        lock=tuple(locked),
        tool=_numbers("--tool", tool, (4, 10)),
        gravity=_numbers("--gravity", gravity, (3,)),
    )


def _names(option: str, text: str | None) -> tuple[str, ...]:
    names = () if text is None else tuple(name.strip() for name in text.split(","))
    if not all(names) or len(set(names)) < len(names):
        raise InputError(f"{option} {text!r}: give joint names, each once, parted by commas.")
    return names


def _numbers(option: str, text: str | None, lengths: tuple[int, ...]) -> tuple[float, ...]:
    if text is None:
        return ()
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) not in lengths or not all(abs(v) <= LARGEST for v in values):
        size = " or ".join(map(str, lengths))
        raise InputError(f"{option}: {text!r} is not {size} finite numbers parted by commas.")
    return values


def apply_options(description: Description, options: RobotOptions) -> Description:
    """Return the description with joints locked, a tool added and gravity turned.

    Raises:
        InputError: If a joint is unknown or does not move, or the tool's place is not clear.
    """
    places, notes = _locked(description, options)
    joints = tuple(
        _held(joint, places[joint.name]) if joint.name in places else joint
        for joint in description.joints
    )
    if options.tool:
        tool = _tool(description.name, joints, options.tool)
        joints = (*joints, tool)
        notes.append(f"tool of {options.tool[0]:g} kg on the link of joint {tool.parent!r}")
    return dataclasses.replace(
        description,
        joints=joints,
        gravity=options.gravity or description.gravity,
        notes=(*description.notes, *notes),
    )


def _locked(description: Description, options: RobotOptions) -> tuple[dict[str, float], list[str]]:
    """Return joint -> position of the joints that are locked, and what to tell about them."""
    moving = {joint.name: joint for joint in description.joints if joint.kind != "fixed"}
    wanted = dict(options.lock)
    for option, names in (("--joints", options.joints), ("--lock", wanted)):
        for name in names:
            if name not in moving:
                raise InputError(
                    f"robot {description.name!r} has no moving joint {name!r} ({option}). "
                    + nearest(name, moving)
                )
    both = [name for name in options.joints if name in wanted]
    if both:
        raise InputError(f"joint {both[0]!r} is named by --joints and by --lock: drop it from one.")
    places = dict(wanted)
    if options.joints:
        places |= {n: wanted.get(n, 0.0) for n in moving if n not in options.joints}
    mimics = {
        name: joint.mimic
        for name, joint in moving.items()
        if joint.mimic is not None and name not in options.joints and name not in wanted
    }
    notes = _locked_notes({name: q for name, q in places.items() if name not in mimics})
    for name, mimic in mimics.items():
        places[name] = _follow(description.name, name, places, mimics)
        where = f"joint {name!r} follows {mimic.joint!r} and is locked at {places[name]:g}"
        if mimic.joint not in moving:
            where += f": {mimic.joint!r} is no moving joint"
        elif mimic.joint not in places:
            where += f", its place where {mimic.joint!r} is at 0: its motion is not modeled"
        notes.append(where)
    notes += [
        f"joint {name!r} is locked at {q:g}, outside its limits "
        f"[{moving[name].limits.lower:g}, {moving[name].limits.upper:g}]"
        for name, q in places.items()
        if q < moving[name].limits.lower or q > moving[name].limits.upper
    ]
    return places, notes


def _locked_notes(places: Mapping[str, float], most: int = 10) -> list[str]:
    """Return one note for the joints locked at 0, and one for each that is locked elsewhere."""
    zero = [name for name, q in places.items() if q == 0.0]
    more = f" and {len(zero) - most} more" if len(zero) > most else ""
    notes = [f"locked at 0: {', '.join(zero[:most])}{more}"] if zero else []
    return notes + [f"joint {name!r} is locked at {q:g}" for name, q in places.items() if q]


def _follow(robot: str, name: str, places: Mapping, mimics: Mapping) -> float:
    """Return the position of a mimicking joint where the joint at the end of its chain is."""
    slope, shift, seen, at = 1.0, 0.0, {name}, name
    while at in mimics:
        mimic = mimics[at]
        slope, shift, at = slope * mimic.multiplier, shift + slope * mimic.offset, mimic.joint
        if at in seen:
            raise InputError(f"robot {robot!r}: joint {name!r} mimics itself: correct the mimic.")
        seen.add(at)
    return slope * places.get(at, 0.0) + shift


def _held(joint: Joint, position: float) -> Joint:
    """Return the joint fixed at a position."""
    rotation = np.asarray(joint.rotation, dtype=float)
    translation = np.asarray(joint.translation, dtype=float)
    if joint.kind in KINDS:
        axis = unit_axis(f"joint {joint.name!r}", joint.axis)
        if joint.kind == "revolute":
            rotation = rotation @ rotation_about(axis, position)
        else:
            translation = translation + rotation @ axis * position
    elif position != 0.0:
        raise InputError(
            f"joint {joint.name!r} is {joint.kind}: it can be locked where the file places it only, "
            f"not at {position:g}: --lock {joint.name}"
        )
    return dataclasses.replace(joint, kind="fixed", rotation=rotation, translation=translation)


def _tool(robot: str, joints: tuple[Joint, ...], numbers: tuple[float, ...]) -> Joint:
    """Return a fixed joint with the tool on the last moving joint."""
    above = {joint.name: joint for joint in joints}
    moves: list[str] = []
    inner: set[str] = set()
    for joint in joints:
        if joint.kind == "fixed":
            continue
        moves.append(joint.name)
        parent, seen = joint.parent, {joint.name}
        while parent in above and parent not in seen:
            seen.add(parent)
            if above[parent].kind != "fixed":
                inner.add(parent)
                break
            parent = above[parent].parent
    tips = [name for name in moves if name not in inner]
    if len(tips) != 1:
        raise InputError(
            f"robot {robot!r} has {len(tips)} last links ({', '.join(tips[:5])}): say with --joints "
            "which chain carries the tool."
        )
    inertia = np.zeros((3, 3)) if len(numbers) == 4 else inertia_matrix(np.array(numbers))
    return Joint(
        TOOL,
        "fixed",
        tips[0],
        parameters=body_parameters(numbers[0], np.array(numbers[1:4]), inertia),
    )
