"""Whether fitted values are those of the law they are told of, by physics and by their own doubt."""

from collections.abc import Iterator, Mapping

import numpy as np
import scipy

from jaxswarm.diagnose.decision.rules import BEYOND_CHANCE, CERTAIN, MOST_DAMPING
from jaxswarm.effects import get_law
from jaxswarm.effects.base import Effect
from jaxswarm.effects.kinds import (
    BodyChange,
    ExternalTorque,
    MeasurementLaw,
    TorqueLaw,
    TransmissionLaw,
)
from jaxswarm.effects.parameter import Parameter
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.body import arm_of
from jaxswarm.identify.forward.sensitivity import sensitivity_of


def can_be(term: Term, errors: dict[str, float]) -> bool:
    """Whether linear coefficients are within their physical bounds, or beyond by chance beside one that is.

    A short log knows badly how viscous friction in one direction is: below zero by 2.4 standard errors it hid
    Coulomb friction that was three times as large in that direction. Chance is held at the bound in the end.
    """
    linear = term.law.linear
    within = any(_beyond(term, p) <= 0.0 for p in linear)
    return not linear or (within and within_chance(term, errors))


def within_chance(term: Term, errors: dict[str, float]) -> bool:
    """Whether no linear coefficient is beyond a physical bound by more than chance."""
    return all(
        _beyond(term, p) <= BEYOND_CHANCE * np.nan_to_num(errors[p.name]) for p in term.law.linear
    )


def is_within(term: Term) -> bool:
    """Whether every linear coefficient is within its physical bounds."""
    return all(_beyond(term, p) <= 0.0 for p in term.law.linear)


def _beyond(term: Term, parameter: Parameter) -> float:
    """By how much a value is beyond its bounds; below zero within them."""
    value = term.values[parameter.name]
    return max(parameter.lower - value, value - parameter.upper)


def is_certain(term: Term, errors: dict[str, float], least: float = CERTAIN) -> bool:
    """Whether a coefficient is certain, by so many standard errors: else it stands for another one.

    Transmissions have none: it is their stiffness or gap, of which no error says nothing. A gap of
    0.003 +- 0.005 rad stood in the headline beside a law that no catalog holds.
    """
    law = term.law
    if isinstance(law, TransmissionLaw):
        return _one_is_certain(term, errors, {law.parameters[0].name: 0.0}, least)
    if isinstance(law, ExternalTorque):
        held = {p.name for p in law.parameters}
        torques = [name for name in term.values if name not in held]
        return _one_is_certain(term, errors, dict.fromkeys(torques, 0.0), least)
    if law.linear:
        return _one_is_certain(
            term, errors, dict.fromkeys((p.name for p in law.linear), 0.0), least
        )
    if isinstance(law, MeasurementLaw | BodyChange):
        return _one_is_certain(term, errors, law.neutral(), least)
    return True


def stands_for_itself(term: Term, errors: dict[str, float]) -> bool:
    """Whether a law whose candidate was told from another one only to second order is not that other one."""
    neutral = term.law.neutral()
    return all(
        abs(term.values[name] - neutral[name]) > CERTAIN * errors[name] for name in term.law.probe
    )


def goes_beyond(term: Term, errors: dict[str, float]) -> bool:
    """Whether a law that contains others is certain in one of the coefficients that these have not.

    A constant torque was told as a cable with 0.04 +- 0.1 N/m from the other joint, which a second log
    preferred by a twentieth while its other stiffness was below zero. What these contain counts, too: one was
    told as a spring of 0.2 +- 0.2 N m/rad with a slack part, which contains a spring, which contains it.
    """
    linear = [p.name for p in term.law.linear]
    for inner in _within(term.law):
        own = {name: 0.0 for name in linear if name not in inner}
        if own and not _one_is_certain(term, errors, own):
            return False
    return True


def _within(law: Effect) -> Iterator[set[str]]:
    """Names of the parameters of what a law contains, together, and of what each of these contains."""
    if law.contains:
        laws = [get_law(name) for name in law.contains]
        yield {p.name for one in laws for p in one.parameters}
        for one in laws:
            yield from _within(one)


def _one_is_certain(
    term: Term, errors: dict[str, float], neutral: Mapping[str, float], least: float = CERTAIN
) -> bool:
    """Whether one of some coefficients is beyond its doubt from where it does nothing, or told by no doubt.

    One that is held where it does nothing is none of them. Each of k others has a k-th of the chance to be so
    by accident that one alone has: of the ten numbers of a load that nobody carried one was 2.1 standard
    errors from zero.
    """
    change = {name: abs(term.values[name] - zero) for name, zero in neutral.items()}
    free = [name for name in neutral if change[name] > 0.0 or not np.isnan(errors[name])]
    certain = -scipy.special.ndtri(scipy.special.ndtr(-least) / max(len(free), 1))
    return any(change[name] > certain * errors[name] or np.isnan(errors[name]) for name in free)


