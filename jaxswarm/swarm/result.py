"""What a search returns: the parameters, and enough to assess and to continue it."""

from typing import Any

import jax
import numpy as np

from jaxswarm.swarm.pytree import pytree
from jaxswarm.swarm.stopping import MESSAGES, NO_FINITE_VALUE

__all__ = ["Result", "Status"]


@pytree
class Status:
    """Why a search ended: an int32 code inside the graph, words on the host.

    >>> Status(np.int32(1)).message
    'target value reached'
    """

    code: jax.Array

    @property
    def message(self) -> str | list[str]:
        """The text of the code; a list where there are several runs."""
        codes = np.asarray(self.code)
        return MESSAGES[int(codes)] if codes.ndim == 0 else [MESSAGES[c] for c in codes.ravel()]

    @property
    def ok(self) -> Any:
        """False where no candidate ever had a finite value."""
        return self.code != NO_FINITE_VALUE


@pytree
class Result:
    """Outcome of ``minimize``; with many runs every field has a leading axis of runs.

    Attributes:
      params: the best parameters, as the space decodes them.
      value: () the best value.
      position: (d,) the best point of the unit cube.
      status: why the search ended.
      num_steps: () int32, updates done.
      num_evaluations: () int32, candidates evaluated, exactly.
      history: what ``record`` returned for each step; steps not done hold NaN (floats) or zero.
      state: the final state; ``minimize(..., state=result.state)`` goes on from it.
    """

    params: Any
    value: jax.Array
    position: jax.Array
    status: Status
    num_steps: jax.Array
    num_evaluations: jax.Array
    history: Any
    state: Any

    def check(self) -> "Result":
        """Return the result, or raise ``RuntimeError`` if some run never saw a finite value."""
        if not np.all(self.status.ok):
            raise RuntimeError(MESSAGES[NO_FINITE_VALUE])
        return self
