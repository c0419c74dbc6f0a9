"""What a search returns: the parameters, and enough to assess and to continue it."""

from collections.abc import Mapping
from typing import Any

import jax
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.swarm.pytree import pytree
from jaxswarm.swarm.standing import CUSTOM, MESSAGES, NO_FINITE_VALUE, NOTHING_FEASIBLE

__all__ = ["Result", "Status", "by_name"]


@pytree
class Status:
    """Why a search ended: an int32 code inside the graph, words on the host.

    >>> Status(np.int32(1)).message
    'target value reached'
    """

    code: jax.Array

    @property
    def message(self) -> str | list[str]:
        """The text of the code; a list where there are several runs.

        Of runs that are spread over several hosts, the list tells those of this one.
        """
        codes = _here(self.code)
        said = [_message(int(code)) for code in codes.ravel()]
        return said[0] if codes.ndim == 0 else said

    @property
    def ok(self) -> Any:
        """False where no candidate ever had a finite value, or none was feasible."""
        return (self.code != NO_FINITE_VALUE) & (self.code != NOTHING_FEASIBLE)


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
      history: what ``record`` returned for each step; steps not done after an early
        stop repeat the last one.
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
        """Return the result, or raise ``RuntimeError`` if some run never saw a finite or feasible value."""
        for code in (NO_FINITE_VALUE, NOTHING_FEASIBLE):
            if np.any(_here(self.status.code) == code):
                raise RuntimeError(MESSAGES[code])
        return self

    def __repr__(self) -> str:
        """One line: values, why it ended, what it cost; neither history nor state."""
        if isinstance(self.value, jax.core.Tracer):
            return f"Result(traced, {type(self.state).__name__})"
        if not isinstance(self.value, jax.Array | np.ndarray):
            return f"Result({self.value!r})"  # of a tree that was mapped to something else
        values = _here(self.value)
        if not values.ndim:
            shown = " ".join(repr(jax.tree.map(np.asarray, jax.device_get(self.params))).split())
            shown = shown if len(shown) <= LONGEST else shown[:LONGEST] + "..."
            head = f"value={values:.6g}, params={shown}"
        else:
            head = f"{values.size} runs, values {values.min():.6g} to {values.max():.6g}"
        reasons = self.status.message
        reasons = reasons if isinstance(reasons, str) else ", ".join(sorted(set(reasons)))
        return (
            f"Result({head}, {reasons}, num_steps={_here(self.num_steps).max()}, "
            f"num_evaluations={_here(self.num_evaluations).sum()}, state={type(self.state).__name__})"
        )


def _message(code: int) -> str:
    """The text of a code; one that is not in the list is that of somebody's own stop rule."""
    return MESSAGES[code] if 0 <= code < len(MESSAGES) else f"{MESSAGES[CUSTOM]}, code {code}"


def by_name(given: Any, field: str) -> dict[str, Any]:
    """What a picture shows, by name: of results (or fronts) the field, arrays as they are.

    Raises:
      InputError: one of them without a name.
    """
    if not isinstance(given, Mapping):
        raise InputError(
            f"a {type(given).__name__} has no name in the picture: give {{name: {field}}}, one or several."
        )
    return {name: getattr(one, field, one) for name, one in given.items()}


LONGEST = 200
"""Characters of the parameters in the text of a result."""


def _here(leaf: Any) -> np.ndarray:
    """The values of an array that this host holds: all, or its own rows of a spread one."""
    if getattr(leaf, "is_fully_addressable", True):
        return np.asarray(jax.device_get(leaf))
    shards = {shard.index[0].start or 0: shard.data for shard in leaf.addressable_shards}
    return np.concatenate([jax.device_get(shards[start]) for start in sorted(shards)])
