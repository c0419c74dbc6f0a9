"""The five kinds of effects, by where in the measuring chain they act.

A link moves behind its motor (:class:`TransmissionLaw`), as a body in a gravity (:class:`BodyChange`); the
motor supplies torques of its own (:class:`TorqueLaw`) and those that the surroundings exert
(:class:`ExternalTorque`); what is written down of all this is not quite what was (:class:`MeasurementLaw`).
Identification, diagnosis and simulation dispatch on these classes.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np

from jaxswarm.effects.base import Effect
from jaxswarm.effects.body_change import BodyChange as BodyChange
from jaxswarm.effects.deflection import contact_stiffness
from jaxswarm.effects.measurement_law import MeasurementLaw as MeasurementLaw
from jaxswarm.effects.parameter import refuse_unknown
from jaxswarm.effects.sample import Sample


@dataclass(frozen=True)
class TorqueLaw(Effect):
    """A torque the motor has to supply on one joint, as a function of what that joint does.

    Attributes:
        torque: ``torque(p, sample) -> scalar`` [N m or N] for one :class:`Sample` of scalars and a
            dictionary of parameters; friction has the sign of the velocity.
        rate: ``rate(p, sample) -> d state / dt`` of its memory, the scalar ``sample.state``; None: none.
        memories: How many scalars it remembers; of several, ``sample.state`` and ``rate`` are tuples.
        most: Size beyond which no memory goes: an element that slips stays as far as it can be bent.
        start: ``start(p, sample) -> state`` at the begin of a log; None: zero.
        forgets: Parameter over whose travel [rad or m] the state forgets what it was before the log.
        tone: Nonlinear parameter that is a frequency of time [Hz]: it is read off a spectrum, not searched.
        dissipative: Whether ``dq * torque >= 0`` for every allowed parameter.
        motor_inertia: Linear parameter that is an inertia on the motor's side of the transmission.
        exchanged: ``exchanged(p) -> p`` with its two parts in each other's place; None: it has no such parts.
    """

    torque: Callable[[dict, Sample], jax.Array] | None = None
    rate: Callable[[dict, Sample], Any] | None = None
    memories: int = 1
    most: float = np.inf
    start: Callable[[dict, Sample], jax.Array] | None = None
    forgets: str = ""
    tone: str = ""
    dissipative: bool = False
    motor_inertia: str = ""
    exchanged: Callable[[Mapping], dict[str, float]] | None = None

    @property
    def searched(self) -> bool:
        """Whether there are nonlinear parameters, and no spectrum that shows them."""
        return bool(self.nonlinear) and not self.tone

    def check(self) -> None:
        """Refuse a law without a torque, or one of the whole arm."""
        super().check()
        if self.torque is None:
            raise ValueError(f"effect {self.name!r} needs a torque")
        names = [p.name for p in self.parameters]
        refuse_unknown(self.name, names, self.forgets, self.motor_inertia)
        if self.tone and not {self.tone, "log"} <= {p.name for p in self.nonlinear}:
            raise ValueError(
                f"effect {self.name!r} has a tone: it needs nonlinear parameters {self.tone!r} and 'log'"
            )
        if self.memories > 1 and (self.rate is None or self.start is not None):
            raise ValueError(
                f"effect {self.name!r} has {self.memories} memories: it needs a rate, and they start at zero"
            )
        if self.scope == "global":
            raise ValueError(f"effect {self.name!r} is a torque: its scope is 'joint' or 'pair'")


@dataclass(frozen=True)
class TransmissionLaw(Effect):
    """A link that lags behind its motor, where the encoder is; one a joint.

    Attributes:
        spring: ``spring(p) -> (k, d)``: stiffness and damping [N m/rad, N m s/rad]; None: the gear is as
            stiff as its parameter ``flank`` says, the frequency [Hz] at which the link swings on it.
        hardening: ``hardening(p)``: what the spring gains on the cube of its twist [N m/rad^3]; None: nothing.
        gap: ``gap(p)``: dead zone to either side [rad]; None: there is none. A law with one has the
            parameters ``gap``, ``flank`` and ``blur``, the time [s] over which its lag is averaged.
        lattice: ``lattice(inertia) -> [values, ...]``: what to try on a joint of this inertia [kg m^2].
        around: ``around(inertia, k, twist) -> [values, ...]``: of a law that extends others, what to try in
            place of a lattice: the lag that they give the link has the root mean square ``twist`` [rad], and
            its torque the root mean square ``k twist``.
        softer: ``softer(values, times) -> values``: those of a spring that gives way so many times as far.
    """

    spring: Callable[[Mapping], tuple] | None = None
    hardening: Callable[[Mapping], jax.Array] | None = None
    gap: Callable[[Mapping], jax.Array] | None = None
    lattice: Callable[[float], list[dict[str, float]]] | None = None
    around: Callable[[float, float, float], list[dict[str, float]]] | None = None
    softer: Callable[[Mapping, float], dict[str, float]] | None = None

    @property
    def positive(self) -> bool:
        """A lag takes off what it explains with its own sign only."""
        return True

    @property
    def changes_rigid_columns(self) -> bool:
        """The links move otherwise than the motors."""
        return True

    def gear(self, p: Mapping, inertia: jax.Array | np.ndarray) -> tuple[jax.Array, ...]:
        """Stiffness, damping, gap and hardening where the link's inertia is (T,)."""
        if self.spring is None:
            k, d = contact_stiffness(inertia, p["flank"])
        else:
            k, d = self.spring(p)
        ways = (0.0 * k if way is None else way(p) for way in (self.gap, self.hardening))
        return k, d, *ways

    def excludes(self, other: Effect) -> bool:
        """One transmission a joint, for a dead zone has a spring on its flanks; but one may extend another."""
        own = isinstance(other, TransmissionLaw) and other.name not in self.extends
        return own or super().excludes(other)

    def check(self) -> None:
        """Refuse a transmission that is not fully described."""
        super().check()
        names = {p.name for p in self.parameters}
        needed = set() if self.gap is None else {"gap", "flank", "blur"}
        needed |= set() if self.spring else {"flank"}
        tried = self.around if self.extends else self.lattice
        if self.scope != "joint" or tried is None or self.linear or not needed <= names:
            raise ValueError(
                f"effect {self.name!r} is a transmission: it needs scope 'joint', a lattice (what is around "
                f"the law it extends, if it does), no linear parameter, and {sorted(needed)} among its "
                "parameters"
            )


