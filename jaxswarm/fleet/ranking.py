"""Arms in the order in which somebody should look at them."""

from collections.abc import Sequence
from datetime import datetime
from itertools import groupby
from typing import NamedTuple

import numpy as np

from jaxswarm.fleet.collect import Entry
from jaxswarm.fleet.drift import Drift
from jaxswarm.fleet.mixed_model import Deviation
from jaxswarm.fleet.one_log import FAILED, REFUSED


class Arm(NamedTuple):
    """One arm as its logs show it.

    Attributes:
        name: Its name.
        logs: Number of logs; unused: of those that could not be used.
        last: Date of the newest log that could be used.
        verdict: Of that log, or of the last one at all.
        found: Effects that it lacks or that changed, in that log.
        worst: Largest residual over noise of its joints, in that log; NaN: unknown.
        differs: Parameters that differ from those of its sisters.
        drifts: Parameters that changed over its logs.
    """

    name: str
    logs: int
    unused: int
    last: datetime | None
    verdict: str
    found: tuple[str, ...]
    worst: float
    differs: tuple[str, ...]
    drifts: tuple[str, ...]


def rank(
    entries: Sequence[Entry], deviations: Sequence[Deviation], drifts: Sequence[Drift]
) -> list[Arm]:
    """Arms, worst first: by what was found, then by how far the newest log is from the noise.

    Args:
        entries: Logs, those of one arm together and in order of time.
        deviations: What the comparison with the other arms says.
        drifts: What changed on each arm.
    """
    apart = _by_arm([one for one in deviations if one.differs])
    moved = _by_arm([one for one in drifts if one.drifts])
    arms = [
        _arm(name, list(own), apart.get(name, ()), moved.get(name, ()))
        for name, own in groupby(entries, key=lambda one: one.source.arm)
    ]
    return sorted(arms, key=_order)


def _arm(name: str, entries: list[Entry], differs: tuple, drifts: tuple) -> Arm:
    used = [one for one in entries if one.verdict not in (REFUSED, FAILED)]
    newest = used[-1] if used else entries[-1]
    known = [x for x in newest.over_noise if np.isfinite(x)]
    worst = max(known, default=np.nan)
    unused = len(entries) - len(used)
    return Arm(
        name, len(entries), unused, newest.source.date, newest.verdict, newest.found, worst,
        differs, drifts,
    )  # fmt: skip


def _order(arm: Arm) -> tuple:
    silent = not (arm.found or arm.differs or arm.drifts)
    return silent, -(arm.worst if np.isfinite(arm.worst) else 0.0), arm.name


def _by_arm(found: Sequence[Deviation | Drift]) -> dict[str, tuple[str, ...]]:
    names: dict[str, tuple[str, ...]] = {}
    for one in sorted(found, key=lambda x: x.q_value):
        names[one.arm] = (*names.get(one.arm, ()), one.parameter)
    return names
