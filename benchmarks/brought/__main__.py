"""What people bring: robots against Pinocchio, logs in every format, pages in a browser.

    python -m benchmarks.brought [--urdfs FOLDER] [--pages REPORT.html ...] [--out FOLDER]

Without --urdfs the robots of installed packages are taken. More are in example-robot-data, icub-models,
rtb-data, dexmate-urdf, fourier-robot-descriptions and pybullet: pip install --no-deps --target FOLDER puts
them into a folder. Single bodies are not counted. Without --pages the demo makes one. --out keeps the pages'
pictures to be looked at.
"""

import argparse
import tempfile
from collections import Counter
from pathlib import Path

import jax

from benchmarks.brought import pages, urdfs, variants

NEEDS = ("pinocchio", "pyarrow", "rosbags", "h5py")
TAKES = "five minutes"


def logs_table() -> str:
    """How many variants ended how, and a row for each."""
    robot, log = variants.made()
    rows = []
    with tempfile.TemporaryDirectory() as place:
        for number, name in enumerate(variants.variants(log, Path(place))):
            folder = Path(place) / str(number)
            folder.mkdir()
            given = variants.variants(log, folder)[name]()
            rows.append(variants.outcome(name, given, robot, log))
    counts = Counter(row.outcome for row in rows)
    kinds = (variants.SAME, variants.TOLD, variants.REFUSED, variants.WRONG)
    lines = [
        f"{len(rows)} ways to write a log: " + ", ".join(f"{counts[k]} {k}" for k in kinds),
        "",
    ]
    lines += ["| log | outcome | said |", "|---|---|---|"]
    lines += [f"| {r.name} | {r.outcome} | {r.said[:110].replace('|', '/')} |" for r in rows]
    return "\n".join(lines)


def main() -> None:
    """Print three tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--urdfs", type=Path, help="folder of URDF files")
    parser.add_argument("--pages", type=Path, nargs="*", help="reports to look at")
    parser.add_argument("--out", type=Path, help="folder for pictures of the pages")
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    files = urdfs.installed() if options.urdfs is None else urdfs.below(options.urdfs)
    print(urdfs.table(files), flush=True)
    print(f"\n{logs_table()}\n", flush=True)
    with tempfile.TemporaryDirectory() as place:
        folder = options.out or Path(place)
        folder.mkdir(parents=True, exist_ok=True)
        shown = options.pages or [_demo(folder)]
        print(pages.table(shown, folder))


def _demo(folder: Path) -> Path:
    from jaxswarm.diagnose.demo import run_demo

    run_demo(0, folder / "demo", lambda text: None)
    return folder / "demo" / "report.html"


if __name__ == "__main__":
    main()
