"""Run one command of jaxswarm and write where its time went; see :mod:`benchmarks.profiling`."""

import builtins
import importlib
import json
import os
import resource
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Callable
from concurrent.futures import Future
from functools import wraps
from typing import NamedTuple

START = "JAXSWARM_PROFILE_START"
"""Name of the variable that holds the time at which the process was started."""

TIMED = {
    "reading logs": ("jaxswarm.identify.run:read_motions", "jaxswarm.identify.predict:read_log"),
    "fitting": ("jaxswarm.identify.estimation.estimate:estimate",),
    "what the model can absorb": ("jaxswarm.diagnose.folds.partial_out:cross_fit",),
    "proposing candidates": ("jaxswarm.diagnose.candidates.propose:propose_all",),
    "waiting for searches": (),
    "scoring": ("jaxswarm.diagnose.decision.score:score",),
    "deciding": ("jaxswarm.diagnose.selection.stepwise:diagnose",),
    "looking at what remains": ("jaxswarm.diagnose.run:conclude",),
    "drawing": (
        "jaxswarm.drawing:draw",
        "jaxswarm.diagnose.report.shown:ladder_shown",
        "jaxswarm.diagnose.report.shown:evidence_shown",
    ),
    "writing": ("jaxswarm.outputs:write_results", "jaxswarm.diagnose.report.html:render"),
}
EVENTS = {
    "/jax/core/compile/jaxpr_trace_duration": "tracing",
    "/jax/core/compile/jaxpr_to_mlir_module_duration": "lowering",
    "/jax/core/compile/backend_compile_duration": "compiling or reading compiled code",
}
SEARCHING = "in other threads: searching"
STAGES = (
    *("starting Python", "importing", *EVENTS.values(), *TIMED, "everything else"),
    *(SEARCHING, *(f"in other threads: {name}" for name in EVENTS.values())),
)


class Interval(NamedTuple):
    """Something that took time in a thread."""

    stage: str
    thread: int
    begin: float
    end: float


_seen: list[Interval] = []


def note(stage: str, begin: float, end: float) -> None:
    """Remember what this thread did."""
    _seen.append(Interval(stage, threading.get_ident(), begin, end))


def timed(stage: str, function: Callable) -> Callable:
    """A function whose calls are remembered."""

    @wraps(function)
    def call(*args, **more):
        begin = time.time()
        try:
            return function(*args, **more)
        finally:
            note(stage, begin, time.time())

    return call


def time_imports() -> None:
    """Remember imports of modules that are not there yet; nested ones belong to the outermost."""
    plain, depth = builtins.__import__, threading.local()

    def load(name, *args, **more):
        # ``from x import y`` may import y although x is there.
        if getattr(depth, "inside", False):
            return plain(name, *args, **more)
        depth.inside, begin = True, time.time()
        try:
            return plain(name, *args, **more)
        finally:
            depth.inside, end = False, time.time()
            if end - begin > 1e-4:
                note("importing", begin, end)

    builtins.__import__ = load


def time_functions() -> None:
    """Replace the timed functions wherever they are known by name."""
    import jax.monitoring

    jax.monitoring.register_event_duration_secs_listener(_on_event)
    for stage, places in TIMED.items():
        for place in places:
            module, name = place.split(":")
            function = getattr(importlib.import_module(module), name)
            replaced = timed(stage, function)
            for known in [m for n, m in sys.modules.items() if n.startswith("jaxswarm")]:
                for own in [n for n, value in vars(known).items() if value is function]:
                    setattr(known, own, replaced)
    Future.result = timed("waiting for searches", Future.result)
    drawing = importlib.import_module("jaxswarm.drawing").Drawing
    drawing.finished = timed("drawing", drawing.finished)
    work = importlib.import_module("concurrent.futures.thread")._WorkItem
    work.run = timed(SEARCHING, work.run)


def _on_event(name: str, seconds: float, **more) -> None:
    if name in EVENTS:
        end = time.time()
        note(EVENTS[name], end - seconds, end)


def exclusive(seen: list[Interval]) -> dict[str, float]:
    """Seconds of every stage without those of the stages within it, the main thread's apart.

    >>> inner, outer = Interval("b", 1, 2.0, 3.0), Interval("a", 1, 0.0, 4.0)
    >>> exclusive([inner, outer])
    {'in other threads: a': 3.0, 'in other threads: b': 1.0}
    """
    main = threading.main_thread().ident
    total: dict[str, float] = defaultdict(float)
    for thread in {one.thread for one in seen}:
        open_: list[Interval] = []
        own = (one for one in seen if one.thread == thread)
        for one in sorted(own, key=lambda one: (one.begin, -one.end)):
            while open_ and open_[-1].end <= one.begin:
                open_.pop()
            length = one.end - one.begin
            if open_:
                length = min(one.end, open_[-1].end) - one.begin
                total[_named(open_[-1].stage, thread == main)] -= length
            total[_named(one.stage, thread == main)] += length
            open_.append(one)
    return dict(sorted(total.items()))


def _named(stage: str, main: bool) -> str:
    return stage if main or stage.startswith("in other") else f"in other threads: {stage}"


def main() -> None:
    """Arguments of the process: the file to write, and the words of a jaxswarm command line."""
    begun, here = float(os.environ[START]), time.time()
    note("starting Python", begun, here)
    told, *words = sys.argv[1:]
    time_imports()
    from jaxswarm import cli

    begin = time.time()
    # The command line would import these a moment later: their time is that of importing all the same.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    kind = {"diagnose": "jaxswarm.diagnose.run", "identify": "jaxswarm.identify.run"}
    importlib.import_module(kind.get(words[0], "jaxswarm.identify.predict"))
    note("importing", begin, time.time())
    begin = time.time()
    time_functions()
    prepared = time.time() - begin
    sys.argv = ["jaxswarm", *words]
    code = 0
    try:
        cli.main()
    except SystemExit as end:
        code = end.code or 0
    seconds = time.time() - begun - prepared
    _write(told, seconds)
    sys.exit(code)


def _write(told: str, seconds: float) -> None:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    stages = exclusive(_seen)
    known = sum(x for name, x in stages.items() if not name.startswith("in other"))
    stages["everything else"] = seconds - known
    programs = sum(
        one.stage == EVENTS["/jax/core/compile/backend_compile_duration"] for one in _seen
    )
    content = {
        "seconds": seconds,
        "cpu_seconds": usage.ru_utime + usage.ru_stime,
        "peak_gib": usage.ru_maxrss / 1024**2,
        "programs": programs,
        "stages": stages,
    }
    with open(told, "w", encoding="utf-8") as file:
        json.dump(content, file)
