"""The command ``diagnose --fleet``, from logs to a table and a page."""

import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from jaxswarm import outputs, plots
from jaxswarm.diagnose.report.numbers import measure
from jaxswarm.effects.term import parse_terms
from jaxswarm.errors import InputError
from jaxswarm.fleet import pictures
from jaxswarm.fleet.collect import Entry, Fleet, collect, in_order
from jaxswarm.fleet.drift import drifts as drifts_of
from jaxswarm.fleet.extra import require
from jaxswarm.fleet.mixed_model import deviations as deviations_of
from jaxswarm.fleet.naming import read_pattern
from jaxswarm.fleet.one_log import FAILED, REFUSED, Settings
from jaxswarm.fleet.page import headline, render, verdicts
from jaxswarm.fleet.ranking import Arm, rank
from jaxswarm.fleet.schedule import Cluster, answers, by_size, connected
from jaxswarm.fleet.sources import Source, find_logs
from jaxswarm.fleet.store import Store, fingerprint
from jaxswarm.identify.forward.model import load_model
from jaxswarm.identify.run import refuse_undeclarable
from jaxswarm.logs import LogChoice
from jaxswarm.logs.reading import reading_of
from jaxswarm.robot import RobotChoice, load_robot
from jaxswarm.tables import Result, Table

TABLE, PAGE, RESULTS = "fleet.parquet", "fleet.html", "logs"
AGAINST = ("fleet",)
# Arms in the table of the terminal.
_SHOWN = 20


