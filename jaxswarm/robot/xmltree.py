"""XML as a tree of elements, read without entities and without a care for namespaces.

Robot files carry tags and prefixes of every tool that edited them, declared or not; a namespace-aware
reader refuses the file for them. Entities can blow a small file up or pull in other files, and no robot
needs them: a document type declaration is refused.
"""

from pathlib import Path
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot.checks import LARGEST, shown

# A description of a thousand joints has a megabyte; a hundred of them is something else.
MAX_BYTES = 100_000_000
# Parts inside parts: files of robots have ten levels, and trees far deeper exhaust the stack.
MAX_DEPTH = 1_000


def read_bytes(path: str | Path) -> bytes:
    """Return the bytes of a robot file.

    Raises:
        InputError: If it cannot be read or is too large to be a robot.
    """
    try:
        size = Path(path).stat().st_size
        if size > MAX_BYTES:
            raise InputError(
                f"{path}: has {size / 1e6:.0f} MB: a robot file has at most {MAX_BYTES / 1e6:.0f}."
            )
        return Path(path).read_bytes()
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{path}: cannot be read ({error}): check path and rights.") from error


def parse_xml(text: str | bytes, source: str, kind: str = "URDF") -> Element:
    """Return the root element of a document.

    Args:
        text: The document; bytes may declare their encoding, text is taken as it is.
        source: What messages call it.
        kind: What it should be, for messages.

    Raises:
        InputError: If it does not parse or declares a document type.
    """
    data, encoding = (text, None) if isinstance(text, bytes) else (text.encode(), "utf-8")
    parser, builder, depth = expat.ParserCreate(encoding), TreeBuilder(), 0

    def start(tag, attributes):
        nonlocal depth
        depth += 1
        if depth > MAX_DEPTH:
            raise InputError(
                f"{source}: has over {MAX_DEPTH} elements inside each other: no robot."
            )
        builder.start(tag, attributes)

    def end(tag):
        nonlocal depth
        depth -= 1
        builder.end(tag)

    def doctype(*_):
        raise InputError(
            f"{source}: declares a document type, which may hold entities: delete the DOCTYPE line."
        )

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler = builder.data
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(data.lstrip(), True)  # empty lines before the declaration are common
        return builder.close()
    except (expat.ExpatError, LookupError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{source}: not a readable {kind} ({error}): correct the file.") from error


def attribute(element: Element, name: str, place: str) -> str:
    """Return an attribute that has to be there.

    Raises:
        InputError: If it is missing or empty.
    """
    value = element.get(name, "").strip()
    if not value:
        raise InputError(f"{place}: <{element.tag}> has no {name}: give one.")
    return value


def numbers(
    element: Element | None, name: str, count: int, default: tuple[float, ...] | None, place: str
) -> np.ndarray:
    """Return an attribute of ``count`` numbers, shape (count,).

    Args:
        element: The element, ``None`` where it is not there.
        name: The attribute.
        count: How many numbers it has to hold.
        default: What a missing attribute stands for; ``None``: it has to be there.
        place: Where it stands, for messages.

    Raises:
        InputError: If it is missing or holds anything but ``count`` finite numbers.
    """
    text = None if element is None else element.get(name)
    if text is None and default is not None:
        return np.array(default, dtype=float)
    try:
        if text is None or "_" in text:  # Python reads 1_0 as ten
            raise ValueError
        values = np.array([float(word) for word in text.split()])
    except ValueError:
        values = np.array([])
    if values.shape != (count,) or not (np.abs(values) <= LARGEST).all():
        tag = "" if element is None else f"{element.tag} "
        given = "is missing" if text is None else f"= {shown(text)}"
        many = "one finite number" if count == 1 else f"{count} finite numbers"
        raise InputError(f"{place}: {tag}{name} {given}: {many} up to {LARGEST:g} needed.")
    return values
