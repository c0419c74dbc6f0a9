"""What is simulated: a robot, the effects that act on it, and where they act.

A joint with a :class:`TransmissionLaw` is *soft*: its motor has a coordinate of its own, and the
transmission passes

    s = k z + k3 z^3 + d (dtheta - dq),   z = dead zone of (theta - q), ``gap`` to either side,

k3 zero but for a spring that hardens. Every other joint moves with its motor. Encoders sit on the motors, and
so do the laws: friction, ripple and rotor inertia see motor position and velocity as the encoders say them, the
rigid body sees the links. A :class:`BodyChange` changes the robot itself or sets it on springs, a
:class:`MeasurementLaw` changes what is measured.
"""

import dataclasses
from collections.abc import Iterable, Sequence
from functools import singledispatch
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.base import REGISTRY, Effect, get_law
from jaxswarm.effects.formula import formula_law
from jaxswarm.effects.kinds import (
    BodyChange,
    ExternalTorque,
    MeasurementLaw,
    TorqueLaw,
    TransmissionLaw,
)
from jaxswarm.effects.placement import moved_joint
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.errors import InputError
from jaxswarm.nodes import node
from jaxswarm.robot.model import Robot
from jaxswarm.simulate.soft_base import Base, base_of

FLANK_FREQUENCY = 100.0  # Hz, of a motor on the flank of a backlash whose stiffness is not given


# An effect in its place is a term of a model: what was identified can be simulated as it is.
Acting = Term


@node
@dataclasses.dataclass(frozen=True, eq=False)
class Plant:
    """A robot with the effects that act on it.

    Attributes:
        robot: The rigid body, global effects included.
        acting: The effects that are no part of the robot itself.
        width: (n,), width of every joint's smooth sign tanh(dq / width) in rad/s or m/s.
        base: The springs that it stands on; its turns follow the motors of the soft joints. None: it is firm.
    """

    robot: Robot
    acting: tuple[Acting, ...]
    width: jax.Array | np.ndarray
    base: Base | None = None

    @property
    def soft(self) -> tuple[int, ...]:
        """Joints whose motor moves apart from the link."""
        return tuple(sorted({a.joint for a in of_kind(self.acting, TransmissionLaw)}))

    @property
    def remembering(self) -> tuple[Any, ...]:
        """Effects with a state of their own, :class:`Acting`; their law is a torque's."""
        return tuple(a for a in of_kind(self.acting, TorqueLaw) if a.law.rate is not None)

    def transmissions(self, joint: int) -> list[Acting]:
        """Return what lies between motor and link of a joint."""
        return [a for a in of_kind(self.acting, TransmissionLaw) if a.joint == joint]

    def rotor(self, joint: int) -> Any:
        """Return the inertia on the motor's side of a joint [kg m^2 or kg], None if none is known."""
        for a in of_kind(self.acting, TorqueLaw):
            if a.law.motor_inertia and a.joint == joint:
                return a.values[a.law.motor_inertia]
        return None

    def robot_at(self, t: Any) -> Robot:
        """Return the robot with what its last link carries at a time [s]."""
        robot = self.robot
        for a in [a for a in of_kind(self.acting, BodyChange) if a.law.window]:
            body = a.law.weight(a.values, jnp.asarray(t, float)) * a.law.body(a.values)
            robot = robot.replace(parameters=jnp.asarray(robot.parameters).at[-1].add(body))
        return robot

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
            None) and ``values``: the terms of a model. Missing values
            are the law's nominal ones.
        width: Width of the smooth sign in rad/s or m/s, > 0, one for all joints or one each.

    Raises:
        InputError: If an effect is unknown or does not say where it acts, if a soft joint has no
            rotor inertia, or for an :class:`ExternalTorque`, which the simulation is given as numbers.

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
        formula = getattr(item, "formula", None)
        law = get_law(item.effect) if formula is None else formula_law(formula)
        unknown = set(item.values) - {p.name for p in law.parameters}
        if unknown:
            raise InputError(
                f"effect {law.name} has no parameter {', '.join(sorted(unknown))}: "
                f"use {', '.join(p.name for p in law.parameters)}."
            )
        values = {**law.nominal(), **item.values}
        joint, other = _place(item, law, robot)
        placed.append(Acting(law.name, joint, other, values, formula))
    plant = Plant(robot, (), np.broadcast_to(widths, (robot.num_joints,)))
    for acting in placed:
        plant = put_on(acting.law, plant, acting)
    for acting in of_kind(plant.acting, BodyChange):
        if acting.law.compliance is not None:
            plant = plant.replace(base=base_of(plant.robot, acting))
    _check_rotors(plant)
    return plant


def _place(item: Any, law: Effect, robot: Robot) -> tuple[int | None, int | None]:
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


@singledispatch
def put_on(law: Effect, plant: Plant, acting: Acting) -> Plant:
    """Return the plant with one more effect."""
    raise NotImplementedError(f"no plant for effects of kind {type(law).__name__}")


@put_on.register(TorqueLaw)
@put_on.register(TransmissionLaw)
@put_on.register(MeasurementLaw)
def _(law, plant, acting):
    return plant.replace(acting=(*plant.acting, acting))


@put_on.register
def _(law: BodyChange, plant, acting):
    robot = plant.robot
    if law.gravity is not None:
        gravity = law.gravity(acting.values, jnp.asarray(robot.gravity))
        return plant.replace(robot=robot.replace(gravity=_known(gravity)))
    if law.placement is not None:
        placed = moved_joint(robot, acting.joint, law.placement(acting.values))
        rotation, translation = (_known(x) for x in (placed.rotation, placed.translation))
        return plant.replace(robot=robot.replace(rotation=rotation, translation=translation))
    if law.window or law.compliance is not None:
        return plant.replace(acting=(*plant.acting, acting))
    assert law.body is not None  # one of the four, as its check sees to
    parameters = jnp.asarray(robot.parameters).at[-1].add(law.body(acting.values))
    return plant.replace(robot=robot.replace(parameters=_known(parameters)))


@put_on.register
def _(law: ExternalTorque, plant, acting):
    raise InputError(f"effect {law.name} is no part of a plant: pass its torque as external.")


def _known(array: jax.Array) -> Any:
    """Return a numpy array if the numbers are known, so that zeros can be folded away."""
    return array if isinstance(array, jax.core.Tracer) else np.asarray(array)


def _check_rotors(plant: Plant) -> None:
    known = [e.name for e in REGISTRY.values() if isinstance(e, TorqueLaw) and e.motor_inertia]
    for joint in plant.soft:
        rotor = plant.rotor(joint)
        if rotor is None or (isinstance(rotor, int | float) and not rotor > 0.0):
            raise InputError(
                f"{plant.robot.joints[joint]} is soft, so its motor moves by itself and needs an "
                f"inertia: add {' or '.join(known)} with a value above zero on that joint."
            )
