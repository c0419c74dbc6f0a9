"""What a law sees of a motion at one instant."""

from typing import Generic, NamedTuple, TypeVar

import jax.numpy as jnp

# Arrays of NumPy along a log, of JAX within a program.
A = TypeVar("A")


class Sample(NamedTuple, Generic[A]):
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
        direction_sum, direction_difference: Smooth signs of ``dq + dq_other`` and ``dq - dq_other``, the way a
            motor driven by both joints turns.
        state: The law's own memory, zero for laws without; a tuple for laws with several.
        q_other: Position of the partner joint of a coupling law.
    """

    t: A
    q: A
    dq: A
    ddq: A
    direction: A
    load: A
    static_load: A
    temperature: A
    dq_other: A
    ddq_other: A
    direction_sum: A
    direction_difference: A
    state: A
    q_other: A


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
