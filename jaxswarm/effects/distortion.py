"""What a drive writes down beside the true torque of its joint, as columns of its linear parameters."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.kinds import MeasurementLaw


def distortion_columns(law: MeasurementLaw, torque: np.ndarray) -> np.ndarray:
    """Columns (T, k) of a law's linear parameters where the true torque of its joint is (T,)."""
    zero = {p.name: jnp.zeros(()) for p in law.linear}
    slopes = jax.jacfwd(lambda p: law.distortion(p, jnp.asarray(torque)))(zero)
    return np.stack([np.asarray(slopes[p.name]) for p in law.linear], axis=1)
