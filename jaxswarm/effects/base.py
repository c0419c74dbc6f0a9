r"""What an effect is: one law, one table of its parameters, and the registry that knows them all.

A rigid body does not account for everything a motor must supply. Whatever else there is enters as a
sum, ``tau = rigid body + sum of laws``; friction has the sign of the velocity. A :class:`Law` is

* ``torque(p, s)``: the torque [N m or N] one joint needs on top, for one sample ``s`` (a
  :class:`Sample` of scalars) and a dictionary ``p`` of parameters; a *global* law sees a sample of
  ``(n,)`` arrays and returns ``(n,)``;
* ``rate(p, s)``, only for a law with memory: the time derivative of its scalar ``s.state``;
* a table of :class:`Parameter`: names, units, bounds, and which ones enter linearly.

Everything else follows from these: columns of a regression (the derivative with respect to the linear
parameters), the search box of the others, units in the report, the name on the command line. Some
effects are no added torque but another motion or another clock (a soft joint, a delay, a tilted base);
those carry ``warp`` instead, see :mod:`jaxswarm.effects.warps`.

Registering a law with :func:`register` makes it known everywhere.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError, nearest


class Sample(NamedTuple):
    """What a joint law sees at one instant: scalars of its own joint, and of a partner joint.

    Attributes:
        t: Time since the start of the log [s].
        q: Position [rad or m].
        dq: Velocity [rad/s or m/s].
        ddq: Acceleration [rad/s^2 or m/s^2].
        direction: Smooth sign of ``dq`` in [-1, 1], ``tanh(dq / width)`` with the declared width.
        load: Torque of the rigid-body model on this joint [N m or N]; never the measured torque.
        static_load: The same without its inertial part: gravity, Coriolis and centrifugal torque.
        temperature: Temperature channel [deg C], NaN where the log has none.
        dq_other, ddq_other: Velocity and acceleration of the partner joint of a coupling law.
        direction_sum: Smooth sign of ``dq + dq_other``, the way a motor driven by both joints turns.
        state: The law's own memory, zero for laws without.
    """

    t: jax.Array
    q: jax.Array
    dq: jax.Array
    ddq: jax.Array
    direction: jax.Array
    load: jax.Array
    static_load: jax.Array
    temperature: jax.Array
    dq_other: jax.Array
    ddq_other: jax.Array
    direction_sum: jax.Array
    state: jax.Array


def make_sample(**fields) -> Sample:
    """Build a :class:`Sample` with zero for every field that is not given.

    >>> float(make_sample(dq=0.5).dq), float(make_sample(dq=0.5).load)
    (0.5, 0.0)
    """
    zero = jnp.zeros_like(jnp.asarray(next(iter(fields.values()), 0.0), dtype=float))
    values = {name: jnp.asarray(fields.pop(name, zero), dtype=float) for name in Sample._fields}
    if fields:
        raise ValueError(f"unknown sample fields {sorted(fields)}; known: {Sample._fields}")
    return Sample(**values)


@dataclass(frozen=True)
class Parameter:
    """One named parameter of a law.

    Attributes:
        name: Short symbol, unique within the law.
        unit: Unit for a revolute joint, for example ``"N m s/rad"``.
        lower, upper: Physical bounds; a linear friction coefficient has ``lower = 0``.
        linear: Whether the law's torque is linear in it (and in all linear parameters together).
        nominal: A usual value: default in simulations, and where a search starts.
        scale: ``"linear"`` or ``"log"``: how a search should walk between the bounds.
        description: One clause that says what it is.
        fitted: Whether a fit may move it; a choice stays what it was set to.
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


