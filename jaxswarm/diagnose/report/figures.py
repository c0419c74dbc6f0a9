"""The pictures of a diagnosis: the ladder of errors, and the evidence for each effect."""

from matplotlib.figure import Figure

from jaxswarm import loop_plots
from jaxswarm.diagnose.report.shown import evidence_shown, ladder_shown
from jaxswarm.diagnose.selection.step import Addition
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Motion


def evidence(step: Addition, final: Model, motion: Motion) -> Figure:
    """Partial residual of an effect on a log: what the others leave, and what the effect says of it."""
    return loop_plots.evidence(*evidence_shown(step, final, motion))


def ladder(result: dict) -> Figure:
    """Error of every joint on unseen motion, before and after each added effect."""
    return loop_plots.ladder(*ladder_shown(result))
