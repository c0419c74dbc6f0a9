"""Whether a law that was fitted can be what it says, and is needed."""

from jaxswarm.diagnose.decision.rules import NEEDED
from jaxswarm.diagnose.selection.beside_sign import is_told_from_sign
from jaxswarm.diagnose.selection.load_size import is_no_larger_than_its_arm
from jaxswarm.diagnose.selection.tenable import (
    can_be,
    can_be_as_wrong,
    can_be_resolved,
    can_swing,
    goes_beyond,
    is_certain,
    is_itself,
    stands_for_itself,
)
from jaxswarm.effects.alike import number_of
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate


def holds(after: Estimate, term: Term, fall: float, beyond: bool) -> bool:
    """Whether a fitted term can be, and is needed for the fall of the squared error of its joint.

    ``beyond``: whether its own log has to tell it from nothing and from those that it contains, or others do.
    """
    number = number_of(term, after.model.terms)
    fitted, errors = after.model.terms[number], after.std_errors[number]
    physical = can_be(fitted, errors)
    physical = physical and stands_for_itself(fitted, errors)
    physical = physical and (not beyond or goes_beyond(fitted, errors))
    physical = physical and can_swing(after, fitted) and can_be_as_wrong(fitted)
    physical = physical and can_be_resolved(after, fitted, errors) and is_itself(fitted)
    physical = physical and is_told_from_sign(after, fitted)
    physical = physical and is_no_larger_than_its_arm(after, fitted, errors)
    # A coefficient may be uncertain beside those it is confounded with, and the law still be needed.
    return physical and (not beyond or is_certain(fitted, errors) or fall > NEEDED)
