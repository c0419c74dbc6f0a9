"""How much memory a diagnosis takes, told before it is begun: the system would end it in its midst."""

import os
from collections.abc import Sequence
from pathlib import Path

from jaxswarm.diagnose.candidates.link_lag import MOST_NUMBERS
from jaxswarm.errors import InputError
from jaxswarm.identify.forward.columns import is_kept, numbers_of
from jaxswarm.logs.motion import Motion

# Signals of a joint that stand in memory at once: motion, torques, loads, what laws see, each with copies.
_SIGNALS = 60
# Derivatives of a torque by every joint that are kept from one candidate to the next.
_TURNED = 3
# Curves of transmissions that are held at a time, with what they are made of; of a long log some at a time.
_CURVES, _WITH = 200, 6
_GIB = 2**30


def needed(motions: Sequence[Motion]) -> float:
    """Memory [GiB] that a diagnosis of motions holds at its peak, beside the program's own half.

    The columns of the rigid body and their derivatives by the motion of every joint where they are kept, the
    curves of transmissions, and the signals themselves, on the working clock.
    """
    numbers = 0.0
    for motion in motions:
        samples, joints = motion.q.shape
        numbers += numbers_of(motion) if is_kept(motion) else 0
        numbers += min(samples * joints * _CURVES, _WITH * MOST_NUMBERS)
        numbers += samples * joints * (_SIGNALS + _TURNED * joints)
    return 8.0 * numbers / _GIB


def free() -> float | None:
    """Memory [GiB] that this process may still take; None where the system does not tell."""
    told = [_available(), *(_group(Path("/sys/fs/cgroup")))]
    known = [x for x in told if x is not None]
    return min(known) / _GIB if known else None


def _available() -> float | None:
    try:
        for line in Path("/proc/meminfo").read_text(encoding="ascii").splitlines():
            if line.startswith("MemAvailable:"):
                return 1024.0 * int(line.split()[1])
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (OSError, ValueError, AttributeError):
        return None


def _group(folder: Path) -> list[float]:
    """What a container's limit leaves."""
    try:
        limit, used = (
            (folder / name).read_text(encoding="ascii").strip()
            for name in ("memory.max", "memory.current")
        )
        return [float(limit) - float(used)]
    except (OSError, ValueError):  # no container, or one without a limit
        return []


def refuse_too_large(motions: Sequence[Motion]) -> None:
    """Refuse motions whose diagnosis would not fit into memory.

    Raises:
        InputError: With what is needed and what there is.
    """
    most, there = needed(motions), free()
    if there is None or most <= there:
        return
    longest = max(motions, key=lambda motion: len(motion.t))
    total = sum(len(motion.t) for motion in motions)
    raise InputError(
        f"{longest.source}: {total} samples of {len(longest.joints)} joints at {longest.rate:.4g} Hz take "
        f"about {most:.3g} GiB to diagnose, and {there:.3g} GiB are free; give a shorter stretch of "
        "the log, or a --motion-cutoff below "
        f"{max(longest.motion_cutoff):.3g} Hz, with which fewer samples do"
    )
