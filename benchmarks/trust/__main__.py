"""Is nothing crashed, silent or lost by hostile inputs, by faults, and by logs that are spoiled or say nothing?

    python -m benchmarks.trust fuzz|faults|spoiled|null|determinism [--table] [--inputs N] ...

``fuzz``: files and options spoiled by structure, read in process (``--inputs``), and whole commands
(``--commands``): nothing but success or a clear refusal, in time, in bounded memory, with nothing written.
``faults``: commands killed at random moments, ended by signals, out of disk, two in one folder (``--kills``).
``spoiled``: logs of clean arms and of arms that lack a law, spoiled in one way: is it said before a fit
(``--arms``), else by a diagnosis without a wrong effect (``--judged``)?
``null``: clean logs, and torques permuted over time or joints: is nothing added (``--arms``)?
``determinism``: the same commands in other folders, with other hash seeds, threads, cores, devices and caches:
the same bytes?
Rows go to ``benchmarks/results/trust_*.jsonl``; what is there is not done again. ``--table`` shows all of them.
"""

import argparse
import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: see jaxswarm.cli

import jax

NEEDS = ("rosbags", "mujoco", "pyarrow")
TAKES = "fuzz 30 minutes, faults 40, spoiled 30 and null 20 on one core; with smaller numbers less"


def main() -> None:
    """Run one part, or show the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "part", choices=("fuzz", "faults", "spoiled", "null", "determinism"), nargs="?"
    )
    parser.add_argument("--inputs", type=int, default=10_000, help="fuzz: inputs in process")
    parser.add_argument("--commands", type=int, default=50, help="fuzz: whole commands")
    parser.add_argument("--kills", type=int, default=30, help="faults: kill -9 at random moments")
    parser.add_argument("--arms", type=int, default=3, help="spoiled, null: clean arms")
    parser.add_argument("--first", type=int, default=0, help="spoiled: number of the first arm")
    parser.add_argument(
        "--judged", type=int, default=1, help="spoiled: arms that are diagnosed, too"
    )
    parser.add_argument("--table", action="store_true", help="show what was found so far")
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    if options.part == "fuzz":
        from benchmarks.trust.commands import run_commands
        from benchmarks.trust.fuzz import fuzz

        # First the commands: they are copies of this process, and inputs may start a device, whose threads no
        # copy would have. Three of 31 commands after 2000 inputs stood still until their time was up.
        run_commands(options.commands)
        fuzz(options.inputs)
    if options.part == "faults":
        from benchmarks.trust.faults import faults

        faults(options.kills)
    if options.part == "spoiled":
        from benchmarks.trust.spoiled import spoiled

        spoiled(options.arms, options.judged, options.first)
    if options.part == "null":
        from benchmarks.trust.null import null

        null(options.arms)
    if options.part == "determinism":
        from benchmarks.trust.determinism import determinism

        determinism()
    if options.table or options.part is None:
        from benchmarks.trust.table import table

        print(table())


if __name__ == "__main__":
    main()
