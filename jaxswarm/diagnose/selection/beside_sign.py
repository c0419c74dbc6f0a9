"""Whether an encoder's error is told from the shape of its joint's dry friction about standstill."""

from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.folds.noise import noise_of
from jaxswarm.effects.alike import without
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.link_lag import excess_of
from jaxswarm.identify.forward.model import model_torque


def is_told_from_sign(found: Estimate, term: Term, least: float = Rules.over_noise) -> bool:
    """Whether an encoder's error is more than the shape of a sign: true of every other term.

    Dry friction turns over a width of the velocity, by a curve that no law knows. An error of the velocity that
    is within that width is such a curve, unless links, rotors or any other law go by it too. On a clean wrist
    whose friction is all its torque, a coupling ratio off by 0.0014 moved the velocity by 1.0 mrad/s, with a
    sign 1.9 mrad/s wide and torques in steps of a fifth of that friction: 0.002 N m through the sign, and
    0.000004 N m without it, were told with p = 1e-7.

    Args:
        found: The fit with the term.
        term: The term as it was fitted.
        least: RMS torque over its joint's noise from which on what has no sign tells it.
    """
    law = term.law
    if not isinstance(law, MeasurementLaw) or law.excess is None:
        return True
    along = [excess_of(term, m, term.values)[1] for m in found.motions]
    speed = np.sqrt(np.mean(np.square(np.concatenate(along))))
    # One that stands still turns no sign at all.
    if not 0.0 < speed <= found.model.width[term.index]:
        return True
    return bool((_without_sign(found, term) >= least * noise_of(found)).any())


def _without_sign(found: Estimate, term: Term) -> np.ndarray:
    """RMS torque (n,) that the term changes of all that does not go by a sign of velocity."""
    model = found.model
    plain = replace(model, terms=tuple(t for t in model.terms if not t.law.uses_direction))
    bare = replace(plain, terms=without(term, plain.terms))
    changed = [
        m.decimator.apply(model_torque(plain, m) - model_torque(bare, m)) for m in found.motions
    ]
    return found.regression.rms(found.regression.counted(np.concatenate(changed)))
