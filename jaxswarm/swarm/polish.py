r"""Polish: follow the gradient from the best points a swarm found, within the bounds.

The unit cube is mapped to all of R^d by the logit, stretched by a small margin so that a solution
on a bound is at a finite place:

    x = clip(-margin + (1 + 2 margin) sigmoid(z), 0, 1)

and an unconstrained method runs in z: L-BFGS or Adam (optax), or Levenberg-Marquardt for objectives
that return residuals r with value = sum r^2,

    (J^T J + lambda diag(J^T J + eps)) dz = -J^T r,

solved by QR of the stacked matrix, lambda divided or multiplied by what a trial step deserves.
Every point visited is compared, so the result is never worse than its start.

References:
    J. Nocedal, S. Wright, "Numerical optimization", 2006 (L-BFGS); J. J. More, "The
    Levenberg-Marquardt algorithm: implementation and theory", 1978.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from jaxswarm.errors import InputError, nearest
from jaxswarm.room import room_for_programs
from jaxswarm.swarm.calling import check_args, check_takes
from jaxswarm.swarm.optimizers.base import at_least
from jaxswarm.swarm.pytree import on_device
from jaxswarm.swarm.result import Result
from jaxswarm.swarm.space import Space

__all__ = ["Polished", "polish"]

MARGIN = 1e-3
APART = 1e-6
"""Distance in the cube (largest coordinate) below which two starts are one: a gradient leads both alike."""


class Polished(NamedTuple):
    """Outcome of :func:`polish`: parameters, value, point of the unit cube, value at the start."""

    params: Any
    value: jax.Array
    position: jax.Array
    start_value: jax.Array


def polish(
    fn: Callable[[Any, Any], jax.Array],
    space: Space,
    state: Any,
    args: Any = None,
    *,
    method: str = "lbfgs",
    num_steps: int = 100,
    top: int = 5,
    learning_rate: float = 0.02,
) -> Polished:
    """Improve the best points of a search by a gradient method.

    Args:
      fn: objective for one candidate, as for ``minimize``: ``fn(params, args) -> scalar``; for
        ``method="levenberg_marquardt"`` the residuals (m,), whose sum of squares is the value.
      space: names and bounds.
      state: a search's result or final state (``result.state``; of many runs all of them), or starting
        points of the cube, (d,) or (k, d), all of which are polished.
      args: data handed to ``fn``.
      method: ``"lbfgs"``, ``"adam"`` or ``"levenberg_marquardt"``.
      num_steps: iterations of the method.
      top: how many starting points: the best distinct ones of all that the state remembers, which
        are evaluated to be ranked.
      learning_rate: of Adam.

    Returns:
      :class:`Polished`; the value is never above the best start.

    Raises:
      InputError: an unknown method, residuals where a scalar is needed or the reverse.

    >>> from jaxswarm.swarm import Space, minimize, pso
    >>> def rosenbrock(p, _):
    ...     return 100.0 * (p["y"] - p["x"] ** 2) ** 2 + (1.0 - p["x"]) ** 2
    >>> space = Space(x=(-2.0, 2.0), y=(-1.0, 3.0))
    >>> result = minimize(rosenbrock, pso(10), space, jax.random.key(0), num_steps=10)
    >>> bool(polish(rosenbrock, space, result.state).value < 1e-10)
    True
    """
    room_for_programs()
    if method not in METHODS:
        raise InputError(f"method={method!r} is unknown. {nearest(str(method), METHODS)}")
    if not isinstance(space, Space):
        raise InputError(f"space={space!r} must be a Space: polish(fn, space, result.state).")
    state = state.state if isinstance(state, Result) else state
    check_takes(fn, "params", "args")
    check_args(args)
    at_least("num_steps", num_steps, 1, "a method needs a step")
    points = _candidates(state)
    top = min(at_least("top", top, 1, "a start is needed"), points.shape[0])
    if not hasattr(state, "best_position"):
        top = points.shape[0]  # who names the starts wants all of them
    _check_output(fn, space, points, args, method)
    space, learning_rate = on_device((space, learning_rate))
    return _polish(fn, space, points, args, method, num_steps, top, learning_rate)


def _polish(fn, space, points, args, method, num_steps, top, learning_rate):
    def value_of(x):
        out = fn(space.decode(x), args)
        out = jnp.sum(out**2) if method == "levenberg_marquardt" else out
        return jnp.where(jnp.isnan(out), jnp.inf, out)

    def one(x):
        run = METHODS[method]
        residual = lambda z: fn(space.decode(_to_cube(z)), args)  # noqa: E731
        visited, values = run(residual, _from_cube(x), num_steps, learning_rate)
        values = jnp.where(jnp.isnan(values), jnp.inf, values)
        best = jnp.argmin(values)
        return _to_cube(visited[best]), values[best]

    starts = _distinct(points, jax.vmap(value_of)(points), top)
    start_values = jax.vmap(value_of)(starts)
    positions, _ = jax.vmap(one)(starts)
    positions = jnp.concatenate([starts, positions])
    values = jnp.concatenate([start_values, jax.vmap(value_of)(positions[starts.shape[0] :])])
    best = jnp.argmin(values)
    position = positions[best]
    return Polished(space.decode(position), values[best], position, start_values.min())


_polish = jax.jit(_polish, static_argnames=("fn", "method", "num_steps", "top"))


def _optax(fn, z, num_steps, name, *numbers, with_value=False):
    """Run an optax solver; return the points visited (k, d) and their values (k,)."""
    import optax  # here: a search that is not polished need not wait for the import

    solver = getattr(optax, name)(*numbers)
    value_and_grad = optax.value_and_grad_from_state(fn) if with_value else jax.value_and_grad(fn)

    def step(carry, _):
        z, state = carry
        if with_value:
            value, grad = value_and_grad(z, state=state)
            extra = dict(value=value, grad=grad, value_fn=fn)
        else:
            value, grad = value_and_grad(z)
            extra = {}
        # A line search of optax mixes integers of two sizes, which JAX's strict promotion refuses.
        with jax.numpy_dtype_promotion("standard"):
            updates, state = solver.update(jnp.nan_to_num(grad), state, z, **extra)
        return (optax.apply_updates(z, updates), state), (z, value)

    (last, _), (visited, values) = jax.lax.scan(step, (z, solver.init(z)), length=num_steps)
    return jnp.concatenate([visited, last[None]]), jnp.append(values, fn(last))


def _lbfgs(fn, z, num_steps, learning_rate):
    return _optax(fn, z, num_steps, "lbfgs", with_value=True)


def _adam(fn, z, num_steps, learning_rate):
    return _optax(fn, z, num_steps, "adam", learning_rate)


def _levenberg_marquardt(residual, z, num_steps, learning_rate):
    def cost(z):
        return jnp.sum(residual(z) ** 2)

    def step(carry, _):
        z, value, damping = carry
        r, jacobian = residual(z), jax.jacfwd(residual)(z)
        scale = jnp.sqrt(damping * (jnp.sum(jacobian**2, axis=0) + 1e-12))
        stacked = jnp.concatenate([jacobian, jnp.diag(scale)])
        q, triangle = jnp.linalg.qr(stacked)
        move = jax.scipy.linalg.solve_triangular(triangle, -q[: r.shape[0]].T @ r)
        trial = z + jnp.nan_to_num(move)
        trial_value = cost(trial)
        better = trial_value < value
        damping = jnp.clip(jnp.where(better, damping / 5.0, damping * 4.0), 1e-14, 1e10)
        z, value = jnp.where(better, trial, z), jnp.where(better, trial_value, value)
        return (z, value, damping), None

    start = (z, cost(z), jnp.asarray(1e-2, z.dtype))
    (z, value, _), _ = jax.lax.scan(step, start, length=num_steps)
    return z[None], value[None]


METHODS = {"lbfgs": _lbfgs, "adam": _adam, "levenberg_marquardt": _levenberg_marquardt}


def _to_cube(z):
    return jnp.clip((1.0 + 2.0 * MARGIN) * jax.nn.sigmoid(z) - MARGIN, 0.0, 1.0)


def _from_cube(x):
    # A start exactly on a bound would sit where the clip has no slope: begin just inside.
    inside = jnp.clip(x, 1e-6, 1.0 - 1e-6)
    share = (inside + MARGIN) / (1.0 + 2.0 * MARGIN)
    return jnp.log(share) - jnp.log1p(-share)


def _candidates(state):
    """Points of the cube, (k, d), among which the starts are chosen: the best, and what is remembered.

    Memories as the states name them (``MEMORY``), the innermost of wrapped ones; of an optimizer
    without memory the candidates of its next step.
    """
    if not hasattr(state, "best_position"):
        return jnp.atleast_2d(jnp.asarray(state))
    inner, dims = state, state.best_position.shape[-1]
    while not hasattr(inner, "MEMORY") and hasattr(inner, "inner"):
        inner = inner.inner
    points = getattr(inner, inner.MEMORY[0]) if hasattr(inner, "MEMORY") else state.position
    if points.shape[-1] != dims:  # of a search in some of the coordinates
        points = state.position
    return jnp.concatenate([part.reshape(-1, dims) for part in (state.best_position, points)])


def _distinct(points, values, top):
    """The ``top`` best points no two of which coincide; the best again where there are no more."""

    def choose(blocked, _):
        pick = jnp.argmin(jnp.where(blocked, jnp.inf, values))
        near = jnp.max(jnp.abs(points - points[pick][None]), axis=1) < APART
        return blocked | near, jnp.where(jnp.all(blocked), jnp.argmin(values), pick)

    _, order = jax.lax.scan(choose, jnp.zeros(values.shape, bool), length=top)
    return points[order]


def _check_output(fn, space, starts, args, method):
    out = jax.eval_shape(lambda x: fn(space.decode(x[0]), args), starts)
    wanted = 1 if method == "levenberg_marquardt" else 0
    if len(out.shape) != wanted:
        need = "residuals (m,)" if wanted else "a scalar"
        raise InputError(f"fn returned shape {out.shape}, method={method!r} needs {need}.")
