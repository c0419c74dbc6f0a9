"""Torques of the effects at one instant: what the motors spend besides moving the rigid body.

Laws are evaluated at zero acceleration; the ones that depend on acceleration (rotor inertia,
transmission coupling) do so linearly, and their derivative joins the mass matrix. Which do is read off
their traced program once. Everything is elementwise, so entries may be lanes.
"""

from collections.abc import Iterator
from functools import lru_cache
from itertools import islice
from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.effects.kinds import TorqueLaw, TransmissionLaw
from jaxswarm.effects.sample import Sample
from jaxswarm.effects.series import remembered
from jaxswarm.effects.term import of_kind
from jaxswarm.robot import spatial as sp
from jaxswarm.simulate.plant import FLANK_FREQUENCY, Acting, Plant


@lru_cache(maxsize=256)
def sample_fields(law: TorqueLaw) -> frozenset[str]:
    """Return the fields of a sample that a law's torque depends on.

    >>> from jaxswarm.effects import get_law
    >>> sorted(sample_fields(get_law("rotor_inertia")))
    ['ddq']
    """
    torque = law.torque
    assert torque is not None  # a law without one is not registered
    with jax.ensure_compile_time_eval():
        sample = Sample(*[jnp.ones(()) for _ in Sample._fields])
        sample = sample._replace(state=remembered(law, sample.state))
        values = {name: jnp.asarray(value, float) for name, value in law.nominal().items()}
    program = jax.make_jaxpr(lambda s: torque(values, s))(sample).jaxpr
    used = {id(v) for equation in program.eqns for v in equation.invars}
    used |= {id(v) for v in program.outvars}
    names = Sample(*Sample._fields)
    names = names._replace(state=remembered(law, names.state))
    pairs = zip(jax.tree.leaves(names), program.invars, strict=True)
    return frozenset(name for name, variable in pairs if id(variable) in used)


def sample_of(plant: Plant, acting: Acting, q, dq, t, temperature, **more) -> Sample:
    """Return the sample a law sees, at zero acceleration; q and dq are those of the motors."""
    j, other = acting.joint, acting.other
    like = jnp.zeros_like(dq[j])
    dq_other = like if other is None else dq[other]
    fields: dict[str, Any] = dict.fromkeys(Sample._fields, 0.0)
    fields.update(
        t=t,
        q=q[j],
        dq=dq[j],
        direction=jnp.tanh(dq[j] / plant.width[j]),
        temperature=temperature[j],
        q_other=like if other is None else q[other],
        dq_other=dq_other,
        direction_sum=jnp.tanh((dq[j] + dq_other) / plant.width[j]),
        direction_difference=jnp.tanh((dq[j] - dq_other) / plant.width[j]),
        **more,
    )
    return jax.tree.map(lambda value: like + value, Sample(**fields))


def own_memory(law: TorqueLaw, entries: Iterator[Any]) -> Any:
    """The next memory of all: an entry, or as many as a law with several has."""
    first = next(entries)
    return first if law.memories == 1 else (first, *islice(entries, law.memories - 1))


def effect_torques(
    plant: Plant, q, dq, memory, t, temperature, loads=None
) -> tuple[list[sp.Entry], list[tuple[int, int, Any]]]:
    """Return the torques of all laws at zero acceleration, and what they add to the mass matrix.

    Args:
        plant: The plant.
        q: n entries, motor positions.
        dq: n entries, motor velocities.
        memory: One entry for each memory of the effects of ``plant.remembering``.
        t: Time in s.
        temperature: n entries in deg C.
        loads: n pairs of entries, torque of the rigid body and its part without acceleration; with
            None laws that depend on load are left out.

    Returns:
        n entries in N m or N, and triples (joint, joint of the acceleration, inertia).
    """
    torques: list[sp.Entry] = [0.0] * plant.robot.num_joints
    inertias = []
    states = iter(memory)
    for acting in of_kind(plant.acting, TorqueLaw):
        law = acting.law
        state = own_memory(law, states) if law.rate is not None else 0.0
        fields = sample_fields(law)
        more = {"state": state}
        j = acting.joint
        if law.uses_load:
            if loads is None:
                continue
            more["load"], more["static_load"] = loads[j]
        sample = sample_of(plant, acting, q, dq, t, temperature, **more)
        if fields & {"ddq", "ddq_other"}:
            for name, index in (("ddq", j), ("ddq_other", acting.other)):
                if name in fields:
                    inertias.append((j, index, _slope(law, acting.values, sample, name)))
        if fields - {"ddq", "ddq_other"}:
            torques[j] = sp.plus(torques[j], law.torque(acting.values, sample))
    return torques, inertias


def _slope(law: TorqueLaw, values: dict, sample: Sample, name: str) -> jax.Array:
    """Derivative of a law's torque with respect to one field of its sample."""

    def torque(x):
        return law.torque(values, sample._replace(**{name: x}))

    x = getattr(sample, name)
    return jax.jvp(torque, (x,), (jnp.ones_like(x),))[1]


def transmission_torque(plant: Plant, joint: int, twist, twist_rate):
    """Torque a transmission passes from motor to link, for a twist theta - q and its rate."""
    held = [(a.law, a.values) for a in plant.transmissions(joint)]
    own = [(law, values) for law, values in held if isinstance(law, TransmissionLaw)]
    springs = [law.spring(values) for law, values in own if law.spring is not None]
    gap = sum((law.gap(values) for law, values in own if law.gap is not None), 0.0)
    if springs:
        k, d = springs[0]
    else:
        # A stiff, damped flank: the motor alone would swing on it at FLANK_FREQUENCY.
        frequency = 2.0 * jnp.pi * FLANK_FREQUENCY
        rotor = plant.rotor(joint)
        k, d = rotor * frequency**2, 0.4 * rotor * frequency
    hard = sum((law.hardening(values) for law, values in own if law.hardening is not None), 0.0)
    if isinstance(gap, float) and gap == 0.0:
        return (k + hard * twist**2) * twist + d * twist_rate
    into = jnp.sign(twist) * jnp.maximum(jnp.abs(twist) - gap, 0.0)
    # The damping fades in over a tenth of the gap: a force that jumps on contact would cost
    # the integrator its order.
    closed = jnp.minimum(jnp.abs(into) / (0.1 * gap), 1.0)
    return (k + hard * into**2) * into + d * closed * twist_rate
