"""A named number of an effect, with its unit, its bounds, and how a search walks between them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np


class Unit(str):
    """A unit for a revolute joint that has another one on a slide than its angles say.

    An order of waves counts periods a turn, but a slide has no turns; the phase of a wave is an angle on both.

    >>> Unit("1", "1/m"), Unit("1", "1/m").sliding
    ('1', '1/m')
    """

    sliding: str

    def __new__(cls, revolute: str, sliding: str) -> "Unit":
        """The unit on a revolute joint, and on a slide."""
        unit = super().__new__(cls, revolute)
        unit.sliding = sliding
        return unit

    def __reduce__(self) -> tuple[type, tuple[str, str]]:
        """What makes it anew in another process: results of a fleet hold units."""
        return Unit, (str(self), self.sliding)


# The phase of a wave, and how often it repeats over the travel of a joint.
PHASE, ORDER = Unit("rad", "rad"), Unit("1", "1/m")


@dataclass(frozen=True)
class Parameter:
    """One named parameter of an effect.

    Attributes:
        name: Short symbol, unique within the effect.
        unit: Unit for a revolute joint, for example ``"N m s/rad"``.
        lower, upper: Physical bounds; a linear friction coefficient has ``lower = 0``.
        linear: Whether a torque is linear in it (and in all linear parameters together).
        nominal: A usual value: default in simulations, and where a search starts.
        scale: ``"linear"`` or ``"log"``: how a search should walk between the bounds.
        description: One clause that says what it is.
        fitted: Whether a fit may move it; a choice stays what it was set to.
        neutral: Value at which the effect does nothing; None: the nominal one, zero of a linear one.
        hidden_by: Another parameter that leaves this one undetermined unless it is zero.
        shown_by: Linear parameters without each of which it does nothing: where one is not told from zero, the
            fit has put this one where noise is explained best, and no standard error tells how far that is off.
        usual: Whether nearly all arms have its nominal value: it stays at that unless a log tells another, and
            that is what a model has which does not name it. A linear one is fitted like others.
        lies: ``"place"`` or ``"width"`` on the way of the joint: a search looks for it among the positions
            seen; ``"torque"``: a choice, the largest one of the joint; None: anywhere between its bounds.
        another_at: Bounds, ``"lower"`` or ``"upper"``, at which the law is another one: a fit that has run
            there has not found it.
    """

    name: str
    unit: str
    lower: float
    upper: float
    linear: bool
    nominal: float
    description: str
    scale: str = "linear"
    fitted: bool = True
    neutral: float | None = None
    hidden_by: str = ""
    shown_by: tuple[str, ...] = ()
    usual: bool = False
    lies: str | None = None
    another_at: tuple[str, ...] = ()

    @property
    def off(self) -> float:
        """Value at which the effect does nothing."""
        if self.linear:
            return 0.0
        return self.nominal if self.neutral is None else self.neutral

    def check(self, effect: str, names: Sequence[str]) -> None:
        """Refuse a declaration that contradicts itself.

        Args:
            effect: Name of the effect it is one of.
            names: Of all its parameters.

        Raises:
            ValueError: If another one has its name, its bounds are empty, its scale is unknown or cannot hold
                them, or it refers to a parameter that the effect does not have.
        """
        whose = f"effect {effect!r}"
        if names.count(self.name) > 1:
            raise ValueError(f"{whose} has two parameters named {self.name!r}")
        if not self.lower < self.upper or not self.lower <= self.nominal <= self.upper:
            raise ValueError(
                f"{whose}, parameter {self.name!r}: needs lower < upper and a nominal "
                f"value between them, got {self.lower}, {self.upper}, {self.nominal}"
            )
        if self.scale not in ("linear", "log") or (self.scale == "log" and not self.lower > 0.0):
            raise ValueError(
                f"{whose}, parameter {self.name!r}: scale is {self.scale!r} with a lower "
                f"bound of {self.lower}; use 'linear', or 'log' with a bound above zero"
            )
        refuse_unknown(effect, names, self.hidden_by, *self.shown_by)

    def decode(self, u):
        """Value at a position u in [0, 1] between the bounds, on the parameter's scale.

        >>> Parameter("k", "1", 1.0, 100.0, False, 5.0, "any", "log").decode(0.5)
        10.0
        """
        if self.scale == "log":
            return self.lower * (self.upper / self.lower) ** u
        return self.lower + u * (self.upper - self.lower)

    def encode(self, value: float) -> float:
        """Position of a value, the inverse of :meth:`decode`."""
        if self.scale == "log":
            return float(np.log(value / self.lower) / np.log(self.upper / self.lower))
        return float((value - self.lower) / (self.upper - self.lower))

    def slope(self, value: float) -> float:
        """Derivative of the value by the position."""
        if self.scale == "log":
            return float(value * np.log(self.upper / self.lower))
        return float(self.upper - self.lower)


def refuse_unknown(effect: str, names: Sequence[str], *told: str | None) -> None:
    """Refuse names of parameters that an effect refers to and does not have; of nothing none.

    >>> refuse_unknown("friction_change", ["fc", "t0"], "T0")
    Traceback (most recent call last):
    ValueError: effect 'friction_change' refers to a parameter 'T0'; it has 'fc', 't0'
    """
    for name in told:
        if name and name not in names:
            known = ", ".join(map(repr, names))
            raise ValueError(f"effect {effect!r} refers to a parameter {name!r}; it has {known}")


def assumed(parameters: Iterable[Parameter]) -> dict[str, float]:
    """What a model that does not name them has: choices, and shapes that are usually the same.

    >>> c = Parameter("c", "1", 0.0, 1.0, True, 0.1, "fall")
    >>> assumed([c, Parameter("n", "1", 0.5, 4.0, False, 1.0, "exponent", usual=True)])
    {'n': 1.0}
    """
    return {p.name: p.nominal for p in parameters if p.usual or not p.fitted}


# When something changes for good. Within half a second nothing does: it is there from the start.
CHANGE = Parameter(
    *("t0", "s", 0.5, 1e4, False, 10.0, "time of the change", "log"), another_at=("lower",)
)

# Over how long something warms. Within a second nothing does: that is how a log begins.
WARMING = Parameter(
    *("tc", "s", 1.0, 1e4, False, 30.0, "time constant of warming", "log"), another_at=("lower",)
)
