"""What a log holds, before anything is fitted."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from jaxswarm import plots
from jaxswarm.errors import InputError
from jaxswarm.identify.checks.check_log import CHECKS, checked
from jaxswarm.logs import Log, read_log, summarize
from jaxswarm.logs.coverage import coverage, period_of
from jaxswarm.logs.joints import joints_in
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot import Robot
from jaxswarm.tables import Result, Table
from jaxswarm.tasks.identifiable import identifiable
from jaxswarm.tasks.inputs import Logs, OneLog, as_logs, as_robot, in_double
from jaxswarm.tasks.words import number

# Fewer reversals than this leave Coulomb friction and an offset hard to tell apart.
_FEW_REVERSALS = 4
# Slow motion in less than this share of the samples shows no Stribeck friction.
_LITTLE_SLOW = 0.02


@dataclass(frozen=True, eq=False, repr=False)
class Inspected(Result):
    """What logs hold; ``logs`` are the logs as read."""

    logs: tuple[Log, ...] = ()

    def plots(self) -> dict[str, Figure]:
        """Signals over time and torque over velocity of every log, by name."""
        found = {}
        for k, log in enumerate(self.logs, 1):
            end = f"_{k}" if len(self.logs) > 1 else ""
            found[f"signals{end}.png"] = _signals(log)
            if log.tau is not None:
                found[f"coverage{end}.png"] = _covered(log, log.tau)
        return found


@in_double
def inspect(
    logs: Logs,
    robot: Robot | str | Path | None = None,
    *,
    progress: Callable[[str], None] = lambda text: None,
) -> Inspected:
    """Say what logs hold, and with a robot, what could be identified from them.

    Args:
        logs: A log or several, as :class:`jaxswarm.Log` or files; torque is not needed.
        robot: A robot, a built-in name or a file; None: joints as the file names them.
        progress: Called with one line per stage.

    Raises:
        InputError: If a log cannot be used at all.
    """
    progress("reading logs")
    arm = None if robot is None else as_robot(robot)
    if arm is None:
        many = [logs] if isinstance(logs, OneLog) else list(logs)
        read = [
            log if isinstance(log, Log) else read_log(log, joints_in(log), require_torque=False)
            for log in many
        ]
    else:
        read = as_logs(logs, arm, require_torque=False)
    if not read:
        raise InputError("no logs: pass at least one")
    content: dict[str, Any] = {"logs": [_describe(log) for log in read]}
    if arm is not None:
        progress("looking at what could be identified")
        filtering, motions, noted = Filtering(), [], []
        for log in read:
            after, parts = checked(log, arm, filtering, tuple(CHECKS), refuse_dead=False)
            noted.append(replace(log, notes=after.notes))
            motions += parts
            filtering = motions[0].filtering
        content = {"logs": [_describe(log) for log in noted], "robot": arm.name}
        content["identifiable"] = identifiable(arm, motions)
    return _result(content, tuple(read))


def _describe(log: Log) -> dict:
    """Everything about one log as plain data."""
    summary = summarize(log)
    period = period_of(log)
    joints = [
        {**vars(joint), **vars(cover), "can": _can(joint, cover, log)}
        for joint, cover in zip(summary.joints, coverage(log), strict=True)
    ]
    quantities = [name for name in ("q", "dq", "ddq", "tau") if getattr(log, name) is not None]
    return {
        **summary.to_dict(),
        "channels": [*quantities, *log.channels],
        "period": period,
        "periods": None if period is None else float((log.t[-1] - log.t[0]) / period),
        "joints": joints,
        "findings": list(log.notes),
    }


def _can(joint, cover, log: Log) -> list[str]:
    """What the motion of one joint does not show, in sentences."""
    told = []
    if not joint.moves:
        return ["nothing: it never moves"]
    if joint.reversals < _FEW_REVERSALS:
        told.append(
            f"{joint.reversals} reversals: Coulomb friction is hard to tell from an offset; reverse more"
        )
    if cover.slow < _LITTLE_SLOW:
        told.append("hardly any slow motion: friction at low speed (Stribeck) cannot be seen")
    if cover.load_reversals == 0:
        told.append("the torque never changes sign: a dead zone in a gear cannot be seen")
    return told


def _result(content: dict, logs: tuple[Log, ...]) -> Inspected:
    lines, tables = [], []
    for entry, log in zip(content["logs"], logs, strict=True):
        clock = entry["sampling"]
        repeats = "" if entry["period"] is None else (
            f", repeats after {entry['period']:.4g} s ({entry['periods']:.3g} periods)"
        )  # fmt: skip
        lines.append(
            f"{entry['source']}: {entry['samples']} samples, {entry['duration']:.6g} s at "
            f"{clock['rate']:.5g} Hz, jitter {100 * clock['jitter']:.2g} %, {len(clock['gaps'])} gaps"
            f"{repeats}; channels {', '.join(entry['channels'])}"
        )
        lines += [f"- {note}" for note in entry["findings"]]
        lines += [f"- {j['name']}: {text}" for j in entry["joints"] for text in j["can"]]
        if log.tau is None:
            lines.append("- no torque: such a log can be predicted along, not identified from")
        tables += [_motion_table(entry), _signal_table(entry)]
    if "identifiable" in content:
        found = content["identifiable"]
        lines.append(
            f"{content['robot']}: condition number {found['condition_number']:.4g}, "
            f"{len(found['base_parameters'])} base parameters of rigid body and friction"
        )
        if found["never_seen"]:
            lines.append(f"- not seen alone in this motion: {', '.join(found['never_seen'])}")
        tables.append(_base_table(found))
    return Inspected(content, tuple(lines), tuple(tables), logs=logs)


def _motion_table(entry: dict) -> Table:
    rows = [
        (j["name"], f"{number(j['position_min'], 4)} .. {number(j['position_max'], 4)}",
         number(j["speed_max"], 3), f"{100 * j['moving_share']:.0f} %", str(j["reversals"]),
         f"{100 * j['slow']:.0f} / {100 * j['fast']:.0f} %",
         "" if j["load_reversals"] is None else str(j["load_reversals"]))
        for j in entry["joints"]
    ]  # fmt: skip
    head = (
        "joint",
        "position",
        "top speed",
        "moving",
        "reversals",
        "slow / fast",
        "load reversals",
    )
    return Table("motion (rad or m, s)", head, tuple(rows))


def _signal_table(entry: dict) -> Table:
    rows = [
        (j["name"], number(j["position_noise"], 2), number(j["position_quantum"], 2),
         "" if j["torque_min"] is None
         else f"{number(j['torque_min'], 4)} .. {number(j['torque_max'], 4)}",
         number(j["torque_noise"], 2), number(j["torque_quantum"], 2), str(j["saturated"]))
        for j in entry["joints"]
    ]  # fmt: skip
    head = ("joint", "noise of q", "step of q", "torque", "noise", "step", "saturated")
    return Table("signals (rad or m, N m or N)", head, tuple(rows))


def _base_table(found: dict) -> Table:
    rows = [
        (row["name"], f"{row['magnification']:.3g}", row["verdict"],
         "" if row["expression"] == row["name"] else row["expression"])
        for row in found["base_parameters"]
    ]  # fmt: skip
    head = ("parameter", "errors magnified by", "verdict", "stands for")
    return Table("what could be identified", head, tuple(rows))


def _signals(log: Log) -> Figure:
    kinds = [("position", log.q)] + ([("torque", log.tau)] if log.tau is not None else [])
    count = len(log.joints)
    figure, axes = plots.panels(count, len(kinds), 5.0 * len(kinds), 1.5 * count + 0.8, sharex=True)
    for j, joint in enumerate(log.joints):
        for k, (name, values) in enumerate(kinds):
            axis = axes[j * len(kinds) + k]
            axis.plot(log.t, values[:, j], lw=0.7, color=(plots.RESIDUAL, plots.MODEL)[k])
            axis.set_ylabel(f"{joint}\n{name}", fontsize=8)
    for axis in axes[-len(kinds) :]:
        axis.set_xlabel("time [s]")
    return figure


def _covered(log: Log, tau: np.ndarray) -> Figure:
    count = len(log.joints)
    figure, axes = plots.panels(1, count, 2.6 * count + 0.6, 2.8)
    for j, axis in enumerate(axes):
        dq = np.gradient(log.q[:, j], log.t) if log.dq is None else log.dq[:, j]
        axis.plot(dq, tau[:, j], ".", ms=1.5, alpha=0.3, color=plots.MEASURED)
        axis.set_xlabel(f"velocity of {log.joints[j]}")
    axes[0].set_ylabel("torque")
    return figure
