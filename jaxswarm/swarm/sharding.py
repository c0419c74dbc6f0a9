"""Runs over devices: each device carries its share of the runs, and none has to talk to another.

A CPU counts as one device unless told otherwise before JAX starts:

    XLA_FLAGS=--xla_force_host_platform_device_count=2

XLA keeps small programs on one core, so forced host devices pay where the runs are many. Over
several hosts call ``jax.distributed.initialize()`` first; every host makes the same call with all
the keys, and gets a result whose arrays are spread over all devices.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import jax
import numpy as np
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from jaxswarm.errors import InputError
from jaxswarm.swarm.minimize import minimize_runs
from jaxswarm.swarm.result import Result
from jaxswarm.swarm.schedules import for_run
from jaxswarm.swarm.space import Space

__all__ = ["minimize_sharded"]


def minimize_sharded(
    fn: Callable[[Any, Any], jax.Array],
    optimizer: Any,
    space: Space,
    keys: jax.Array,
    args: Any = None,
    *,
    num_steps: int,
    devices: Sequence[jax.Device] | None = None,
    stop: Any = None,
    record: Any = None,
) -> Result:
    """Minimize from many keys, the runs shared out among devices.

    Args:
      keys: (runs,) JAX keys; the number of runs must be a multiple of the number of devices.
      devices: default all devices of all hosts.
      fn, optimizer, space, args, num_steps, stop, record: as for ``minimize_runs``; with a stop
        rule each device ends when its own runs have.

    Returns:
      A ``Result`` with a leading axis of runs, equal to that of ``minimize_runs``.

    Raises:
      InputError: runs that do not divide evenly among the devices.
    """
    devices = jax.devices() if devices is None else list(devices)
    if keys.shape[0] % len(devices):
        raise InputError(
            f"keys has {keys.shape[0]} runs for {len(devices)} devices: give a multiple of "
            f"{len(devices)}."
        )
    mesh = Mesh(np.array(devices), ("runs",))
    shares = NamedSharding(mesh, PartitionSpec("runs"))
    search = _sharded(fn, num_steps, record, mesh)
    optimizer = for_run(optimizer, float(num_steps))  # a leaf here too, as in ``minimize_runs``
    return search(jax.device_put(keys, shares), optimizer, space, args, stop)


_CACHE: dict[Any, Any] = {}


def _sharded(fn, num_steps, record, mesh):
    """The compiled search of a function on a mesh, made once."""
    known = (fn, num_steps, record, mesh)
    if known not in _CACHE:
        split, copied = PartitionSpec("runs"), PartitionSpec()

        def search(keys, optimizer, space, args, stop):
            options = dict(num_steps=num_steps, stop=stop, record=record)
            return minimize_runs(fn, optimizer, space, keys, args, **options)

        specs = (split, copied, copied, copied, copied)
        # No collective is needed, and the carry of a loop starts from constants: skip that check.
        mapped = partial(jax.shard_map, mesh=mesh, in_specs=specs, out_specs=split, check_vma=False)
        _CACHE[known] = jax.jit(mapped(search))
    return _CACHE[known]
