"""Robots from SDF, the format of Gazebo and Drake: poses of frames, joints and inertias of one model.

Every pose X_F of a frame F in the model's frame M follows from the frames it is given relative to,

    X_F = X_R X_RF,

with R by default the model for links, the child link for joints. A joint's frame is where the joint stands at
q = 0; a link's inertia is moved from its own frame to that of the joint that carries it. Joints to the world,
or the one link that hangs on nothing, make the base. Reference: sdformat.org/spec and, for relative poses,
sdformat.org/tutorials?tut=pose_frame_semantics.
"""

from xml.etree.ElementTree import Element

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot.checks import shown
from jaxswarm.robot.joints import DOWN, Description, Joint, Limits, Mimic
from jaxswarm.robot.placements import move_parameters
from jaxswarm.robot.sdf_frames import Frames
from jaxswarm.robot.sdf_values import Pose, link_parameters, numbers_in, pose_in
from jaxswarm.robot.xmltree import attribute, parse_xml

_KINDS = {
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "fixed": "fixed",
}
_WORLD = "world"
# What acts on a joint beside its links, and what MJCF calls it.
_BESIDE = {"damping": "damping", "friction": "frictionloss", "spring_stiffness": "stiffness"}
# Until here an axis is given in the frame of the model, later in that of the joint.
_AXIS_IN_MODEL = 1.4
# SDF writes no limit as a number.
_NO_LIMIT = 1e15


def describe_sdf(text: str | bytes, source: str) -> Description:
    """Return what the text of an SDF file says.

    Args:
        text: The XML, with one model.
        source: What messages call it.

    Raises:
        InputError: If it does not parse, has not one model, is no tree, or needs other files.
    """
    root = parse_xml(text, source, "SDF")
    if root.tag != "sdf":
        raise InputError(f"{source}: its root is <{root.tag}>: an SDF file starts with <sdf>.")
    model, gravity = _model(root, source)
    notes: list[str] = []
    for tag in ("include", "model"):
        if (inner := model.find(tag)) is not None:
            name = inner.get("name") or inner.findtext("uri") or inner.findtext("name") or ""
            raise InputError(
                f"{source}: holds another model {shown(name.strip())}: write the whole as one, with "
                "'gz sdf -p FILE' (Gazebo), or export it as URDF."
            )
    frames = Frames(model, source, pose_in)
    links = {attribute(e, "name", f"{source}: a link"): e for e in model.findall("link")}
    elements = [e for e in model.findall("joint")]
    ends = [_ends(e, links, source) for e in elements]
    above = _above(ends, links, source)
    _tell_base(links, above, ends, notes, source)
    by_name = {name: frames.of(name) for name, _, _ in ends}
    base = pose_in(model.find("pose"), f"{source}: model")
    joints = tuple(
        _joint(root, element, end, above, links, frames, by_name, base, notes, source)
        for element, end in zip(elements, ends, strict=True)
    )
    unread = sorted(
        {e.tag for e in model} - {"link", "joint", "pose", "frame", "static", "self_collide"}
    )
    if unread:
        notes.append(f"not read: {', '.join(f'<{tag}>' for tag in unread)}")
    return Description(model.get("name") or "robot", joints, gravity, notes=tuple(notes))


def _model(root: Element, source: str) -> tuple[Element, tuple[float, float, float]]:
    """The only model of a file, and the acceleration of free fall of its world."""
    world = root.find(_WORLD)
    models = root.findall("model") + ([] if world is None else world.findall("model"))
    moving = [m for m in models if any(j.get("type") != "fixed" for j in m.findall("joint"))]
    if len(moving) != 1:
        names = ", ".join(shown(m.get("name", "")) for m in moving) or "none"
        raise InputError(f"{source}: one model with moving joints is needed, found {names}.")
    text = None if world is None else world.find("gravity")
    gravity = DOWN if text is None else tuple(numbers_in(text, 3, f"{source}: gravity").tolist())
    return moving[0], gravity  # type: ignore[return-value]  # three numbers, which no type says


def _ends(element: Element, links: dict[str, Element], source: str) -> tuple[str, str, str]:
    """A joint's name, its parent link and its child link."""
    name = attribute(element, "name", f"{source}: a joint")
    ends = []
    for tag in ("parent", "child"):
        link = (element.findtext(tag) or "").strip()
        if link not in links and not (tag == "parent" and link == _WORLD):
            raise InputError(
                f"{source}: joint {shown(name)} names link {shown(link)} as its {tag}, which is not there: "
                "correct the name."
            )
        ends.append(link)
    return name, ends[0], ends[1]


