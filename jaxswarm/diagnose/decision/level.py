"""By which level a candidate passes: among all that were asked, or among its like alone."""

from collections.abc import Callable, Sequence

from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.worth import Score, is_no_chance, passes
from jaxswarm.effects import get_law
from jaxswarm.effects.base import Effect
from jaxswarm.effects.term import Term

# Whether a score passes.
Tested = Callable[[Score], bool]


def level_of(scores: Sequence[Score], rules: Rules, added: Sequence[Term] = ()) -> Tested:
    """How scores of a round are tested, and those of the same candidates made otherwise.

    A law that extends one that was ``added`` is asked with its like alone. That something is missing is proven;
    whether it is more than was added is another question, with as many chances as there are such laws. A filter
    of 17 ms told as a delay took 0.36 more off a joint at p = 0.003, and 24 standard errors once fitted.

    One that may be what was added, read otherwise, is no effect of its own and need not be as large as one:
    which of both it is the fit says (:func:`jaxswarm.diagnose.selection.readings.why_not`). A filter of 8 ms
    told as a delay took 0.16 more off a joint at p = 6e-6, of 0.2 that an effect has to take.
    """
    places = {t.place for t in added}

    def further(s: Score) -> bool:
        return any(place in places for place in extended_by(s.candidate.term))

    count = sum(map(further, scores))

    def tested(s: Score) -> bool:
        if not further(s):
            return passes(s, len(scores), rules)
        term = s.candidate.term
        read = any(reads_otherwise(term.law, t.effect) for t in added if t.joint == term.joint)
        return (is_no_chance if read else passes)(s, count, rules)

    return tested


def extended_by(term: Term) -> list[tuple]:
    """Places of the laws that a law extends."""
    return [(name, term.joint, term.other) for name in term.law.extends]


def reads_otherwise(law: Effect, name: str) -> bool:
    """Whether a law may be all that an effect of this name was taken for, by as few numbers.

    It contains that effect, and usually has none of it: a filter is late without a delay.

    >>> reads_otherwise(get_law("torque_lag"), "time_delay")
    True
    >>> reads_otherwise(get_law("lugre_friction"), "hysteresis")
    False
    """
    if name not in law.extends or name not in law.contains:
        return False
    usual = {p.name for p in law.parameters if p.usual}
    return {p.name for p in get_law(name).parameters} <= usual
