"""The command ``python -m benchmarks.diagnosis worlds``."""

import argparse
from pathlib import Path

from benchmarks.worlds.files import write_world
from benchmarks.worlds.world import make_world


def numbers(text: str) -> list[int]:
    """``7``, ``0-12`` or ``3,5,20-25`` as numbers of worlds."""
    chosen: list[int] = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        chosen += range(int(first), int(last or first) + 1)
    return chosen


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.diagnosis worlds", description=__doc__
    )
    parser.add_argument("--write", default="", help="numbers of worlds to write, such as 3,10-20")
    parser.add_argument("--out", type=Path, default=Path("worlds"), help="folder for --write")
    options = parser.parse_args(arguments)
    for number in numbers(options.write) if options.write else ():
        truth = write_world(make_world(number), options.out / f"w{number:04d}")
        kinds = [e["effect"] for e in (*truth["effects"], *truth["outside"])]
        print(truth["name"], truth["robot"], truth["motion"], kinds or "clean", flush=True)
