"""What encoders say of a motion, and what the motion is that they say.

Without a :class:`MeasurementLaw` that moves a position the two are one. An excess is a function of where its
joint is and of what its partner says. Each of what is said and what is follows from the other by a few
rounds of substitution: each shrinks the error by the slope of the excess, which is small.
"""

import jax
import jax.numpy as jnp

from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.misreading import ROUNDS
from jaxswarm.effects.term import of_kind
from jaxswarm.simulate.plant import Plant


def true_motion(plant: Plant, q: jax.Array, dq: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return true positions and velocities (n,) where encoders say q, dq (n,)."""
    if not _wrong(plant):
        return q, dq

    def true(said):
        found = list(said)
        for _ in range(ROUNDS):
            found = _moved(plant, list(said), found, list(said), -1.0)
        return jnp.stack([jnp.broadcast_to(x, said[0].shape) for x in found])

    return jax.jvp(true, (q,), (dq,))


def said_motion(plant: Plant, *motion: list) -> list[list]:
    """Return positions, velocities and, where given, accelerations (n entries each) as encoders say them."""
    if not _wrong(plant):
        return list(motion)

    # What is said follows from what is, but for partners that are misread themselves.
    wrong = _wrong(plant)
    chained = {a.other for a in wrong} & {a.joint for a in wrong}
    rounds = ROUNDS if chained else 1

    def along(s):
        true = [
            sum(x * s**k / (1, 1, 2)[k] for k, x in enumerate(own))
            for own in zip(*motion, strict=True)
        ]
        said = true
        for _ in range(rounds):
            said = _moved(plant, true, true, said, 1.0)
        return said

    told, rate = [along(0.0)], along
    for _ in motion[1:]:
        rate = jax.jacfwd(rate)
        told.append(rate(0.0))
    return told


def _wrong(plant: Plant) -> list:
    return [a for a in of_kind(plant.acting, MeasurementLaw) if a.law.excess is not None]


def _moved(plant: Plant, base: list, true: list, said: list, sign: float) -> list:
    """``base`` and ``sign`` times what encoders say too much at ``true`` where all say ``said``, n entries."""
    moved = list(base)
    for a in _wrong(plant):
        partner = said[a.joint if a.other is None else a.other]
        moved[a.joint] = moved[a.joint] + sign * a.law.excess(a.values, true[a.joint], partner)
    return moved
