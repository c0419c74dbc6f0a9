"""Any file with bytes flipped, cut, doubled or put in."""

import numpy as np

_ODD = (
    b"\x00" * 64,
    b"\xff" * 64,
    b"[" * 3000,
    b"9" * 400,
    b"\xef\xbb\xbf",
    b"\r\n",
    b'"',
    b"\x1b[31m",
)


def spoil_bytes(rng: np.random.Generator, content: bytes) -> bytes:
    """The content with one to four changes."""
    data = bytearray(content)
    for _ in range(rng.integers(1, 5)):
        place = int(rng.integers(len(data) + 1))
        length = int(2 ** rng.integers(0, 10))
        change = rng.integers(6)
        if change == 0 and data:
            data[min(place, len(data) - 1)] ^= 1 << int(rng.integers(8))
        elif change == 1:
            del data[place : place + length]
        elif change == 2:
            data[place:place] = data[max(0, place - length) : place]
        elif change == 3:
            data[place:place] = _ODD[rng.integers(len(_ODD))]
        elif change == 4:
            data[place : place + length] = rng.bytes(length)
        elif rng.random() < 0.3:
            del data[place:]
    return bytes(data)
