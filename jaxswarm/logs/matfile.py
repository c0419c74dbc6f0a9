"""The bytes of a MAT file, version 5 to 7.2: numbers, characters, cells of names and structures.

A file is a header of 128 bytes and a row of elements, each a tag (type, length) and its data padded to
eight bytes; a matrix is an element whose data are again elements: flags, sizes, name, values. Every
length is checked against what is there, so that a damaged file ends in an error. (The usual readers
are compiled, and some damage ends the whole process.)

Reference: MAT-File Format, MathWorks, chapter 1 (level 5).
"""

import struct
import zlib
from collections.abc import Callable, Container, Iterator
from dataclasses import dataclass
from math import prod

import numpy as np

_STORED = {
    1: "i1",
    2: "u1",
    3: "i2",
    4: "u2",
    5: "i4",
    6: "u4",
    7: "f4",
    9: "f8",
    12: "i8",
    13: "u8",
}
_ENCODINGS = {1: "utf-8", 2: "utf-8", 4: "utf-16", 16: "utf-8", 17: "utf-16", 18: "utf-32"}
_MATRIX, _COMPRESSED = 14, 15
_CELL, _STRUCTURE, _CHAR, _OPAQUE = 1, 2, 4, 17
_CLASSES = {
    2: "an array of structures",
    3: "an object",
    5: "a sparse matrix",
    16: "a function",
    17: "an object",
}
_NUMBERS = range(6, 16)
_COMPLEX = 0x0800
# Structures within each other that are followed; what is damaged may have any number.
_DEPTH = 20
# Bytes that hold the tag, flags, sizes and name of any variable.
_HEAD = 4096

Choose = Callable[[dict[str, tuple[int, ...]], dict[str, int]], Container[str]]


@dataclass(frozen=True)
class Other:
    """A variable that holds neither numbers nor names; ``kind`` says what it is."""

    kind: str


@dataclass(frozen=True)
class Structure:
    """A single structure: name of a field to its value."""

    fields: dict[str, "np.ndarray | Other | Structure"]


Value = np.ndarray | Other | Structure


def parse_mat(content: bytes, choose: Choose | None = None) -> dict[str, Value]:
    """Parse the variables of a MAT file.

    Args:
        content: The whole file.
        choose: Given the declared sizes of all variables by name, and their lengths in bytes, returns the
            names to read; nothing of the others is unpacked. None: all are read.

    Returns:
        Name to array: numbers as stored, of the sizes MATLAB shows; characters as one string per row. A single
        structure is one, with fields of the same kinds.

    Raises:
        ValueError: If a length or a type does not fit; also ``zlib.error`` and ``struct.error``.
    """
    order = {b"IM": "<", b"MI": ">"}.get(content[126:128])
    if order is None:
        raise ValueError("no MAT file of version 5 to 7.2")
    found: list[tuple[str, tuple[int, ...], int, int, bytes]] = []
    for kind, data in _elements(content[128:], order):
        head = zlib.decompressobj().decompress(data, _HEAD) if kind == _COMPRESSED else None
        length = len(data)
        if head is not None:
            if len(head) < 8:
                raise ValueError("a compressed variable is empty")
            inner, length = struct.unpack_from(f"{order}II", head)
        else:
            inner, head = kind, bytes(8) + data[:_HEAD]
        if inner != _MATRIX:
            raise ValueError(f"element of type {inner} where a variable is expected")
        name, shape = _heading(head[8:], order)
        if any(name == other for other, *_ in found):
            raise ValueError(f"variable {name} appears twice")
        found.append((name, shape, length, kind, data))
    shapes = {name: shape for name, shape, *_ in found}
    lengths = {name: length for name, _, length, *_ in found}
    wanted = choose(shapes, lengths) if choose else shapes
    variables = {}
    for name, _, length, kind, data in found:
        if name in wanted:
            if kind == _COMPRESSED:
                data = _unpack(data, length, order)
            variables[name] = _matrix(data, order)[1]
    return variables


def _unpack(data: bytes, length: int, order: str) -> bytes:
    """The data of a compressed variable, which has to be as long as it says."""
    tool = zlib.decompressobj()
    # The tag, the data, and one byte more to see whether there is more than declared.
    whole = tool.decompress(data, 8 + length + 1)
    ((_, unpacked),) = _elements(whole, order)
    return unpacked


