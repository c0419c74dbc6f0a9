"""How links swing behind their motors, for many values of a transmission's parameters at once."""

from collections.abc import Sequence

import jax
import numpy as np

from jaxswarm.effects.deflection import deflection
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.link_lag import calm_start
from jaxswarm.logs.motion import Motion
from jaxswarm.programs import program

# A lag beyond this runs away [rad or m].
_MOST_LAG = 1.0
# Options are filled up to the first, where each feels something of its own, or to multiples of the second, so
# that few programs serve all lattices: an option more costs a tenth of a millisecond, a program a tenth of a
# second.
_FEW, _MANY = 24, 72


def swings(
    motion: Motion,
    felt: Sequence[np.ndarray],
    gear: Sequence[np.ndarray],
    substeps: int,
    most: int,
) -> np.ndarray:
    """Lags of links behind their motor with their two derivatives, (T, 3, m), of m options.

    Args:
        motion: The log.
        felt: Torque of the joint with its derivatives by q, dq, ddq, (T, 1 or m) each.
        gear: Stiffness, damping, dead zone and hardening, (m,) each.
        substeps: Integration steps per sample.
        most: Options that stand in memory together; no more are made.
    """
    count = len(gear[0])
    felt, gear = _held(tuple(felt), tuple(gear), most)
    lags = _lags(*felt, *gear, 1.0 / motion.rate, calm_start(motion), substeps)
    e, v, a = (np.asarray(x)[: len(motion.t), :count] for x in lags)
    # A model whose inertia is not positive somewhere lets the lag run away: no candidate.
    alive = np.isfinite(a).all(axis=0) & (np.abs(e).max(axis=0) < _MOST_LAG)
    # Each is written once: of all options they are the largest there is.
    swung = np.empty((len(e), 3, count))
    for k, x in enumerate((e, v, a)):
        swung[:, k] = x
    swung[:, :, ~alive] = 0.0
    return swung


def _held(felt: tuple[np.ndarray, ...], gear: tuple[np.ndarray, ...], most: int) -> tuple:
    """What the joint feels (T, 1 or m) and gears (m,) with samples and options filled up by the last.

    Options are not filled up to more than the ``most`` that a long log takes at a time.
    """
    count, own = len(gear[0]), felt[0].shape[1] > 1
    more = -count % min(_FEW if own and count <= _FEW else _MANY, most)
    felt = filled(felt)
    if own:
        felt = tuple(np.pad(x, ((0, 0), (0, more)), mode="edge") for x in felt)
    return felt, tuple(np.pad(x, (0, more), mode="edge") for x in gear)


@program("substeps")
def _lags(torque, by_q, by_dq, by_ddq, k, d, gap, hard, step, calm, substeps):
    """Lags (T, m) and their derivatives of m options; see :func:`deflection`.

    What all options feel alike, (T, 1), stays one signal: written out for each it is most of the work.
    """

    def lag(tau, s, c, m, *gear):
        return deflection(m, c, s, tau, *gear, step, calm, substeps)

    alike = torque.shape[1] == 1
    felt = (x[:, 0] if alike else x for x in (torque, by_q, by_dq, by_ddq))
    axes = (*(None if alike else 1,) * 4, *(0,) * 4)
    return jax.vmap(lag, in_axes=axes, out_axes=1)(*felt, k, d, gap, hard)
