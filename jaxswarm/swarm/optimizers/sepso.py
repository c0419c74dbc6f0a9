r"""Social emotional particle swarm optimization (SEPSO): three named reconstructions.

The paper that names SEPSO is known only up to the point where its rule would begin, and no copy of
it was found. What stands here is RECONSTRUCTED from the optimization algorithm it builds on and
must be cited as such. Every particle has an emotion index b in [0, 1]: 1 after improving its own
best, else it falls by 0.05 a step. With R = sum over the L = 3 worst particles of (x_w - x):

R1 (default): the velocity of PSO with three behaviors, thresholds 0.3 and 0.6
    b < 0.3           v = w v                 + c2 r2 (g - x)
    0.3 <= b < 0.6    v = w v + c1 r1 (p - x) + c2 r2 (g - x) - c3 r3 R / L
    b >= 0.6          v = w v + c1 r1 (p - x)                 - c3 r3 R / L
R2: all terms kept, gains scaled by emotion
    v = w v + c1 b r1 (p - x) + c2 (1 - b) r2 (g - x) - c3 r3 R / L
    b rises or falls by the stimulus S = k ln(1 + |f - f_ref| / s0) (Weber-Fechner), with f_ref the
    particle's own best before this step, s0 the mean of |f - f_ref| over the swarm and k = 0.05
R3: social emotional optimization to the letter, no velocity; k1, k2, k3 = 0.01, 0.02, 0.03
    unhappy  x += k2 u2 (g - x)
    between  x += k3 u3 (p - x) + k2 u2 (g - x) - k1 u1 R
    happy    x += k3 u3 (p - x)                 - k1 u1 R;      first step, all happy: x -= k1 u1 R

References:
    Y. Xu, Z. Cui, J. Zeng, "Social emotional optimization algorithm for nonlinear constrained
    optimization problems", 2010, doi 10.1007/978-3-642-17563-3_68; Y. Ge, Z. Zhang, "An emotional
    particle swarm optimization algorithm", 2005, doi 10.1007/11539902_67 (stimulus).
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError, nearest
from jaxswarm.swarm.optimizers.base import at_least
from jaxswarm.swarm.optimizers.boundaries import reflect
from jaxswarm.swarm.optimizers.particles import PSO
from jaxswarm.swarm.optimizers.pso import pso
from jaxswarm.swarm.optimizers.topologies import global_best
from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.schedules import coefficient, linear

__all__ = ["emotional", "emotions", "sepso"]

VARIANTS = ("R1", "R2", "R3")
NUM_WORST = 3
SAD, HAPPY = 0.3, 0.6


def sepso(
    num_particles: int = 40,
    num_steps: float | None = None,
    *,
    variant: str = "R1",
    repulsion: float = 0.1,
    **parts: Any,
) -> PSO:
    """Social emotional PSO, a reconstruction in three variants (see the head of this file).

    Args:
      num_particles: n, at least 4 (three of them are the worst).
      num_steps: updates over which the inertia falls from 0.9 to 0.4; default as many as
        ``minimize`` makes.
      variant: ``"R1"``, ``"R2"`` or ``"R3"``.
      repulsion: c3, push away from the worst particles (R1, R2).
      **parts: keyword arguments of :func:`pso`, which override the choices made here.

    >>> sepso(variant="R4")
    Traceback (most recent call last):
        ...
    jaxswarm.errors.InputError: variant='R4' is unknown...
    """
    if variant not in VARIANTS:
        raise InputError(f"variant={variant!r} is unknown. {nearest(str(variant), VARIANTS)}")
    at_least("num_particles", num_particles, NUM_WORST + 1, "three of them are the worst")
    chosen: dict[str, Any] = dict(
        inertia=linear(0.9, 0.4, num_steps),
        cognitive=2.0,
        social=2.0,
        velocity_limit=0.2,
        topology=global_best(),
        boundary=reflect(0.5),
        initial_velocity=0.5,
        renew=False,
        control=emotions(variant),
        rule=emotional(variant, repulsion),
    )
    return pso(num_particles, **(chosen | parts))


def emotions(variant: str = "R1") -> "Emotions":
    """Control that keeps the emotion index of every particle and passes it to the rule."""
    return Emotions(decay=0.05, sensitivity=0.05, variant=variant)


def emotional(variant: str = "R1", repulsion: float = 0.1) -> "Emotional":
    """Velocity rule in which emotion chooses the behavior; needs the control :func:`emotions`."""
    gains = (0.01, 0.02, 0.03)
    return Emotional(coefficient("repulsion", repulsion, lower=0.0), gains, variant=variant)


class EmotionState(NamedTuple):
    """Emotion index (n,) and the memories before the coming step (n,)."""

    emotion: jax.Array
    reference: jax.Array


@pytree
class Emotions:
    """See :func:`emotions`."""

    decay: float
    sensitivity: float
    variant: str = static()

    def init(self, shape, dtype):
        """Everybody is happy and has no memory."""
        return EmotionState(jnp.ones(shape[:1], dtype), jnp.full(shape[:1], jnp.inf, dtype))

    def __call__(self, random, state, swarm, hyper):
        emotion = state.emotion
        if self.variant == "R2":
            surprise = jnp.abs(swarm.value - state.reference)
            known = jnp.isfinite(surprise)
            surprise = jnp.where(known, surprise, 0.0)
            mean = jnp.sum(surprise) / jnp.maximum(jnp.sum(known, dtype=surprise.dtype), 1.0)
            stimulus = self.sensitivity * jnp.log1p(surprise / jnp.where(mean > 0.0, mean, 1.0))
            emotion = jnp.clip(emotion + jnp.where(swarm.improved, stimulus, -stimulus), 0.0, 1.0)
        else:
            emotion = jnp.where(swarm.improved, 1.0, jnp.maximum(0.0, emotion - self.decay))
        emotion = emotion.astype(swarm.position.dtype)
        return hyper | {"emotion": emotion}, EmotionState(emotion, swarm.memory_value)


@pytree
class Emotional:
    """See :func:`emotional`."""

    repulsion: float
    gains: tuple[float, float, float]
    variant: str = static()

    def __call__(self, random, swarm, hyper):
        shape, dtype = swarm.position.shape, swarm.position.dtype
        draw = [random.uniform(f"emotional/{i}", shape, dtype) for i in range(3)]
        own = draw[0] * (swarm.memory_position - swarm.position)
        social = draw[1] * (swarm.attractor - swarm.position)
        _, worst = jax.lax.top_k(swarm.value, NUM_WORST)
        away = -draw[2] * (
            swarm.position[worst].sum(axis=0, keepdims=True) - NUM_WORST * swarm.position
        )
        emotion = hyper["emotion"][:, None]
        sad, happy = emotion < SAD, emotion >= HAPPY

        if self.variant == "R3":
            k1, k2, k3 = self.gains
            return (
                jnp.where(sad, 0.0, k3 * own + k1 * away) + jnp.where(happy, 0.0, k2 * social)
            ).astype(dtype)
        away = self.repulsion * away / NUM_WORST
        own, social = hyper["cognitive"] * own, hyper["social"] * social
        if self.variant == "R2":
            steer = emotion * own + (1.0 - emotion) * social + away
        else:
            steer = jnp.where(sad, 0.0, own + away) + jnp.where(happy, 0.0, social)
        return hyper["inertia"] * swarm.velocity + steer.astype(dtype)
