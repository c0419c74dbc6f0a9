"""The kind of effects by which what is written down is not quite what was."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import jax

from jaxswarm.effects.base import Effect


@dataclass(frozen=True)
class MeasurementLaw(Effect):
    """How the drives and their clock write down a torque, or an encoder a position.

    Attributes:
        report: ``report(p, x, step)``: a torque x as it is written down, along the first axis, linear in
            x, unchanged for neutral parameters; ``step`` is the sampling interval [s]. A law of the whole
            arm sees (T, n, ...), one of a joint that joint's (T, ...), one that ``crosses`` its joint's and
            its partner's (T, 2, ...) and gives the first, (T, ...).
        alike: Whether a law of the whole arm does the same to every torque by itself, of whatever shape
            (T, ...): then a joint's is written down without the others.
        distortion: ``distortion(p, x)``: what is written down beside a true torque x [N m or N] of its joint,
            linear in the linear parameters; all others are shapes with a usual value; None: nothing.
        clock: Whether its one parameter is the time [s] by which the torque's clock lags.
        late: ``late(p)``: time [s] by which a slow torque is late, where it is no clock; None: not at all.
        excess: ``excess(p, q, q_other)``: what the encoder of its joint says too much [rad or m] where the
            joint is at q and the partner's encoder says q_other, zero for neutral parameters; None: encoders
            are true.
        slow: Whether it is a filter of one joint's torque. What was true is then what was written down with a
            multiple of its rate, however slow the filter is, and the measured torque tells the rate.
        scales: Whether it only scales the torque of its joint: the links that it moves may take that up.
    """

    report: Callable[[Mapping, jax.Array, float], jax.Array] = lambda p, x, step: x
    distortion: Callable[[Mapping, jax.Array], jax.Array] | None = None
    clock: bool = False
    late: Callable[[Mapping], float] | None = None
    excess: Callable[[Mapping, jax.Array, jax.Array], jax.Array] | None = None
    scales: bool = False
    slow: bool = False
    alike: bool = False

    @property
    def changes_rigid_columns(self) -> bool:
        """The links stand otherwise than their encoders say."""
        return self.excess is not None

    @property
    def crosses(self) -> bool:
        """Whether a torque is written down with that of a partner."""
        return self.scope == "pair" and self.excess is None

    @property
    def turn(self) -> int:
        """When it acts: what sensors pick up of other joints first, then each drive, then all of the arm."""
        return 0 if self.crosses else {"joint": 1, "pair": 1, "global": 2}[self.scope]

    @property
    def shows_on_own_joint(self) -> bool:
        """A wrong position turns the weight of all links beyond, a wrong scale their masses: others misfit.

        A gain of 1.3 of an elbow that is measured well was told as one of 1/1.3 of the shoulder.
        """
        return self.excess is None and not self.scales

    @property
    def positive(self) -> bool:
        """What can only grow from neutral has a positive coefficient."""
        first = self.parameters[0]
        return first.lower >= self.neutral()[first.name]

    def lateness(self, p: Mapping) -> float:
        """Time [s] by which a slow torque is written down late."""
        if self.clock:
            return p[self.parameters[0].name]
        return 0.0 if self.late is None else self.late(p)

    def candidate_names(self, joints: tuple[str, ...]) -> list[str]:
        """All parameters."""
        return [p.name for p in self.parameters]

    def credible(self, change: float, interval: float, doubt: float) -> bool:
        """Less than half a sample is no delay: a torque sampled and held is late by that much already.

        And what is beyond its bound is neither a clock's nor picked up of another joint.
        """
        if not (self.clock or self.crosses):
            return True
        seen = not self.clock or abs(change) - doubt > 0.5 * interval
        return seen and abs(change) < self.parameters[0].upper

    def check(self) -> None:
        """Refuse a law that reports nothing, of a pair, or with parameters that are not searched."""
        super().check()
        if self.linear and not self.distortion:
            raise ValueError(
                f"effect {self.name!r} is a measurement: it needs a distortion, or no linear parameter"
            )
        if self.crosses and self.report is MeasurementLaw.report:
            raise ValueError(
                f"effect {self.name!r} is of a pair: it needs an excess, or a report of both torques"
            )
        shapes = all(p.usual or not p.fitted for p in self.nonlinear)
        bent = self.scope == "joint" and self.uses_load and shapes
        if self.distortion is not None and not bent:
            raise ValueError(
                f"effect {self.name!r} distorts a torque: it needs scope 'joint', uses_load=True, and no "
                "nonlinear parameters but shapes that are usually the same"
            )
        if self.excess is not None and self.scope == "global":
            raise ValueError(
                f"effect {self.name!r} is of an encoder: its scope is 'joint' or 'pair'"
            )
        if self.clock and (self.scope != "global" or len(self.parameters) != 1):
            raise ValueError(f"effect {self.name!r} is a clock: one parameter, scope 'global'")
