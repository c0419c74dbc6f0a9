"""What was seen in logs as sentences, tables and pictures."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from jaxswarm import plots
from jaxswarm.logs import Log
from jaxswarm.robot import Robot
from jaxswarm.tables import Table
from jaxswarm.tasks.words import number

# A clock that jitters by less than this share of its interval is even: the rest is rounding of the stamps.
_EVEN = 1e-4
# Parameters named in a sentence; the others are in the table.
_MOST_NAMED = 6


class Quantities(NamedTuple):
    """Units of positions and torques, joint by joint, or of both kinds where the joints are unknown."""

    position: tuple[str, ...]
    torque: tuple[str, ...]

    @classmethod
    def of(cls, robot: Robot | None, joints: int) -> "Quantities":
        """Those of a robot's joints."""
        if robot is None:
            return cls(("rad or m",) * joints, ("N m or N",) * joints)
        slides = [kind == "prismatic" for kind in robot.kinds]
        return cls(
            tuple("m" if slide else "rad" for slide in slides),
            tuple("N" if slide else "N m" for slide in slides),
        )

    @property
    def mixed(self) -> bool:
        """Whether the joints have different ones."""
        return len(set(self.position)) > 1

    def head(self, *further: str) -> str:
        """What a table says of all its rows."""
        return "units beside the joints" if self.mixed else ", ".join((self.position[0], *further))

    def label(self, k: int, name: str) -> str:
        """A joint as the head of a row."""
        return f"{name} [{self.position[k]}, {self.torque[k]}]" if self.mixed else name


def clock_line(entry: dict) -> str:
    """Length, rate and evenness of a log, its period and its channels."""
    clock = entry["sampling"]
    jitter = clock["jitter"]
    gaps = len(clock["gaps"])
    told = [
        f"{entry['samples']} samples, {entry['duration']:.6g} s at {clock['rate']:.5g} Hz",
        "even stamps"
        if jitter < _EVEN
        else f"stamps jitter by {100 * jitter:.2g} % of an interval",
        "no gap" if not gaps else "1 gap" if gaps == 1 else f"{gaps} gaps",
    ]
    if entry["period"] is not None:
        told.append(f"repeats after {entry['period']:.4g} s ({entry['periods']:.3g} periods)")
    return f"{entry['source']}: {', '.join(told)}; channels {', '.join(entry['channels'])}"


def identifiable_line(robot: str, found: dict) -> str:
    """What could be identified, in a sentence; the names of what could not."""
    rows = found["base_parameters"]
    good = sum(row["verdict"] == "determined" for row in rows)
    worst = max(rows, key=lambda row: row["magnification"])
    told = f"{robot}: {'all' if good == len(rows) else f'{good} of'} {len(rows)} base parameters "
    told += "of rigid body and friction could be determined"
    for verdict in ("weak", "lost"):
        names = [row["name"] for row in rows if row["verdict"] == verdict]
        more = f" and {len(names) - _MOST_NAMED} more" if len(names) > _MOST_NAMED else ""
        told += f"; {verdict}: {', '.join(names[:_MOST_NAMED])}{more}" if names else ""
    return (
        f"{told}. Errors are magnified {worst['magnification']:.3g} times at most ({worst['name']}); "
        f"condition number {found['condition_number']:.4g}."
    )


def motion_table(entry: dict, unit: Quantities) -> Table:
    """Where and how fast each joint was moved."""
    rows = [
        (unit.label(k, j["name"]),
         f"{number(j['position_min'], 4)} .. {number(j['position_max'], 4)}",
         number(j["speed_max"], 3), f"{100 * j['moving_share']:.0f} %", str(j["reversals"]),
         f"{100 * j['slow']:.0f} %", f"{100 * j['fast']:.0f} %",
         "" if j["load_reversals"] is None else str(j["load_reversals"]))
        for k, j in enumerate(entry["joints"])
    ]  # fmt: skip
    head = (
        *("joint", "position", "top speed", "moving", "reversals"),
        *("slow", "fast", "torque reversals"),
    )
    speeds = "slow: below 10 % of the top speed, fast: above 50 %"
    return Table(f"motion ({unit.head('s')}); {speeds}", head, tuple(rows))


def signal_table(entry: dict, unit: Quantities) -> Table:
    """Noise, steps and range of each joint's signals."""
    rows = [
        (unit.label(k, j["name"]), number(j["position_noise"], 2), number(j["position_quantum"], 2),
         "" if j["torque_min"] is None
         else f"{number(j['torque_min'], 4)} .. {number(j['torque_max'], 4)}",
         number(j["torque_noise"], 2), number(j["torque_quantum"], 2), str(j["saturated"]))
        for k, j in enumerate(entry["joints"])
    ]  # fmt: skip
    head = (
        *("joint", "noise of position", "step of position", "torque"),
        *("noise of torque", "step of torque", "at its limit"),
    )
    return Table(f"signals ({unit.head(unit.torque[0])})", head, tuple(rows))


def base_table(found: dict) -> Table:
    """What could be identified, parameter by parameter; what could not stands out."""
    rows = [
        (row["name"], f"{row['magnification']:.3g}", row["verdict"],
         "" if row["expression"] == row["name"] else row["expression"])
        for row in found["base_parameters"]
    ]  # fmt: skip
    head = ("parameter", "errors magnified by", "verdict", "stands for")
    marked = (k for k, row in enumerate(found["base_parameters"]) if row["verdict"] != "determined")
    return Table("what could be identified", head, tuple(rows), frozenset(marked))


def signal_picture(log: Log, unit: Quantities) -> Figure:
    """Position and torque of every joint over time."""
    kinds: list[tuple[str, np.ndarray, Sequence[str]]] = [("position", log.q, unit.position)]
    if log.tau is not None:
        kinds.append(("torque", log.tau, unit.torque))
    count = len(log.joints)
    figure, axes = plots.panels(count, len(kinds), 5.0 * len(kinds), 1.5 * count + 0.8, sharex=True)
    for j, joint in enumerate(log.joints):
        for k, (name, values, units) in enumerate(kinds):
            axis = axes[j * len(kinds) + k]
            axis.plot(log.t, values[:, j], lw=0.7, color=(plots.RESIDUAL, plots.MODEL)[k])
            axis.set_ylabel(f"{joint}\n{name} [{units[j]}]", fontsize=8)
    for axis in axes[-len(kinds) :]:
        axis.set_xlabel("time [s]")
    return figure


def coverage_picture(log: Log, tau: np.ndarray, unit: Quantities) -> Figure:
    """Torque over velocity of every joint."""
    count = len(log.joints)
    figure, axes = plots.panels(1, count, 2.6 * count + 0.6, 2.8)
    for j, axis in enumerate(axes):
        dq: Any = np.gradient(log.q[:, j], log.t) if log.dq is None else log.dq[:, j]
        axis.plot(dq, tau[:, j], ".", ms=1.5, alpha=0.3, color=plots.MEASURED)
        speed = "/s or ".join(unit.position[j].split(" or ")) + "/s"
        axis.set_xlabel(f"velocity of {log.joints[j]} [{speed}]", fontsize=8)
        axis.set_ylabel(f"torque [{unit.torque[j]}]" if j == 0 or unit.mixed else "", fontsize=8)
    return figure
