"""Ask and tell: a search whose objective runs on the host, in NumPy, SciPy, MuJoCo or a laboratory.

    driver = Driver(optimizer, space, key, num_steps=100)
    while not driver.finished:
        driver.tell([objective(params) for params in driver.ask()])
    driver.result()

:meth:`Driver.run` does the same with one call, a pool of workers and a time limit for each candidate.
"""

import concurrent.futures
from collections.abc import Callable, Mapping, Sequence, Set
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.room import room_for_programs
from jaxswarm.swarm.calling import check_takes
from jaxswarm.swarm.needed import refuse_too_many
from jaxswarm.swarm.optimizers.base import at_least, comparable, num_values
from jaxswarm.swarm.pytree import on_device
from jaxswarm.swarm.random import fold
from jaxswarm.swarm.repeating import first
from jaxswarm.swarm.result import Result, Status
from jaxswarm.swarm.search import check_state, going_on, optimizer_for, rule, start_for
from jaxswarm.swarm.space import Space
from jaxswarm.swarm.standing import STEPS_DONE, outcome, progress_of
from jaxswarm.swarm.start import begun
from jaxswarm.swarm.stopping import ask
from jaxswarm.swarm.workers import shared_out, tried

__all__ = ["Driver"]


class Driver:
    """Step by step through a search; the same steps as ``minimize`` with the same key makes.

    Args:
      optimizer, space, key, num_steps, start, stop, state: as for ``minimize``. A stop rule ends the
        search by ``finished``; who goes on telling is not held.

    Attributes:
      state: of the optimizer; ``save(path, driver.state)`` and ``Driver(..., state=restore(...))`` go
        on in another process.
      history: best value after every step, a list of floats.
      num_timeouts: candidates so far that were given up by :meth:`run`.

    Raises:
      InputError: as ``minimize``.

    >>> import numpy as np
    >>> from jaxswarm.swarm import pso
    >>> driver = Driver(pso(8), Space(x=(-5.0, 5.0)), jax.random.key(0), num_steps=40)
    >>> while not driver.finished:
    ...     driver.tell([np.square(params["x"] - 2.0) for params in driver.ask()])
    >>> round(float(driver.result().params["x"]), 2)
    2.0
    """

    def __init__(
        self,
        optimizer: Any,
        space: Space,
        key: jax.Array,
        *,
        num_steps: int,
        start: Any = None,
        stop: Any = None,
        state: Any = None,
    ):
        if not isinstance(space, Space):
            raise InputError(f"space={space!r} must be a Space, e.g. Space(x=(-5.0, 5.0)).")
        room_for_programs()
        self.space = space
        self.num_steps = at_least("num_steps", num_steps, 1, "a search needs a step")
        self._optimizer = on_device(optimizer_for(optimizer, num_steps, state))
        refuse_too_many(self._optimizer, space, 0)
        self._key, self._stop = key, on_device(rule(stop))
        begin = start_for(space, start, state)
        if state is not None:
            check_state(state, lambda k: begun(self._optimizer, k, space, None), key)
        self._carry = going_on(state, self._stop)
        if self._carry is None:
            given = on_device((space, begin))
            self._carry = _first(self._optimizer, key, *given, self._stop)
        self.history: list[float] = []
        self.num_timeouts = 0

    @property
    def state(self) -> Any:
        """State of the optimizer."""
        return self._carry.state

    @property
    def finished(self) -> bool:
        """Whether all steps are done or the stop rule has fired."""
        return self._stopped or len(self.history) >= self.num_steps

    @property
    def _stopped(self) -> bool:
        return bool(jax.device_get(self._carry.done))

    def ask_population(self) -> Any:
        """The candidates as one tree of NumPy arrays with a leading axis n."""
        return jax.device_get(_decoded(on_device(self.space), self.state.position))

    def ask(self) -> list[Any]:
        """The candidates, a list of n parameters with NumPy numbers, choices as indices."""
        population = self.ask_population()
        return [jax.tree.map(lambda leaf, i=i: leaf[i], population) for i in range(self.size)]

    @property
    def size(self) -> int:
        """Number of candidates n in a step."""
        return self.state.position.shape[0]

    def tell(self, value: Sequence[Any] | np.ndarray) -> None:
        """Give the values (n,) of what was asked, in its order, and make the step; NaN counts as +inf.

        For an optimizer with several numbers a candidate, (n, k), or n times what an objective returns.
        """
        width = num_values(self._optimizer)
        if isinstance(value, Mapping | Set):
            raise InputError(
                f"value is a {type(value).__name__}: tell a list in the order of ask()."
            )
        try:
            told = jax.device_put(np.asarray([_floats(one, width) for one in value]))
        except (TypeError, ValueError) as error:
            raise InputError(
                f"value: {error}. Tell a number for each candidate, NaN where it has none; an "
                "objective returns it."
            ) from error
        expected = (self.size,) if width is None else (self.size, width)
        if told.shape != expected:
            raise InputError(
                f"value has shape {told.shape}, expected {expected}: tell one number for each candidate."
            )
        given = self._optimizer, self._key, self._carry, told, self._stop
        self._carry = _step(*given)
        self.history.append(float(jax.device_get(self._carry.state.best_value)))

    def run(
        self,
        fn: Callable[[Any], Any],
        *,
        pool: concurrent.futures.Executor | None = None,
        timeout: float | None = None,
        vectorized: bool = False,
        forgive: tuple[type[BaseException], ...] = (),
    ) -> Result:
        """Evaluate and tell until the search is finished.

        Args:
          fn: objective on the host, ``fn(params) -> float``; with ``vectorized``,
            ``fn(population) -> (n,)``.
          pool: workers that share the candidates of a step, e.g. ``ProcessPoolExecutor(8)``; default
            one after the other, here.
          timeout: seconds after which a running candidate is given up and told as +inf; needs a pool.
            Its worker is busy until the function returns all the same, and a candidate that has found
            no free worker for as long is given up too: let the function bound itself where it can.
          vectorized: whether ``fn`` takes all candidates at once.
          forgive: exceptions of ``fn`` that count as +inf; any other ends the search.

        Returns:
          As :meth:`result`.
        """
        if timeout is not None and pool is None:
            raise InputError(f"timeout={timeout} needs a pool: nothing else can be waited for.")
        if vectorized and pool is not None:
            raise InputError("vectorized=True asks for all at once, which no pool can share out.")
        check_takes(fn, "population" if vectorized else "params")
        width = num_values(self._optimizer)
        lost = np.inf if width is None else np.full(width, np.inf)
        while not self.finished:
            if vectorized:
                self.tell(fn(self.ask_population()))
            elif pool is None:
                self.tell([tried(fn, params, forgive, lost) for params in self.ask()])
            else:
                values, late = shared_out(fn, self.ask(), pool, timeout, forgive, lost)
                self.num_timeouts += late
                self.tell(values)
        return self.result()

    def result(self) -> Result:
        """What ``minimize`` would return by now; the history holds the steps told so far."""
        state, steps = self.state, len(self.history)
        params, code = _end(on_device(self.space), self._carry)
        told = np.asarray(self.history, jnp.result_type(float))
        return Result(
            params=params,
            value=state.best_value,
            position=state.best_position,
            status=Status(code),
            num_steps=jax.device_put(np.int32(steps)),
            num_evaluations=jax.device_put(np.int32(steps * self.size)),
            history=jax.device_put(told),
            state=state,
        )


