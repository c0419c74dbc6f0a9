"""The command ``python -m benchmarks.diagnosis worlds``: diagnose worlds, tabulate, or write them.

World ``k`` is the same world everywhere; 1300 of them (0-1299) hold 500 clean ones and 800 others. Rows go to
``benchmarks/results/worlds-*.jsonl`` as they are finished, the table to ``worlds.md``; what is finished is
not done again. With ``--rivals`` the rivals work at the same worlds, into ``worlds_rivals``. With ``--held``
dry friction holds joints at rest at any torque within it, as MuJoCo's own constraint: ``worlds_held``.
"""

import argparse
import os
from pathlib import Path

from benchmarks.timing import RESULTS


def numbers(text: str) -> list[int]:
    """``7``, ``0-12`` or ``3,5,20-25`` as numbers of worlds."""
    chosen: list[int] = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        chosen += range(int(first), int(last or first) + 1)
    return chosen


def main(arguments: list[str]) -> None:
    options = _options(arguments)
    if options.write:
        return write(numbers(options.write), options.out, options.held)
    RESULTS.mkdir(exist_ok=True)
    if options.table:
        return show(options.rivals, options.held)
    if options.processes > 1:
        from benchmarks.worlds.run import spread

        spread(_passed_on(options), options.share, options.processes)
    else:
        work(options)
    if not options.no_table:
        show(options.rivals, options.held)


def _options(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.diagnosis worlds",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("--worlds", default="", help="numbers such as 3,10-20 (default 0-1299; --fast 0-25)")
    add("--fast", action="store_true", help="two rounds of thirteen")
    add(
        "--only", default="", help="kinds of effects, families of arms, controllers, motions, clean"
    )
    add("--share", default="1/1", help="which of how many machines or processes this is")
    add("--processes", type=int, default=1, help="processes on this machine")
    add("--rivals", action="store_true", help="other methods in place of the diagnosis")
    add("--held", action="store_true", help="dry friction that holds joints at rest")
    add("--table", action="store_true", help="only the table of what is finished")
    add("--no-table", action="store_true", help=argparse.SUPPRESS)
    add("--write", default="", help="numbers of worlds to write to files, nothing else")
    add("--out", type=Path, default=Path("worlds"), help="folder for --write")
    return parser.parse_args(arguments)


def _passed_on(options) -> list[str]:
    passed = ["--worlds", options.worlds, "--only", options.only]
    flags = ["--fast"] * options.fast + ["--rivals"] * options.rivals + ["--held"] * options.held
    return passed + flags


def work(options) -> None:
    """Score this process's share."""
    import jax

    from benchmarks.worlds.run import COUNT, FAST, run_share

    jax.config.update("jax_enable_x64", True)
    if not jax.config.jax_compilation_cache_dir:
        jax.config.update("jax_compilation_cache_dir", str(RESULTS / "compiled"))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.1)
    if options.rivals:
        # Threads of the boosted trees that wait for each other make a shared machine crawl.
        os.environ.setdefault("OMP_NUM_THREADS", "1")
        from benchmarks.worlds.rivals import score_rivals as score
    else:
        from benchmarks.worlds.score import score_world as score
    chosen = numbers(options.worlds or f"0-{(FAST if options.fast else COUNT) - 1}")
    wanted = set(filter(None, options.only.split(",")))
    name = stem(options.rivals, options.held)
    run_share(name, chosen, options.share, wanted, score, options.held)


def stem(rivals: bool, held: bool) -> str:
    """Name of the files of rows."""
    return "worlds" + "_held" * held + "_rivals" * rivals


def show(rivals: bool, held: bool) -> None:
    """Write and print the table of all finished rows."""
    from benchmarks.worlds.run import read_rows
    from benchmarks.worlds.table import worlds_table

    rows = read_rows(stem(False, held))
    if rivals:
        from benchmarks.worlds.rivals_table import rivals_table

        text = rivals_table(read_rows(stem(True, held)), rows)
    else:
        text = worlds_table(rows)
    (RESULTS / f"{stem(rivals, held)}.md").write_text(text)
    print(text)


def write(chosen: list[int], out: Path, held: bool) -> None:
    """Write worlds to folders, for debugging."""
    from benchmarks.worlds.files import write_world
    from benchmarks.worlds.world import make_world

    for number in chosen:
        truth = write_world(make_world(number, held=held), out / f"w{number:04d}")
        kinds = [e["effect"] for e in (*truth["effects"], *truth["outside"])]
        print(truth["name"], truth["robot"], truth["motion"], kinds or "clean", flush=True)
