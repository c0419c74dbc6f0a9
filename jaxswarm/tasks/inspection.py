"""What a log holds, before anything is fitted."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from jaxswarm.errors import InputError
from jaxswarm.identify.checks.check_log import CHECKS, checked
from jaxswarm.logs import Log, read_log, summarize
from jaxswarm.logs.coverage import coverage, period_of
from jaxswarm.logs.joints import joints_in
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot import Robot
from jaxswarm.tables import Result
from jaxswarm.tasks import inspection_tables as shown
from jaxswarm.tasks.identifiable import identifiable
from jaxswarm.tasks.inputs import Logs, OneLog, as_logs, as_robot, in_double

# Fewer reversals than this leave Coulomb friction and an offset hard to tell apart.
_FEW_REVERSALS = 4
# Slow motion in less than this share of the samples shows no Stribeck friction.
_LITTLE_SLOW = 0.02


@dataclass(frozen=True, eq=False, repr=False)
class Inspected(Result):
    """What logs hold; ``logs`` are the logs as read, ``robot`` the arm, if one was named."""

    logs: tuple[Log, ...] = ()
    robot: Robot | None = None

    def plots(self) -> dict[str, Figure]:
        """Signals over time and torque over velocity of every log, by name."""
        found = {}
        for k, log in enumerate(self.logs, 1):
            end = f"_{k}" if len(self.logs) > 1 else ""
            unit = shown.Quantities.of(self.robot, len(log.joints))
            found[f"signals{end}.png"] = shown.signal_picture(log, unit)
            if log.tau is not None:
                found[f"coverage{end}.png"] = shown.coverage_picture(log, log.tau, unit)
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
    return _result(content, tuple(read), arm)


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
        place = 0.5 * (joint.position_min + joint.position_max)
        return [f"nothing: it never moves; if it cannot, hold it: --lock {joint.name}={place:.6g}"]
    if joint.reversals < _FEW_REVERSALS:
        told.append(
            f"{joint.reversals} reversals: Coulomb friction is hard to tell from an offset; reverse more"
        )
    if cover.slow < _LITTLE_SLOW:
        told.append("hardly any slow motion: friction at low speed (Stribeck) cannot be seen")
    if cover.load_reversals == 0:
        told.append("the torque never changes sign: a dead zone in a gear cannot be seen")
    return told


def _result(content: dict, logs: tuple[Log, ...], arm: Robot | None) -> Inspected:
    lines, tables = [], []
    for entry, log in zip(content["logs"], logs, strict=True):
        unit = shown.Quantities.of(arm, len(log.joints))
        lines.append(shown.clock_line(entry))
        lines += [f"- {note}" for note in entry["findings"]]
        lines += [f"- {j['name']}: {text}" for j in entry["joints"] for text in j["can"]]
        if log.tau is None:
            lines.append("- no torque: such a log can be predicted along, not identified from")
        tables += [shown.motion_table(entry, unit), shown.signal_table(entry, unit)]
    if "identifiable" in content:
        found = content["identifiable"]
        lines.append(shown.identifiable_line(content["robot"], found))
        if found["never_seen"]:
            lines.append(f"- not seen alone in this motion: {', '.join(found['never_seen'])}")
        tables.append(shown.base_table(found))
    return Inspected(content, tuple(lines), tuple(tables), logs=logs, robot=arm)