def _constant(phase: np.ndarray) -> np.ndarray:
    return np.ones_like(phase)


@dataclass(frozen=True)
class ExternalTorque(Effect):
    """A torque of the surroundings on all joints between the times ``start`` and ``end`` [s] of a log.

    How large it is on each joint is linear; it has a value ``tau_<joint>`` of its own. Its log is told by
    the parameter ``log``, from zero.

    Attributes:
        profile: ``profile(phase) -> (T,)``: its course over the window, phase in [0, 1].
    """

    recurring: bool = True
    reference_only: bool = True
    identity: tuple[str, ...] = ("log", "start")
    profile: Callable[[np.ndarray], np.ndarray] = _constant

    def weight(self, p: Mapping, t: np.ndarray) -> np.ndarray:
        """Its course at times t (T,), zero outside the window."""
        phase = (t - p["start"]) / max(p["end"] - p["start"], 1e-12)
        inside = (t >= p["start"]) & (t <= p["end"])
        return np.where(inside, self.profile(np.clip(phase, 0.0, 1.0)), 0.0)

    def free(self, values: Mapping[str, float]) -> tuple:
        """The window stays where it was found."""
        return ()

    def linear_names(self, joints: tuple[str, ...]) -> list[str]:
        """A torque for every joint."""
        return [f"tau_{joint}" for joint in joints]

    def check(self) -> None:
        """Refuse a torque without a window."""
        super().check()
        needed = {"log", "start", "end"}
        if self.scope != "global" or not needed <= {p.name for p in self.nonlinear}:
            raise ValueError(
                f"effect {self.name!r} is an external torque: it needs scope 'global' and the nonlinear "
                "parameters log, start and end"
            )
