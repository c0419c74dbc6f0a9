r"""How a base turns under an arm: by what it holds, or as a mass that swings on it.

With :math:`\theta_0 = -c\,M`, the turns of a base without mass, the turns :math:`\theta` about both axes follow

.. math:: \frac{\ddot\theta}{\omega^2} + c\,(I(q) - \bar I)\,\ddot\theta
    + \frac{2\zeta}{\omega}\dot\theta + \theta = \theta_0,

linear in :math:`\theta_0`, with the mean inertia over all turns of the joints. About an axis whose swing does
not show, :math:`\theta = \theta_0`.
"""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.hinged_base import TURNS, hinged, poses
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.logs.filtering import derivatives
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.smoothing import smooth
from jaxswarm.programs import program
from jaxswarm.robot.logged import rigid_torques
from jaxswarm.robot.model import Robot

# Part of the mean inertia below which that of the arm lowers it nowhere: masses that no joint feels may stand
# in a model at any value, negative ones too.
LEAST = 0.2


def swings(term: Term) -> bool:
    """Whether the base of a compliance swings, and whether its linear values are known yet."""
    law = term.law_of(BodyChange)
    return bool(law.swinging(term.values)) and all(p.name in term.values for p in law.linear)


def softness(term: Term) -> np.ndarray:
    """Turns (2,) of a base about both axes per moment, of a compliance with its values."""
    turns = term.law_of(BodyChange).compliance
    assert turns is not None
    return np.asarray(turns(term.values), float)


def softness_by(law: BodyChange) -> list[np.ndarray]:
    """What a compliance makes of a moment, (2,) about both axes, by each of its linear parameters."""
    none, turns = {p.name: 0.0 for p in law.linear}, law.compliance
    assert turns is not None
    return [np.asarray(turns({**none, p.name: 1.0})) for p in law.linear]


def below_cutoff(moments: np.ndarray, motion: Motion) -> np.ndarray:
    """Moments (T, 2, m) below the torque's cutoff with two derivatives, (T, 3, 2, m).

    Above it there is noise differentiated four times.
    """
    low = smooth(moments.reshape(len(moments), -1), motion.rate, motion.torque_cutoff)
    whole = np.stack([low, *derivatives(low, motion.rate, 2)], axis=1)
    return whole.reshape(len(moments), 3, *moments.shape[1:])


def swung(
    still: np.ndarray,
    motion: Motion,
    inertia: np.ndarray,
    term: Term,
    more: np.ndarray | None = None,
) -> np.ndarray:
    """Turns of a base that swings, with two derivatives, (T, 3, 2, m).

    Args:
        still: Those of a base without mass.
        motion: The log, for its rate.
        inertia: Of the arm about the axes of the base less its mean, (T, 2, 2).
        term: A compliance with its values.
        more: Turns (T, 2, m) that drive the swing beside those, not the begin of it; None: there are none.
    """
    law = term.law_of(BodyChange)
    assert law.swing is not None
    shows = np.array([n in law.swinging(term.values) for n in law.swing[:2]])
    omega = 2.0 * np.pi * np.array([term.values[n] for n in law.swing[:2]])
    damping = 2.0 * term.values[law.swing[2]] / omega
    mass = _mass(inertia, np.maximum(softness(term), 0.0), omega, shows)
    angle, rate, push = still[0]
    step = 1.0 / motion.rate
    # A step before the first sample, on the way on which it lies at all times where the inertia is the mean.
    late = (damping[:, None] + step) * rate + (omega**-2.0)[:, None] * push
    drive = still[:, 0] if more is None else still[:, 0] + more
    whole = np.asarray(_swung((angle - late, rate, push), *filled((drive, mass)), damping, step))
    return np.where(shows[:, None], whole[: len(still)], still)


def _mass(
    inertia: np.ndarray, soft: np.ndarray, omega: np.ndarray, shows: np.ndarray
) -> np.ndarray:
    """Inertia over stiffness (T, 2, 2) of a swing, no less than a part of its mean."""
    own = omega**-2.0
    both = shows[:, None] & shows
    more = np.where(both, np.sqrt(soft[:, None] * soft) * inertia, 0.0)
    along = np.maximum(own + np.diagonal(more, axis1=1, axis2=2), LEAST * own)
    most = (1.0 - LEAST) * np.sqrt(along.prod(axis=1))
    across = np.clip(more[:, 0, 1], -most, most)
    # The square roots made it symmetric: one axis drives the other by its own softness.
    ratio = np.sqrt(np.where(soft > 0.0, soft, 1.0))
    mass = np.zeros_like(inertia)
    mass[:, 0, 0], mass[:, 1, 1] = along.T
    mass[:, 0, 1], mass[:, 1, 0] = across * ratio[0] / ratio[1], across * ratio[1] / ratio[0]
    return mass


@program()
def _swung(
    begin: tuple, rest: jax.Array, mass: jax.Array, damping: jax.Array, step: float
) -> jax.Array:
    """Turns (T, 3, 2, m) by the trapezoidal rule, which no stiffness makes unstable."""
    half, quarter = 0.5 * step, 0.25 * step * step

    def go(state, now):
        angle, rate, push = state
        wanted, inertia = now
        angle, rate = angle + step * rate + quarter * push, rate + half * push
        matrix = inertia + jnp.diag(half * damping + quarter)
        missing = wanted - angle - damping[:, None] * rate
        (a, b), (c, d) = matrix
        inverse = jnp.array([[d, -b], [-c, a]]) / (a * d - b * c)
        push = inverse @ missing
        state = (angle + quarter * push, rate + half * push, push)
        return state, jnp.stack(state)

    return jax.lax.scan(go, begin, (rest, mass))[1]


def inertia_along(arm: Robot, q: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """Inertia (T, 2, 2, m) of an arm about the axes of its base less its mean, [kg m^2].

    Args:
        arm: The robot; its own parameters do not matter.
        q: Positions of the joints, (T, n).
        parameters: Rigid parameters, (10 n, m).
    """
    floating, mean = hinged(arm).replace(gravity=np.zeros(3)), poses(arm)
    held = np.pad(np.concatenate([mean, q]), ((0, 0), (TURNS, 0)))
    rest, found = np.zeros_like(held), []
    for axis in range(TURNS):
        push = rest.copy()
        push[:, axis] = 1.0
        found.append(rigid_torques(floating, held, rest, push, parameters, first=TURNS)[:TURNS])
    whole = np.stack(found, axis=1).transpose(3, 0, 1, 2)
    return whole[len(mean) :] - whole[: len(mean)].mean(axis=0)
