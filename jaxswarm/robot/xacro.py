"""Templates of URDF: refused, with the very command that expands them.

Expanding one takes the macro language of ROS, with packages that are found on the machine that holds them;
what a robot is stands in the expanded file. The format is described at http://wiki.ros.org/xacro.
"""

import re
import shlex
from pathlib import Path
from xml.etree.ElementTree import Element

from jaxswarm.errors import InputError

_PREFIX = "xacro:"
_PACKAGE = re.compile(r"\$\(find\s+([^)\s]+)\s*\)")
_ENDINGS = (".xacro", ".urdf", ".xml")


def refuse_xacro(root: Element, source: str) -> None:
    """Refuse a template.

    Args:
        root: Root of the XML.
        source: Path of the file.

    Raises:
        InputError: With the command and the packages it needs.
    """
    found = next((e for e in root.iter() if _is_template(e)), None)
    if found is None:
        return
    packages = {p for e in root.iter() for v in e.attrib.values() for p in _PACKAGE.findall(v)}
    needed = f"; it takes files of {', '.join(sorted(packages))}" if packages else ""
    raise InputError(
        f"{source}: is a xacro template (<{found.tag}>): expand it first: "
        f"xacro {shlex.quote(source)} > {shlex.quote(_expanded(source))} "
        f"(package xacro of ROS, or pip install xacro{needed})."
    )


def _is_template(element: Element) -> bool:
    values = element.attrib.values()
    return element.tag.startswith(_PREFIX) or any("${" in v or "$(" in v for v in values)


def _expanded(source: str) -> str:
    """Name for the expanded file, in the working folder.

    >>> _expanded("robots/arm.urdf.xacro"), _expanded("arm.urdf")
    ('arm.urdf', 'arm_expanded.urdf')
    """
    path = Path(source)
    bare = path
    while bare.suffix.lower() in _ENDINGS:
        bare = bare.with_suffix("")
    return f"{bare.name}.urdf" if path.suffix.lower() == ".xacro" else f"{bare.name}_expanded.urdf"