def _above(ends, links: dict[str, Element], source: str) -> dict[str, str]:
    """Link -> the joint that carries it."""
    above: dict[str, str] = {}
    for name, _, child in ends:
        if child in above:
            raise InputError(
                f"{source}: link {shown(child)} hangs on two joints, {shown(above[child])} and "
                f"{shown(name)}: a tree is needed."
            )
        above[child] = name
    return above


def _tell_base(links, above, ends, notes: list[str], source: str) -> None:
    free = [link for link in links if link not in above]
    to_world = [name for name, parent, _ in ends if parent == _WORLD]
    if len(free) > 1 or (free and to_world and any(p in free for _, p, _ in ends)):
        raise InputError(
            f"{source}: the links {', '.join(map(shown, free[:5]))} hang on no joint: one of them can be "
            "the base, join or delete the others."
        )
    if free and not to_world:
        notes.append(
            f"link {free[0]!r} is taken as the base: the file does not join it to the world"
        )


def _joint(root, element, end, above, links, frames, poses, base, notes, source) -> Joint:
    name, parent, child = end
    place = f"{source}: joint {shown(name)}"
    kind = attribute(element, "type", place)
    carrier = above.get(parent)
    rotation, translation = poses[name]
    seen = poses[carrier] if carrier else _inverse(base)
    axis, limits, mimic = _axis(root, element, kind, frames, rotation, place, notes)
    inertia = link_parameters(links[child], notes, f"{source}: link {shown(child)}")
    link = _between(poses[name], frames.of(child))
    rotation, translation = _between(seen, (rotation, translation))
    return Joint(
        name=name,
        kind=_KINDS.get(kind, kind),
        parent=carrier,
        rotation=rotation,
        translation=translation,
        axis=axis,
        parameters=move_parameters(inertia, *link),
        limits=limits,
        mimic=mimic,
    )


def _axis(root, element, kind, frames, rotation, place, notes):
    """Axis in the joint's frame, limits, and the coupling to another joint."""
    found = element.find("axis")
    if kind not in ("revolute", "continuous", "prismatic") or found is None:
        return np.array([0.0, 0.0, 1.0]), Limits(), None
    text = found.find("xyz")
    axis = np.array([0.0, 0.0, 1.0]) if text is None else numbers_in(text, 3, f"{place}: xyz")
    version = root.get("version", "1.7")
    old = (
        version.count(".") == 1
        and version.replace(".", "").isdigit()
        and float(version) <= _AXIS_IN_MODEL
    )
    use_model = (found.findtext("use_parent_model_frame") or "").strip() in ("1", "true")
    given_in = None if text is None else text.get("expressed_in")
    if given_in:
        axis = rotation.T @ frames.of(given_in)[0] @ axis
    elif use_model or old:
        axis = rotation.T @ axis
    limit, values = found.find("limit"), {}
    for key in Limits._fields if limit is not None else ():
        entry = limit.find(key)
        if entry is not None:
            number = float(numbers_in(entry, 1, f"{place}: {key}", most=np.inf)[0])
            # SDF writes "no limit" as a large number, or -1 for velocity and effort.
            none = abs(number) >= _NO_LIMIT or (key in ("velocity", "effort") and number < 0.0)
            values[key] = np.nan if none else number
    dynamics = found.find("dynamics")
    for tag, what in _BESIDE.items() if dynamics is not None else ():
        entry = dynamics.find(tag)
        value = 0.0 if entry is None else numbers_in(entry, 1, f"{place}: {tag}")[0]
        if value != 0.0:
            joint = element.get("name", "").strip()
            notes.append(f"{what} is not part of the links ({joint} {value:.4g})")
    mimic = found.find("mimic")
    if mimic is not None:
        numbers = [
            float(numbers_in(e, 1, f"{place}: {key}")[0])
            if (e := mimic.find(key)) is not None
            else default
            for key, default in (("multiplier", 1.0), ("offset", 0.0), ("reference", 0.0))
        ]
        joint = attribute(mimic, "joint", place)
        mimic = Mimic(joint, numbers[0], numbers[1] - numbers[0] * numbers[2])
    return axis, Limits(**values), mimic


def _between(one: Pose, other: Pose) -> Pose:
    """The pose of the other frame in the first one."""
    return one[0].T @ other[0], one[0].T @ (other[1] - one[1])


def _inverse(pose: Pose) -> Pose:
    return pose[0].T, -pose[0].T @ pose[1]
