"""Where the fit of a law begins that a search has found to first order."""

from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.effects.term import Term

# The second start of a gap, as a part of what was found to first order: on a world it was found twice too wide,
# and only from below half of that did the fit come to the true one.
_NARROW = 0.35
# Further starts of a speed, as parts of the one that was found with another shape than the usual one.
_LOWER = (0.5, 0.25)
# A spring whose torque is wanted more than so many times begins that much softer: neighbors on the lattice that
# it was tried on are 1.8 times as stiff as one another.
_MANY_TIMES = 1.8
# A start lies within this part of the way from neutral to the bounds: at a bound no step shows a slope.
_INSIDE = 0.95


def with_start(chosen: Score) -> Term:
    """The term with a first-order start of what its linearization found, away from the bounds.

    Of a law that goes by the load the linear values too: the load that goes with them is known from the first
    step on. Without them a drive that bent a torque to half its size was fitted at 3.7 times the noise.
    """
    term = chosen.candidate.term
    law, values = term.law, dict(term.values)
    moving = {p.name: p for p in (*law.free(values), *(law.linear if law.uses_load else ()))}
    for name, change in zip(law.candidate_names(()), chosen.coefficients, strict=False):
        if name in moving:
            p, neutral = moving[name], law.neutral()[name]
            low, high = (neutral + _INSIDE * (bound - neutral) for bound in (p.lower, p.upper))
            values[name] = float(np.clip(neutral + change, low, high))
    return replace(term, values=values)


def from_inside(fitted: Term) -> Term | None:
    """A term that was fitted, where it begins once more from usual values; None if none has run to a bound.

    Friction by the load of an upright axis follows its inertia alone, a part of which is the rotor's: the fit
    came to a share of 1.0 of it at 2.4 times the error that it leaves at 0.68.
    """
    shapes = fitted.law.free(fitted.values)
    at = {p.name: p.nominal for p in shapes if fitted.values[p.name] in (p.lower, p.upper)}
    return replace(fitted, values={**fitted.values, **at}) if at else None


def starts(term: Term, coefficients: np.ndarray) -> list[Term]:
    """Where a refit begins, the next one where it comes to nothing that can be.

    A spring whose torque was wanted many times over is that much softer: its lag is the torque over the
    stiffness, but near its resonance. One that stiffens as it winds up was wanted 43 times at 3e5 N m/rad;
    fitted from there it ended at 24,000, from a 43rd at 8,100 and left a tenth less.

    A gap seen too wide does not close by small steps, so it begins from a narrow one too. A speed that was
    found with another shape of a curve than the usual one may lie beyond where that one bends: it begins from
    lower ones too. Stribeck friction of a slide that was led slowly went to -87 N at 0.25 m/s and was refused.
    """
    law = term.law
    names: list[str] = []
    parts: tuple[float, ...] = ()
    if isinstance(law, TransmissionLaw) and law.gap is not None:
        names, parts = ["gap"], (_NARROW,)
    elif any(p.usual for p in law.parameters):
        names, parts = [p.name for p in law.free(term.values) if p.scale == "log"], _LOWER
    if isinstance(law, TransmissionLaw) and law.softer and coefficients[0] > _MANY_TIMES:
        limits = {p.name: (p.lower, p.upper) for p in law.parameters}
        softer = law.softer(term.values, float(coefficients[0]))
        inside = {n: float(np.clip(v, *limits[n])) for n, v in softer.items()}
        return [replace(term, values=inside), term]
    lower = ({n: part * term.values[n] for n in names} for part in parts if names)
    return [term, *(replace(term, values={**term.values, **values}) for values in lower)]
