"""Test functions, shifted and rotated, with optimum 0 inside [-5, 5]^D.

Each is a function of z = R (x - o), with o uniform in [-4, 4]^D and R a random rotation, both drawn from
a seed for each dimension, so that no algorithm profits from the center or from the axes.

Reference:
    J. J. Liang, B. Y. Qu, P. N. Suganthan, "Problem definitions and evaluation criteria for the CEC 2014
    special session", 2013 (forms and scales; modified Schwefel without its bound on x).
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

BOUND = 5.0


class Instance(NamedTuple):
    """Shift o (d,) and rotation R (d, d) of all problems in d dimensions."""

    shift: np.ndarray
    rotation: np.ndarray


def instance(dims: int, seed: int) -> Instance:
    """Draw the shift and the rotation for ``dims`` dimensions from a seed."""
    rng = np.random.default_rng([seed, dims])
    rotation, triangle = np.linalg.qr(rng.normal(size=(dims, dims)))
    return Instance(rng.uniform(-4.0, 4.0, dims), rotation * np.sign(np.diag(triangle)))


def sphere(z, xp):
    return xp.sum(z**2, axis=-1)


def ellipsoid(z, xp):
    return xp.sum(10.0 ** (6.0 * np.linspace(0.0, 1.0, z.shape[-1])) * z**2, axis=-1)


def rosenbrock(z, xp):
    z = 2.048 / BOUND * z + 1.0
    a, b = z[..., :-1], z[..., 1:]
    return xp.sum(100.0 * (a**2 - b) ** 2 + (a - 1.0) ** 2, axis=-1)


def rastrigin(z, xp):
    return xp.sum(z**2 - 10.0 * xp.cos(2.0 * np.pi * z) + 10.0, axis=-1)


def ackley(z, xp):
    radius = xp.sqrt(xp.mean(z**2, axis=-1))
    ripple = xp.mean(xp.cos(2.0 * np.pi * z), axis=-1)
    return -20.0 * xp.exp(-0.2 * radius) - xp.exp(ripple) + 20.0 + np.e


def griewank(z, xp):
    z = 120.0 * z
    index = np.sqrt(np.arange(1, z.shape[-1] + 1))
    return xp.sum(z**2, axis=-1) / 4000.0 - xp.prod(xp.cos(z / index), axis=-1) + 1.0


def schwefel(z, xp):
    z = 100.0 * z + 420.9687462275036
    size, dims = xp.abs(z), z.shape[-1]
    rest = 500.0 - xp.mod(size, 500.0)
    beyond = xp.sign(z) * rest * xp.sin(xp.sqrt(xp.abs(rest)))
    beyond = beyond - (size - 500.0) ** 2 / (10000.0 * dims)
    term = xp.where(size <= 500.0, z * xp.sin(xp.sqrt(size)), beyond)
    return 418.9828872724339 * dims - xp.sum(term, axis=-1)


PROBLEMS: dict[str, Callable[[Any, Any], Any]] = {
    "sphere": sphere,
    "ellipsoid": ellipsoid,
    "rosenbrock": rosenbrock,
    "rastrigin": rastrigin,
    "ackley": ackley,
    "griewank": griewank,
    "schwefel": schwefel,
}


def evaluate(name: str, x: Any, instance: Instance, xp: Any = np) -> Any:
    """Value (n,) of points x (n, d), with numpy or ``jax.numpy``."""
    return PROBLEMS[name]((x - instance.shift) @ instance.rotation.T, xp)
