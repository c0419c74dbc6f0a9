"""Effects that change the body: its gravity, what it carries, where its joints are, what it stands on."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import jax
import jax.numpy as jnp

from jaxswarm.effects.base import Effect
from jaxswarm.effects.ramp import ramp


@dataclass(frozen=True)
class BodyChange(Effect):
    """Another gravity or another rigid body.

    Attributes:
        gravity: ``gravity(p, gravity) -> gravity`` [m/s^2], (3,).
        body: ``body(p) -> (10,)``: inertial parameters added to the last link, its ten parameters in
            their standard order.
        placement: ``placement(p) -> (2, 2)``: shift [m] of a joint in its parent along two directions across
            its own axis, and turns [rad] about them, the first of which lies across its parent's axis too.
        compliance: ``compliance(p) -> (2,)``: turns of the base about its x and y axes per moment that it
            holds there [rad/(N m)].
        swing: Parameters of a compliance: the frequencies [Hz] at which the arm swings on its base about
            either axis, at its upper bound one that is none beside the motion, and the damping ratio.
        window: Whether the body is carried between the times ``start`` and ``end`` [s] of one log only, told
            by the parameter ``log`` from zero; then its inertial parameters are linear.
    """

    gravity: Callable[[Mapping, jax.Array], jax.Array] | None = None
    body: Callable[[Mapping], jax.Array] | None = None
    placement: Callable[[Mapping], jax.Array] | None = None
    compliance: Callable[[Mapping], jax.Array] | None = None
    swing: tuple[str, str, str] | None = None
    window: bool = False

    @property
    def shows_on_own_joint(self) -> bool:
        """A joint that sits elsewhere is felt by those before it as well."""
        return False

    @property
    def changes_rigid_columns(self) -> bool:
        """They depend on gravity and geometry, not on the links' parameters."""
        return self.gravity is not None or self.placement is not None

    def free(self, values: Mapping[str, float]) -> tuple:
        """A body is found in one linear step, but for when it was carried; a swing that shows moves, too."""
        if self.swing is not None:
            moving = self.swinging(values)
            return tuple(p for p in self.nonlinear if p.name in moving)
        return () if self.body is not None and not self.window else super().free(values)

    def silent(self, values: Mapping[str, float]) -> tuple[str, ...]:
        """Those of a swing that does not show."""
        shown = self.swinging(values)
        return tuple(name for name in self.swing or () if name not in shown)

    def swinging(self, values: Mapping[str, float]) -> tuple[str, ...]:
        """Parameters of the swing that show: frequencies below their upper bounds, and the damping of such."""
        if self.swing is None:
            return ()
        *often, damping = self.swing
        most = {p.name: p.upper for p in self.nonlinear}
        slow = [name for name in often if values.get(name, most[name]) < most[name]]
        return (*slow, damping) if slow else ()

    def candidate_names(self, joints: tuple[str, ...]) -> list[str]:
        """All parameters of the body or the gravity."""
        return [p.name for p in (self.linear or self.parameters)]

    def weight(self, p: Mapping, t: jax.Array) -> jax.Array:
        """How much of the body is carried at times t: all of it, but outside of its window."""
        if not self.window:
            return jnp.ones_like(t)
        return ramp(t, p["start"]) * (1.0 - ramp(t, p["end"]))

    def check(self) -> None:
        """Refuse a change of nothing, of several things, or of a single joint's gravity or body."""
        super().check()
        ways = (self.gravity, self.body, self.placement, self.compliance)
        told = [x for x in ways if x is not None]
        linear = self.window or self.compliance is not None
        scope = "global" if self.placement is None else "joint"
        if self.scope != scope or len(told) != 1 or bool(self.linear) != linear:
            raise ValueError(
                f"effect {self.name!r} is a change of the body: it needs exactly one of gravity, body, "
                "placement and compliance, scope 'global' ('joint' for a placement), and linear parameters "
                "for a body in a window and a compliance only"
            )
        own = len(self.linear or self.parameters)
        if self.body is not None and not (self.reference_only and own == 10):
            raise ValueError(
                f"effect {self.name!r} adds to the last link, which every fit finds as a whole: it needs "
                "reference_only=True and ten inertial parameters"
            )