@dataclass(frozen=True)
class Law:
    """A physical effect as a pure function with a table of its parameters (see the module text).

    Attributes:
        name: Name in reports, logs of changes and on the command line.
        scope: ``"joint"``, ``"pair"`` (a joint and a partner joint) or ``"global"``.
        parameters: The table; linear ones first.
        summary: The law in one line, with its formula.
        reference: Where the law comes from.
        torque: ``torque(p, sample) -> scalar``; None for a law that is a warp.
        rate: ``rate(p, sample) -> d state / dt``; None for a law without memory.
        warp: Name of the warp (:mod:`jaxswarm.effects.warps`), None for an added torque.
        uses_direction: Whether the torque depends on the smooth sign of a velocity.
        uses_load: Whether it depends on the rigid torque, whose parameters are being fitted.
        dissipative: Whether ``dq * torque >= 0`` for every allowed parameter.
        reference_only: Whether it shows only against an earlier model or on part of a log, so that
            one fit to whole logs cannot hold it.
        derived: ``derived(p) -> {name: (value, unit)}``: other usual ways to state the parameters.
        requires: Channels of the log it needs beside motion and torque, by name.
        recurring: Whether it is an event of one log with a start and an end, of which there may be
            several, and not a property of the robot.
    """

    name: str
    scope: str
    parameters: tuple[Parameter, ...]
    summary: str
    reference: str
    torque: Callable[[dict, Sample], jax.Array] | None = None
    rate: Callable[[dict, Sample], jax.Array] | None = None
    warp: str | None = None
    uses_direction: bool = False
    uses_load: bool = False
    dissipative: bool = False
    reference_only: bool = False
    derived: Callable[[dict], dict] | None = None
    requires: tuple[str, ...] = ()
    recurring: bool = False

    @property
    def linear(self) -> tuple[Parameter, ...]:
        """The parameters in which the torque is linear."""
        return tuple(p for p in self.parameters if p.linear)

    @property
    def nonlinear(self) -> tuple[Parameter, ...]:
        """The parameters that have to be searched."""
        return tuple(p for p in self.parameters if not p.linear)

    def nominal(self) -> dict[str, float]:
        """Return the usual value of every parameter."""
        return {p.name: p.nominal for p in self.parameters}


REGISTRY: dict[str, Law] = {}


def register(law: Law) -> Law:
    """Make ``law`` known to every part of jaxswarm under its name, and return it.

    Raises:
        ValueError: If the name is taken or :func:`check_law` refuses the law.
    """
    if law.name in REGISTRY:
        raise ValueError(f"an effect named {law.name!r} is registered already; choose another name")
    check_law(law)
    REGISTRY[law.name] = law
    return law


def check_law(law: Law) -> None:
    """Refuse a law whose declaration contradicts itself.

    Raises:
        ValueError: If the scope is unknown, it is neither torque nor warp or both, a parameter's name
            is taken, its bounds are empty or its scale unknown, or linear parameters do not come first.
    """
    if law.scope not in ("joint", "pair", "global"):
        raise ValueError(f"scope of {law.name!r} is {law.scope!r}; use 'joint', 'pair' or 'global'")
    if (law.torque is None) == (law.warp is None):
        raise ValueError(f"effect {law.name!r} needs exactly one of torque and warp")
    flags = [p.linear for p in law.parameters]
    if flags != sorted(flags, reverse=True):
        raise ValueError(f"effect {law.name!r}: list its linear parameters first")
    names = [p.name for p in law.parameters]
    for p in law.parameters:
        if names.count(p.name) > 1:
            raise ValueError(f"effect {law.name!r} has two parameters named {p.name!r}")
        if not p.lower < p.upper or not p.lower <= p.nominal <= p.upper:
            raise ValueError(
                f"effect {law.name!r}, parameter {p.name!r}: needs lower < upper and a nominal value "
                f"between them, got {p.lower}, {p.upper}, {p.nominal}"
            )
        if p.scale not in ("linear", "log") or (p.scale == "log" and not p.lower > 0.0):
            raise ValueError(
                f"effect {law.name!r}, parameter {p.name!r}: scale is {p.scale!r} with a lower bound "
                f"of {p.lower}; use 'linear', or 'log' with a bound above zero"
            )


def get_law(name: str) -> Law:
    """Return the registered law called ``name``.

    Raises:
        InputError: If there is none, with the nearest names.

    >>> get_law("viscous_friction").scope
    'joint'
    """
    if name not in REGISTRY:
        raise InputError(f"unknown effect {name!r}. {nearest(name, REGISTRY)}")
    return REGISTRY[name]
