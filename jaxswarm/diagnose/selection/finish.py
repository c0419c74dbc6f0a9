"""The outcome of a selection fitted to the end: its clocks, the widths of its signs, its bounds."""

from collections.abc import Callable

from jaxswarm.diagnose.selection.as_declared import keep_declared_widths
from jaxswarm.diagnose.selection.clock import settle_clocks
from jaxswarm.diagnose.selection.doubt_of_motion import with_doubt_of_motion
from jaxswarm.diagnose.selection.from_declared import fit_from_declared
from jaxswarm.diagnose.selection.readings import with_readings
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.sticking import settle_signs
from jaxswarm.diagnose.selection.take_back import take_back_idle, take_back_nothing
from jaxswarm.diagnose.selection.within_bounds import within_bounds
from jaxswarm.identify.estimation.estimate import Estimate


def finish(search: Search, alone: Callable[[], Estimate]) -> None:
    """Fit the model of a selection that is over to the end.

    Args:
        search: With everything added.
        alone: Gives the fit of the declared model.
    """
    while search.steps or search.sticking:
        settle_clocks(search)  # also after a delay was taken back that is one of the clocks
        fit_from_declared(search, alone)
        settle_signs(search, alone)
        if take_back_idle(search):
            continue
        _hold_within_bounds(search)
        if not take_back_nothing(search):
            with_readings(search)
            keep_declared_widths(search, alone)
            search.current = with_doubt_of_motion(search.current, search.seed)
            return
    _as_identified(search, alone())


def _as_identified(search: Search, found: Estimate) -> None:
    """Where nothing is added, the model is the one that ``identify`` fits: with its clocks, within its bounds.

    Clocks found among candidates differ from these by a part of their doubt, which was a sixth of a joint's
    error on other motion of a world.
    """
    search.go_on(found)
    search.declared = search.current


def _hold_within_bounds(search: Search) -> None:
    held = within_bounds(search.current)
    if held is not search.current:
        search.go_on(held)