def _heading(head: bytes, order: str) -> tuple[str, tuple[int, ...]]:
    """Name and sizes of a variable, from the begin of its data; empty ones where it has none."""
    if not head:
        return "", ()
    parts = _elements(head, order)
    flags = int(_numbers(*next(parts), order)[0])
    if flags & 0xFF == _OPAQUE:
        return next(parts)[1].decode("ascii"), ()
    shape = tuple(int(size) for size in _numbers(*next(parts), order))
    return next(parts)[1].decode("ascii"), shape


def _elements(data: bytes, order: str) -> Iterator[tuple[int, bytes]]:
    """Types and data of the elements in a stretch of bytes."""
    at = 0
    while at < len(data):
        kind, length = struct.unpack_from(f"{order}II", data, at)
        start, following = at + 8, at + 8 + length + (-length % 8 if kind != _COMPRESSED else 0)
        if kind >> 16:
            # Up to four bytes of data stand in the tag itself.
            kind, length, start, following = kind & 0xFFFF, kind >> 16, at + 4, at + 8
            if length > 4:
                raise ValueError(f"short element of {length} bytes")
        if start + length > len(data):
            raise ValueError("the file ends inside a variable")
        yield kind, data[start : start + length]
        at = following


def _matrix(data: bytes, order: str, depth: int = 0) -> tuple[str, Value]:
    """Name and value of one variable."""
    parts = list(_elements(data, order))
    if not parts:
        return "", np.zeros((0, 0))
    flags = int(_numbers(*parts[0], order)[0])
    kind = flags & 0xFF
    if kind == _OPAQUE:
        return parts[1][1].decode("ascii"), Other(_CLASSES[kind])
    shape = tuple(int(size) for size in _numbers(*parts[1], order))
    name = parts[2][1].decode("ascii")
    if len(shape) < 2 or min(shape) < 0:
        raise ValueError(f"variable {name} has sizes {shape}")
    if depth > _DEPTH:
        raise ValueError(f"variable {name} lies in over {_DEPTH} others")
    if kind == _STRUCTURE and prod(shape) == 1:
        return name, _structure(parts[3:], order, depth)
    if kind == _CELL:
        cells = [_matrix(part, order, depth + 1)[1] for _, part in parts[3:]]
        if len(cells) != prod(shape):
            raise ValueError(f"variable {name} has {len(cells)} cells for sizes {shape}")
        texts = [cell for cell in cells if isinstance(cell, np.ndarray) and cell.dtype.kind == "U"]
        if len(texts) < len(cells) or any(text.size != 1 for text in texts):
            return name, Other("a cell array of other things than names")
        return name, np.array([text.item() for text in texts], dtype=str)
    if kind == _CHAR:
        return name, _rows(_text(*parts[3], order), shape)
    if kind not in _NUMBERS:
        return name, Other(_CLASSES.get(kind, f"an unknown class {kind}"))
    if flags & _COMPLEX:
        return name, Other("complex numbers")
    values = _numbers(*parts[3], order)
    if values.size != prod(shape):
        raise ValueError(f"variable {name} has {values.size} values for sizes {shape}")
    return name, values.reshape(shape, order="F")


def _structure(parts: list[tuple[int, bytes]], order: str, depth: int) -> Structure:
    """The fields of a structure: the length of their names, the names, then one matrix each."""
    length = int(_numbers(*parts[0], order)[0])
    text = parts[1][1]
    if length < 1 or len(text) % length or len(text) // length != len(parts) - 2:
        raise ValueError(
            f"a structure has {len(parts) - 2} fields and {len(text)} letters of names"
        )
    names = [
        text[k : k + length].split(b"\0")[0].decode("ascii") for k in range(0, len(text), length)
    ]
    values = [_matrix(data, order, depth + 1)[1] for _, data in parts[2:]]
    return Structure(dict(zip(names, values, strict=True)))


def _numbers(kind: int, data: bytes, order: str) -> np.ndarray:
    if kind not in _STORED:
        raise ValueError(f"element of type {kind} where numbers are expected")
    return np.frombuffer(data, dtype=np.dtype(order + _STORED[kind]))


def _text(kind: int, data: bytes, order: str) -> str:
    if kind not in _ENCODINGS:
        raise ValueError(f"element of type {kind} where characters are expected")
    suffix = {"<": "-le", ">": "-be"}[order] if _ENCODINGS[kind] != "utf-8" else ""
    return data.decode(_ENCODINGS[kind] + suffix)


def _rows(text: str, shape: tuple[int, ...]) -> np.ndarray:
    """The rows of a character matrix, which is stored column by column, without padding blanks."""
    if len(shape) != 2 or len(text) != prod(shape):
        raise ValueError(f"{len(text)} characters for sizes {shape}")
    return np.array([text[k :: shape[0]].rstrip() for k in range(shape[0])], dtype=str)
