"""Frames of an SDF model: every name resolved to a pose in the frame of the model."""

from collections.abc import Callable
from xml.etree.ElementTree import Element

import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.robot.checks import shown
from jaxswarm.robot.sdf_values import Pose

_MODEL = "__model__"


class Frames:
    """Poses by the name of a link, joint or frame.

    Args:
        model: The element of the model.
        source: What messages call the file.
        pose_of: Reads the pose that an element holds; gets the place for messages too.
    """

    def __init__(
        self, model: Element, source: str, pose_of: Callable[[Element | None, str], Pose]
    ) -> None:
        self._source, self._pose_of = source, pose_of
        self._known: dict[str, Pose] = {_MODEL: (np.eye(3), np.zeros(3))}
        # Name -> its element and the frame its pose is relative to, where the file does not say.
        self._given: dict[str, tuple[Element, str]] = {}
        for element in model:
            name = element.get("name", "").strip()
            default = {
                "link": _MODEL,
                "joint": (element.findtext("child") or "").strip(),
                "frame": element.get("attached_to") or _MODEL,
            }.get(element.tag)
            if default is None or not name:
                continue
            if name in self._given:
                raise InputError(f"{source}: the name {shown(name)} occurs twice: rename one.")
            self._given[name] = element, default

    def of(self, name: str) -> Pose:
        """The pose of a frame in that of the model.

        Raises:
            InputError: If there is no such frame, or it is placed relative to itself.
        """
        chain: list[str] = []
        while name not in self._known:
            if name in chain:
                raise InputError(
                    f"{self._source}: the pose of {shown(name)} is relative to itself: correct relative_to."
                )
            if name not in self._given:
                raise InputError(
                    f"{self._source}: a pose is relative to {shown(name)}, which is not there. "
                    + nearest(name, self._given)
                )
            chain.append(name)
            name = self._relative_to(name)
        for inner in reversed(chain):
            outer = self._known[self._relative_to(inner)]
            rotation, translation = self._pose_of(
                self._given[inner][0].find("pose"), f"{self._source}: {shown(inner)}"
            )
            self._known[inner] = outer[0] @ rotation, outer[1] + outer[0] @ translation
        return self._known[chain[0] if chain else name]

    def _relative_to(self, name: str) -> str:
        element, default = self._given[name]
        pose = element.find("pose")
        return (None if pose is None else pose.get("relative_to")) or default
