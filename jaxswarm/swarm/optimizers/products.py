"""Matrix products with a transposed factor that have the same bytes with any number of threads.

XLA on a CPU folds a transposition into the product where a pool of threads may compute it, and leaves it
apart where one thread does: two programs that sum in another order, and after some steps two searches. Here
the product itself says which axes are summed, and there is nothing to fold.
"""

import jax

__all__ = ["over_columns", "over_rows"]


def over_columns(a: jax.Array, b: jax.Array) -> jax.Array:
    """``a @ b.T``: (n, d), (m, d) -> (n, m).

    >>> over_columns(jax.numpy.eye(2), jax.numpy.array([[1.0, 2.0]])).tolist()
    [[1.0], [2.0]]
    """
    return jax.lax.dot_general(a, b, (((1,), (1,)), ((), ())))


def over_rows(a: jax.Array, b: jax.Array) -> jax.Array:
    """``a.T @ b``: (n, d), (n, e) -> (d, e).

    >>> over_rows(jax.numpy.ones((3, 2)), jax.numpy.ones((3, 1))).tolist()
    [[3.0], [3.0]]
    """
    return jax.lax.dot_general(a, b, (((0,), (0,)), ((), ())))
