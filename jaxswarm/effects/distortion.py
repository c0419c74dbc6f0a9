"""What a drive writes down beside the true torque of its joint, as columns of its linear parameters."""

from collections.abc import Mapping

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.programs import program


def distortion_columns(law: MeasurementLaw, values: Mapping, torque: np.ndarray) -> np.ndarray:
    """Columns (T, k) of a law's linear parameters where the true torque of its joint is (T,).

    ``values`` are those of its shape; what is not among them is as usual.
    """
    slopes = _slopes(law, _shape(law, values), torque)
    return np.stack([np.asarray(slopes[p.name]) for p in law.linear], axis=1)


@program("law")
def _slopes(law: MeasurementLaw, shape: dict, torque: jax.Array) -> dict:
    distortion = law.distortion
    assert distortion is not None  # callers ask those that distort
    zero = {p.name: jnp.zeros((), torque.dtype) for p in law.linear}
    return jax.jacfwd(lambda p: distortion({**shape, **p}, torque))(zero)


def distortion_slope(law: MeasurementLaw, values: Mapping, torque: np.ndarray) -> np.ndarray:
    """How what a law writes down beside a true torque (T,) changes with that, (T,); of a jump nothing."""
    linear = {p.name: values[p.name] for p in law.linear}
    return np.asarray(_slope(law, {**_shape(law, values), **linear}, torque))


@program("law")
def _slope(law: MeasurementLaw, values: dict, torque: jax.Array) -> jax.Array:
    distortion = law.distortion
    assert distortion is not None  # callers ask those that distort
    return jax.jvp(lambda x: distortion(values, x), (torque,), (jnp.ones_like(torque),))[1]


def _shape(law: MeasurementLaw, values: Mapping) -> dict[str, np.float64]:
    """Nonlinear values, as data of a program and no constants of it."""
    return {p.name: np.float64(values.get(p.name, p.nominal)) for p in law.nonlinear}
