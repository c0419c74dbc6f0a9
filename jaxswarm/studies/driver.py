"""What both studies have in common: check the folder, run, draw, and write JSON, page and pictures."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure

from jaxswarm import outputs, plots

Progress = Callable[[str], None]


def silent(text: str) -> None:
    """A progress function that tells nobody."""


class Study(NamedTuple):
    """A paper's experiment and how to show it.

    Attributes:
        name: As on the command line; names the JSON.
        reconstructions: What the paper does not say and the study had to choose, in sentences.
        experiment: ``(fast, seed, progress) -> (content, figures)``: the content of the JSON, and a
            function that draws the pictures by file name (called only if they are written).
        findings: The sentences made from the content.
        render: ``(content, PNGs by name) -> HTML``.
    """

    name: str
    reconstructions: tuple[str, ...]
    experiment: Callable[[bool, int, Progress], tuple[dict, Callable[[], dict[str, Figure]]]]
    findings: Callable[[dict], list[str]]
    render: Callable[[dict, dict[str, bytes]], str]


def run_study(
    study: Study,
    out: Path | str | None,
    fast: bool = False,
    seed: int = 0,
    progress: Progress = silent,
) -> dict:
    """Run a study and write ``<name>.json``, ``report.html`` and the pictures.

    Args:
        study: The study.
        out: Folder for the results; None: nothing is drawn or written.
        fast: Passed to the experiment: fewer runs and variants.
        seed: Passed to the experiment: draws noise and searches.
        progress: Called with one line per stage.

    Returns:
        The content of the JSON.

    Raises:
        InputError: If the folder cannot be written; told before any work is done.
    """
    if out is not None:
        outputs.check_folder(Path(out))
    start = time.perf_counter()
    content, figures = study.experiment(fast, seed, progress)
    result = {
        "study": study.name,
        "fast": fast,
        "seed": seed,
        "reconstructions": list(study.reconstructions),
        **content,
    }
    result["findings"] = study.findings(result)
    result["seconds"] = time.perf_counter() - start
    if out is not None:
        progress("writing the report")
        images = {name: plots.png_bytes(figure) for name, figure in figures().items()}
        files: dict[str, outputs.Content] = {
            f"{study.name}.json": outputs.to_json(result),
            "report.html": study.render(result, images),
        }
        outputs.write_results(Path(out), {**files, **images})
    return result