def diagnose_fleet(
    logs: str | LogChoice,
    robot: str | Path | RobotChoice,
    out: Path,
    *,
    declare: str | None = None,
    model: Path | None = None,
    against: str | None = None,
    arm_pattern: str | None = None,
    cluster: Cluster | None = None,
    seed: int = 0,
    motion_cutoff: float | None = None,
    torque_cutoff: float | None = None,
    accept: Sequence[str] = (),
    budget: float | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> Result:
    """Diagnose every log of a fleet and say which arm needs a look.

    Args:
        logs: Folder, glob or address, see :func:`jaxswarm.fleet.sources.find_logs`; or how to read it too.
        robot: The kind of the arms.
        out: Folder for ``fleet.parquet``, ``fleet.html`` and ``logs/``; what is in it is not done again.
        declare: What is known to be on every arm.
        model: Model identified before, in place of ``declare``: what changed since.
        against: ``"fleet"``: compare every arm with the others too.
        arm_pattern: Rule for arm and date, see :mod:`jaxswarm.fleet.naming`.
        cluster: Where to work; default all cores of this machine.
        seed, motion_cutoff, torque_cutoff, accept, budget: As for one log.
        progress: Called with one line per log.

    Returns:
        Counts, ranked arms, differences and drifts, as plain data with tables.

    Raises:
        InputError: On anything that concerns all logs; what concerns one is a row of the table.
    """
    require()
    if against is not None and against not in AGAINST:
        raise InputError(f"--against {against}: give fleet, to compare every arm with the others")
    question = (robot, declare, model, seed, motion_cutoff, torque_cutoff, accept, budget)
    settings = _settings(*question, reading_of(logs))
    sources = _sources(str(logs), read_pattern(arm_pattern), out, progress)
    store = Store(out / RESULTS, fingerprint(settings))
    failed = _work(store, sources, settings, cluster or Cluster(), progress)

    def results() -> Iterator[tuple[Source, dict]]:
        return ((s, failed.get(s.path) or store.result(s)) for s in sources)

    progress("putting the results together")
    fleet = collect(results())
    found, moved = deviations_of(fleet.series) if against else None, drifts_of(fleet.series)
    arms = rank(fleet.entries, found or (), moved)
    page = render(settings.robot.name, fleet, arms, found, moved, _pictures(fleet, arms, moved))
    outputs.write_results(out, {TABLE: _table_writer(results, found or ()), PAGE: page})
    content = {
        **{"robot": settings.robot.name, "logs": len(sources)},
        **_content(fleet, arms, found or (), moved),
        "table": str(out / TABLE),
        "page": str(out / PAGE),
    }
    return Result(content, (headline(arms), *_told(content)), (_ranking(arms),))


def _sources(logs: str, pattern, out: Path, progress: Callable[[str], None]) -> list[Source]:
    """The logs in their order, with a folder that can hold the results."""
    outputs.check_folder(out)
    progress("looking for logs")
    sources = in_order(find_logs(logs, pattern))
    _refuse_among_logs(out, logs, sources)
    return sources


def _content(fleet: Fleet, arms: Sequence[Arm], found: Sequence, moved: Sequence) -> dict:
    """What was found of the arms, as plain data."""
    return {
        "verdicts": verdicts(fleet),
        "arms": [arm._asdict() | {"last": arm.last and arm.last.isoformat()} for arm in arms],
        "differences": [one._asdict() for one in found if one.differs],
        "drifts": [one._asdict() for one in moved if one.drifts],
        "unused": [_unused(one) for one in fleet.entries if one.verdict in (REFUSED, FAILED)],
    }


def _settings(
    robot, declare, model, seed, motion_cutoff, torque_cutoff, accept, budget, reading
) -> Settings:
    """What is asked of every log; what is wrong with it is told before the first."""
    arm = load_robot(robot)
    earlier = None if model is None else load_model(model)
    if model is not None and (motion_cutoff or torque_cutoff):
        raise InputError("--model holds the cutoffs: leave out --motion-cutoff and --torque-cutoff")
    refuse_undeclarable(parse_terms(declare or "none", arm.joints))
    return Settings(
        arm, declare, earlier, seed, motion_cutoff, torque_cutoff, tuple(accept), budget, reading
    )


def _refuse_among_logs(out: Path, logs: str, sources: Sequence[Source]) -> None:
    """Refuse a folder of results whose table would be taken for a log the next time."""
    place, root = out.resolve(), Path(logs).resolve()
    within = root.is_dir() and (place == root or root in place.parents)
    if within or any(Path(source.address).resolve() == place / TABLE for source in sources):
        raise InputError(
            f"--out {out}: lies among the logs of --fleet {logs}, where {TABLE} would be taken for one; "
            "choose a folder apart from them"
        )


def _work(
    store: Store,
    sources: Sequence[Source],
    settings: Settings,
    cluster: Cluster,
    progress: Callable[[str], None],
) -> dict[str, dict]:
    """Do what is not done yet; returns the failures, which are not kept, by path."""
    todo = [source for source in sources if not store.known(source)]
    failed: dict[str, dict] = {}
    if not todo:
        return failed
    progress(f"starting workers for {len(todo)} of {len(sources)} logs")
    with connected(cluster) as client:
        begin = time.monotonic()
        for done, (source, answer) in enumerate(answers(client, by_size(todo), settings), 1):
            store.keep(source, answer)
            if answer.get("unused") == FAILED:
                failed[source.path] = answer
            progress(_pace(done, len(todo), len(sources) - len(todo), time.monotonic() - begin))
    return failed


def _pace(done: int, todo: int, before: int, seconds: float) -> str:
    """How far the work is.

    >>> _pace(30, 120, 0, 60.0)
    '30 of 120 logs, 30 a minute, 3 min left'
    >>> _pace(1, 4, 6, 5.0)
    '7 of 10 logs, 12 a minute, 15 s left'
    """
    left = (todo - done) * seconds / done
    wait = (
        f"{left:.0f} s"
        if left < 100
        else f"{left / 60:.0f} min"
        if left < 6000
        else f"{left / 3600:.1f} h"
    )
    rate = 60.0 * done / max(seconds, 1e-9)
    return f"{done + before} of {todo + before} logs, {rate:.3g} a minute, {wait} left"


def _table_writer(results: Callable, found) -> Callable[[Path], int]:
    from jaxswarm.fleet.table import write_table

    told = {(one.arm, one.parameter): one for one in found}
    return lambda path: write_table(path, results(), told)


def _pictures(fleet: Fleet, arms: Sequence[Arm], moved) -> dict[str, bytes]:
    drawn = {
        "drift.png": pictures.over_time(fleet, [arm.name for arm in arms]),
        "changed.png": pictures.changed(fleet, moved),
    }
    return {name: plots.png_bytes(figure) for name, figure in drawn.items() if figure is not None}


def _unused(one: Entry) -> dict:
    return {"log": one.source.path, "arm": one.source.arm, "why": one.verdict, "reason": one.reason}


def _told(content: dict) -> list[str]:
    counts = ", ".join(f"{count} {word}" for word, count in content["verdicts"].items())
    lines = [f"{content['logs']} logs: {counts}."]
    lines += [f"{one['log']}: {one['why']}: {one['reason']}" for one in content["unused"][:_SHOWN]]
    return [*lines, f"written to {content['table']} and {content['page']}"]


def _ranking(arms: Sequence[Arm]) -> Table:
    rows = [
        (
            arm.name,
            str(arm.logs),
            arm.verdict,
            ", ".join(arm.found),
            measure(arm.worst),
            ", ".join(arm.differs),
            ", ".join(arm.drifts),
        )
        for arm in arms[:_SHOWN]
    ]
    head = ("arm", "logs", "newest verdict", "found", "x noise", "differs in", "drifts in")
    return Table(f"the first {len(rows)} of {len(arms)} arms", head, tuple(rows))
