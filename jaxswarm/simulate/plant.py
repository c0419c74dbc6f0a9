"""What is simulated: a robot, the effects that act on it, and where they act.

A joint with ``joint_elasticity`` or ``backlash`` is *soft*: its motor has a coordinate of its own, and
the transmission passes

    s = k z + d (dtheta - dq),   z = dead zone of (theta - q), ``gap`` to either side.

Every other joint moves with its motor. Encoders sit on the motors, and so do the laws: friction,
ripple and rotor inertia see motor position and velocity, the rigid body sees the links. Effects that
are another gravity or another body change the robot itself; gain and delay change what is measured.
"""

import dataclasses
from collections.abc import Iterable, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.base import Law, get_law
from jaxswarm.effects.warps import LAGGING
from jaxswarm.errors import InputError
from jaxswarm.robot.model import Robot

MEASURED = ("gain", "delay")
PLAY_FREQUENCY = 100.0  # Hz, of a motor on the flank of a backlash whose stiffness is not given


@jax.tree_util.register_dataclass
@dataclasses.dataclass(frozen=True, eq=False)
class Acting:
    """One effect in its place.

    Attributes:
        effect: Registered name.
        joint: Index of its joint, None for a global effect.
        other: Index of the partner joint of a pair effect, else None.
        values: Parameter values by name.
    """

    effect: str = dataclasses.field(metadata={"static": True})
    joint: int | None = dataclasses.field(default=None, metadata={"static": True})
    other: int | None = dataclasses.field(default=None, metadata={"static": True})
    values: dict[str, Any] = dataclasses.field(default_factory=dict)

    @property
    def law(self) -> Law:
        """The registered law."""
        return get_law(self.effect)


@jax.tree_util.register_dataclass
@dataclasses.dataclass(frozen=True, eq=False)
class Plant:
    """A robot with the effects that act on it.

    Attributes:
        robot: The rigid body, global effects included.
        acting: The effects with a torque of their own, then warps of single joints.
        width: (n,), width of every joint's smooth sign tanh(dq / width) in rad/s or m/s.
    """

    robot: Robot
    acting: tuple[Acting, ...]
    width: jax.Array

    @property
    def soft(self) -> tuple[int, ...]:
        """Joints whose motor moves apart from the link."""
        return tuple(sorted({a.joint for a in self.acting if a.law.warp in LAGGING}))

    @property
    def remembering(self) -> tuple[Acting, ...]:
        """Effects with a state of their own."""
        return tuple(a for a in self.acting if a.law.rate is not None)

    def value(self, joint: int, effect: str, name: str, default: Any = None) -> Any:
        """Return a parameter of the effect on this joint, or the default."""
        for a in self.acting:
            if a.effect == effect and a.joint == joint:
                return a.values[name]
        return default

    def replace(self, **changes) -> "Plant":
        """Return a copy with fields replaced."""
        return dataclasses.replace(self, **changes)


def make_plant(
    robot: Robot, effects: Iterable[Any] = (), *, width: float | Sequence[float] = 0.01
) -> Plant:
    """Put effects on a robot.

    Args:
        robot: The rigid body.
        effects: Objects with the attributes ``effect`` (name), ``joint``, ``other`` (index or
            None) and ``values``; :class:`Acting` or the terms of an identified model. Missing values
            are the law's nominal ones.
        width: Width of the smooth sign in rad/s or m/s, > 0, one for all joints or one each.

    Raises:
        InputError: If an effect is unknown or does not say where it acts, if a soft joint has no
            rotor inertia, or for ``contact``, which is an external torque of the simulation.

    >>> from jaxswarm.robot import rx60
    >>> make_plant(rx60(), [Acting("viscous_friction", 0, values={"b": 2.0})]).soft
    ()
    """
    widths = np.asarray(width, float)
    if widths.shape not in ((), (robot.num_joints,)) or not (widths > 0.0).all():
        raise InputError(
            f"width of the smooth sign is {width}: give a positive speed in rad/s, or one a joint."
        )
    placed = []
    for item in effects:
        law = get_law(item.effect)
        unknown = set(item.values) - {p.name for p in law.parameters}
        if unknown:
            raise InputError(
                f"effect {law.name} has no parameter {', '.join(sorted(unknown))}: "
                f"use {', '.join(p.name for p in law.parameters)}."
            )
        values = {**law.nominal(), **item.values}
        joint, other = _place(item, law, robot)
        placed.append(Acting(law.name, joint, other, values))
    for acting in placed:
        if acting.law.scope == "global":
            robot = _changed_robot(robot, acting)
    local = tuple(a for a in placed if a.law.scope != "global" or a.law.warp == "delay")
    plant = Plant(robot, local, np.broadcast_to(widths, (robot.num_joints,)))
    _check_rotors(plant)
    return plant


def _place(item: Any, law: Law, robot: Robot) -> tuple[int | None, int | None]:
    joint, other = item.joint, item.other
    if (law.scope == "global") != (joint is None):
        where = "acts on the whole arm" if law.scope == "global" else "needs a joint"
        raise InputError(f"effect {law.name} {where}: joint is {joint!r}.")
    if (law.scope == "pair") != (other is not None):
        raise InputError(f"effect {law.name} needs a partner joint exactly if it couples two.")
    for index in (joint, other):
        if index is not None and not 0 <= index < robot.num_joints:
            raise InputError(
                f"effect {law.name}: joint index {index} is outside 0..{robot.num_joints - 1}."
            )
    return joint, other


def _changed_robot(robot: Robot, acting: Acting) -> Robot:
    """Return the robot with another gravity or a body on its last link."""
    values, warp = acting.values, acting.law.warp
    if warp == "gravity":
        gravity = jnp.asarray(robot.gravity)
        across = jnp.stack([jnp.asarray(values["gx"]), jnp.asarray(values["gy"])])
        down = jnp.sqrt(jnp.sum(gravity**2) - jnp.sum(across**2))
        tilted = jnp.concatenate([across, (jnp.where(gravity[2] > 0, 1.0, -1.0) * down)[None]])
        return robot.replace(gravity=_known(tilted))
    if warp == "payload":
        load = jnp.stack([jnp.asarray(values[p.name], float) for p in acting.law.parameters])
        parameters = jnp.asarray(robot.parameters)
        return robot.replace(parameters=_known(parameters.at[-1].add(load)))
    if warp == "window":
        raise InputError(
            f"effect {acting.effect} is no part of a plant: pass its torque as external."
        )
    return robot


def _known(array: jax.Array) -> Any:
    """Return a numpy array if the numbers are known, so that zeros can be folded away."""
    return array if isinstance(array, jax.core.Tracer) else np.asarray(array)


def _check_rotors(plant: Plant) -> None:
    for joint in plant.soft:
        rotor = plant.value(joint, "rotor_inertia", "ia")
        if rotor is None or (isinstance(rotor, int | float) and not rotor > 0.0):
            raise InputError(
                f"{plant.robot.joints[joint]} is soft, so its motor moves by itself and needs an "
                "inertia: add rotor_inertia with ia > 0 on that joint."
            )