def can_be_as_wrong(term: Term) -> bool:
    """Whether a sensor, a clock or a base can be as wrong as a term says: true of every other term.

    One that wants to be worse than its law allows is not what is wrong: friction in a wrist whose drives run
    through each other was told as a coupling ratio that is off by its bound, the bristles of four slow joints
    of a clean arm as a clock that is late by its bound of 50 ms, a spring on the second link of a level arm as
    a base that is tilted by its bound of 3 m/s^2 both ways.
    """
    law = term.law
    read = isinstance(law, MeasurementLaw) and (law.excess is not None or law.clock or law.crosses)
    stands = isinstance(law, BodyChange) and law.changes_rigid_columns
    if not (read or stands):
        return True
    return all(p.lower < term.values[p.name] < p.upper for p in law.parameters)


def can_be_resolved(found: Estimate, term: Term, errors: dict[str, float]) -> bool:
    """Whether a law with a memory forgets over a way that the logs tell from none: true of every other term.

    A bristle that winds up by less is dry friction that holds a joint at rest. On a clean arm with encoders of
    15 bits one of 0.1 mrad, half a count and the least there is, was told as hysteresis, on another one of 0.15
    +- 0.05 mrad.
    """
    law = term.law
    if not isinstance(law, TorqueLaw) or not law.forgets or term.joint is None:
        return True
    way = next(p for p in law.parameters if p.name == law.forgets)
    noise = (m.position_noise for m in found.motions)
    told = max((float(x[term.joint]) for x in noise if x is not None), default=0.0)
    doubt = CERTAIN * np.nan_to_num(errors[way.name])
    return bool(term.values[way.name] > max(way.lower + doubt, CERTAIN * told))


def winds_up(term: Term) -> bool:
    """Whether a law with a memory forgets over more than the least way there is: true of every other term."""
    law = term.law
    if not isinstance(law, TorqueLaw) or not law.forgets:
        return True
    way = next(p for p in law.parameters if p.name == law.forgets)
    return term.values[way.name] > way.lower


def is_itself(term: Term) -> bool:
    """Whether no value has run to a bound at which its law is another one.

    On a measured arm of ten seconds friction of 3700 N m, four times its joint's torque, was told to vanish
    within the first one: that is how the log begins. On another one a linear spring was told as a cubic one
    about a point that lies a whole travel beyond all positions.
    """
    ends = ((p, term.values[p.name]) for p in term.law.nonlinear if p.another_at)
    return not any(
        ("lower" in p.another_at and value <= p.lower)
        or ("upper" in p.another_at and value >= p.upper)
        for p, value in ends
    )


def can_swing(found: Estimate, term: Term) -> bool:
    """Whether a fitted transmission with a spring is one: true of every other term.

    Gears and belts are damped far below the critical damping of their link. A fit beyond it has found no
    swinging link but a lag, and its stiffness and inertia mean nothing on other motion.
    """
    law = term.law
    if not isinstance(law, TransmissionLaw) or law.spring is None or law.gap is not None:
        return True
    pi = np.asarray(found.model.robot.parameters).ravel()
    arm = arm_of(found.model.robot, found.model.terms)
    inertia = np.median(
        [
            np.median(np.abs(sensitivity_of(arm, m, term.index, r).inertia(pi)))
            for m, r in zip(found.motions, found.rigids, strict=True)
        ]
    )
    k, d = law.spring(term.values)
    ratio = d / (2.0 * np.sqrt(k * inertia))
    return bool(ratio <= MOST_DAMPING)


def unphysical_beside(before: Estimate, after: Estimate, term: Term) -> bool:
    """Whether a law drives another one of its joint beyond its physical bounds, or further, whatever chance.

    An eddy brake was told as Stribeck friction beside a Coulomb level of -38 N: a bent curve, no law. What the
    log wanted beyond its bounds before goes further where it moves by more than its doubt was then: viscous
    friction of -1.6 was driven to -4.1 by a quadratic drag, which gave 7 N m on motion ten times as fast, where
    Stribeck friction left less and brought it back. What comes nearer to its bounds is not driven, though it is
    known better by that: viscous friction of -0.43 +- 0.21 was -0.34 +- 0.05 beside a drift that took 96 % off
    its joint's squared error, for a coupling that was still to be found.
    """
    former = _room_beside(before, term)
    for key, (room, doubt) in _room_beside(after, term).items():
        was, known = former.get(key, (0.0, 0.0))
        if room < (was - known if was < -known else min(was, -doubt)):
            return True
    return False


def _room_beside(found: Estimate, term: Term) -> dict[tuple, tuple[float, float]]:
    """What the other terms of a term's joint have above their lower bounds, and what of it may be chance."""
    rows = zip(found.model.terms, found.std_errors, strict=True)
    return {
        (t.identity, p.name): (t.values[p.name] - p.lower, BEYOND_CHANCE * errors[p.name])
        for t, errors in rows
        if t.joint == term.joint and t.place != term.place
        for p in t.law.linear
    }
