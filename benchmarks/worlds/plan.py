"""What world ``k`` is about: clean, one, two or three undeclared effects, or a law no catalog holds.

Of thirteen worlds in a row five are clean, four have one effect, one has two, one has two or three, one has
three or an effect beside a common lack of friction, one has a law from outside the catalog. Kinds follow
in turn, so that every stretch of numbers holds all of them alike.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.worlds.laws import INSIDE, OUTSIDE, STRUCTURAL

ROUND, CLEAN = 13, 5
DECLARED = ("nothing", "friction", "friction and rotors")
_FRICTION = ("viscous_friction", "coulomb_friction")
# Laws on top of a friction that is declared.
_ON_FRICTION = (
    "stribeck_friction",
    "asymmetric_friction",
    "thermal_drift",
    "position_dependent_friction",
    "friction_change",
    "dwell_friction",
)
# What softness and backlash need to be told from the inertia of the motor.
_NEED_ROTORS = ("joint_elasticity", "backlash")


@dataclass(frozen=True)
class Plan:
    """Kinds of the undeclared effects, and what the user declares.

    ``common``: nothing is declared though every joint has viscous and Coulomb friction, so that these
    are undeclared too.
    """

    kinds: tuple[str, ...]
    declared: str
    common: bool


def plan(number: int, rng: np.random.Generator) -> Plan:
    """The plan of world ``number``; ``rng`` draws what its number does not fix."""
    turn, place = divmod(number, ROUND)
    if place < CLEAN:
        return Plan((), str(rng.choice(DECLARED, p=[0.2, 0.4, 0.4])), False)
    if place < CLEAN + 4:
        kinds = (INSIDE[(4 * turn + place - CLEAN) % len(INSIDE)],)
    elif place == ROUND - 1:
        kinds = (OUTSIDE[turn % len(OUTSIDE)],)
    else:
        count = (2, int(rng.integers(2, 4)), int(rng.choice([1, 3])))[place - CLEAN - 4]
        kinds = _several(rng, count)
        if count == 1:
            return Plan(_plain(kinds), "nothing", True)
    if any(k in _NEED_ROTORS for k in kinds):
        return Plan(kinds, DECLARED[2], False)
    if "rotor_inertia" in kinds:
        return Plan(kinds, DECLARED[1], False)
    if any(k in _ON_FRICTION for k in kinds):
        return Plan(kinds, str(rng.choice(DECLARED[1:])), False)
    return Plan(kinds, str(rng.choice(DECLARED, p=[0.15, 0.4, 0.45])), False)


def _several(rng, count):
    """Different kinds, at most one of them structural."""
    kinds: list[str] = []
    while len(kinds) < count:
        kind = str(rng.choice(INSIDE))
        structural = kind in STRUCTURAL and any(k in STRUCTURAL for k in kinds)
        clash = kind == "rotor_inertia" and any(k in _NEED_ROTORS for k in kinds)
        clash |= kind in _NEED_ROTORS and "rotor_inertia" in kinds
        if kind not in kinds and not structural and not clash:
            kinds.append(kind)
    return tuple(kinds)


def _plain(kinds):
    """A kind that can stand beside friction that nobody declared."""
    bad = (*_FRICTION, *_NEED_ROTORS, "asymmetric_friction", "rotor_inertia")
    return ("stribeck_friction",) if kinds[0] in bad else kinds
