"""The embedded default: an RX60 log with an undeclared effect, diagnosed, and only then the truth."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from jaxswarm import outputs
from jaxswarm.diagnose.report.orders import order_pictures
from jaxswarm.diagnose.run import conclude, write_report
from jaxswarm.diagnose.selection.stepwise import diagnose
from jaxswarm.drawing import Drawing
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import rx60


def run_demo(
    seed: int, out: Path | None, progress: Callable[[str], None] = lambda text: None
) -> tuple[dict, dict]:
    """Make a log, run the loop on it, and compare with the truth.

    Args:
        seed: Draws arm, motion, noise and the undeclared effect.
        out: Folder for the report; None: nothing is written.
        progress: Called with one line per stage.

    Returns:
        The content of ``diagnosis.json`` and the truth (effect, joint, values).
    """
    if out is not None:
        outputs.check_folder(out)
    progress("making a log")
    arm, declared, hidden = demo_case(rx60(), seed)
    log = synthetic_log(arm, (*declared, *hidden), seed)
    unseen = synthetic_log(arm, (*declared, *hidden), seed + 10_000)
    blank = tuple(replace(t, values={}) for t in declared)
    with Drawing() as drawing:
        found = diagnose(rx60(), blank, [prepare(log)], seed=seed, progress=progress)
        validation = [prepare(unseen, found.final.model.filtering)]
        shown = None if out is None else order_pictures(drawing, found, validation)
        result, left = conclude(found, validation, seed, progress)
        result["logs"] = []
        if out is not None:
            write_report(found, left, result, drawing, out, progress, shown=shown)
    term = hidden[0]
    truth = {
        "effect": term.effect,
        "joint": None if term.joint is None else arm.joints[term.joint],
        "values": term.values,
    }
    return result, truth