@jax.jit
def _first(optimizer, key, space, start, stop):
    return first(begun(optimizer, key, space, start), stop)


@jax.jit
def _end(space, carry):
    """The best parameters, and the code of the end."""
    code = jnp.where(carry.done, carry.code, STEPS_DONE)
    code = outcome(carry.state, code).astype(jnp.int32)
    return space.decode(carry.state.best_position), code


@jax.jit
def _decoded(space, position):
    return jax.vmap(space.decode)(position)


@jax.jit
def _step(optimizer, key, carry, value, stop):
    old = carry.state
    value = comparable(value, old.position.dtype)
    state, info = optimizer.update(fold(key, old.count), old, value)
    since = jnp.where(info.improved, 0, carry.since + 1)
    carry = carry._replace(state=state, since=since, num_steps=carry.num_steps + 1)
    if stop is None:
        return carry
    progress = progress_of(state, since, info.diversity)
    here, reason, memory = ask(stop, progress, carry.memory)
    code = jnp.where(here & ~carry.done, reason, carry.code)
    return carry._replace(memory=memory, done=carry.done | here, code=code)


def _floats(one, width):
    """What was told of a candidate; of several numbers as one row, whatever parts they come in."""
    if one is None:
        raise TypeError("None is no number")
    if width is not None and isinstance(one, tuple | list):
        return np.concatenate([np.asarray(part, float).ravel() for part in one])
    return np.asarray(one, float)
