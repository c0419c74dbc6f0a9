"""Whether a load that was picked up or put down is a body that the arm could carry."""

import numpy as np

from jaxswarm.diagnose.decision.rules import CERTAIN
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate

# Radius of gyration of the largest load about the last joint, over the length of all links: that of a rod
# nearly as long, held at its end.
_RADIUS = 0.5


def is_no_larger_than_its_arm(found: Estimate, term: Term, errors: dict[str, float]) -> bool:
    """Whether a load for a while is no larger than the arm that carries it: true of every other term.

    About the last joint a load of mass m has first moments of at most :math:`m R`, and inertias of its mass's
    sign and of at most :math:`m R^2`, R half the length of all links, but for chance. A push of one second by a
    force that kept its direction was told as 6 kg that were put down meanwhile, with 1.3 and 1.8 kg m^2 on an
    arm of 0.6 m: what it did to the joints followed the arm's posture, as a weight does.
    """
    law = term.law
    if not isinstance(law, BodyChange) or law.body is None or not law.window:
        return True
    doubt = {name: CERTAIN * float(np.nan_to_num(error)) for name, error in errors.items()}
    mass, radius = abs(term.values["m"]) + doubt["m"], _RADIUS * found.model.robot.length
    way = np.sign(term.values["m"])
    moments = all(
        abs(term.values[name]) <= mass * radius + doubt[name] for name in ("mcx", "mcy", "mcz")
    )
    inertias = all(
        -doubt[name] <= way * term.values[name] <= mass * radius**2 + doubt[name]
        for name in ("Ixx", "Iyy", "Izz")
    )
    return moments and inertias
