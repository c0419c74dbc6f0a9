"""How much an MCAP recording unpacks to, from the headers of its chunks, before anything is unpacked.

A file is records of a kind (1 byte), a length (8 bytes) and content; a chunk's content begins with two times,
its size unpacked, a checksum and the name of its compression. Reference: the MCAP format specification,
mcap.dev/spec, sections Records and Chunk.
"""

import os
import struct
from pathlib import Path

_MAGIC = b"\x89MCAP0\r\n"
_CHUNK = 6
# Two times, the size unpacked, a checksum, the length of the compression's name.
_CHUNK_HEAD = struct.Struct("<QQQII")
_RECORD_HEAD = struct.Struct("<BQ")
# The start of a Zstandard frame, and by the upper bits of its descriptor the bytes of its content's size
# (RFC 8878, 3.1.1.1).
_ZSTD, _ZSTD_SIZES = b"\x28\xb5\x2f\xfd", (0, 2, 4, 8)


def unpacked_size(path: Path) -> int:
    """Bytes that all chunks of a recording unpack to, as their headers say.

    Args:
        path: An ``.mcap`` file; of anything else, and of what is damaged, only the part that can be
            followed counts: the reader refuses it.
    """
    total, size = 0, os.path.getsize(path)
    with open(path, "rb") as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            return 0
        while len(head := file.read(_RECORD_HEAD.size)) == _RECORD_HEAD.size:
            kind, length = _RECORD_HEAD.unpack(head)
            start = file.tell()
            if kind == _CHUNK:
                total += _chunk_size(file.read(min(length, 256)))
            if start + length > size:
                break
            file.seek(start + length)
    return total


def _chunk_size(head: bytes) -> int:
    """The larger of what a chunk and the frame within say of their size."""
    if len(head) < _CHUNK_HEAD.size:
        return 0
    _, _, declared, _, name = _CHUNK_HEAD.unpack_from(head)
    frame = head[_CHUNK_HEAD.size + name + 8 :]
    return max(declared, _frame_size(frame))


def _frame_size(frame: bytes) -> int:
    if not frame.startswith(_ZSTD) or len(frame) < 6:
        return 0
    descriptor = frame[4]
    single = bool(descriptor & 0x20)
    count = _ZSTD_SIZES[descriptor >> 6] or int(single)
    start = 5 + (not single) + (0, 1, 2, 4)[descriptor & 3]
    size = int.from_bytes(frame[start : start + count], "little")
    return size + 256 if count == 2 else size
