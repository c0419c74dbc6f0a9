"""Runs over devices: each device carries its share of the runs, and none has to talk to another.

A CPU counts as one device unless told otherwise before JAX starts:

    XLA_FLAGS=--xla_force_host_platform_device_count=2

XLA keeps small programs on one core, so forced host devices pay where the runs are many. Over
several hosts call ``jax.distributed.initialize()`` first; every host makes the same call with all
the keys, and gets a result whose arrays are spread over all devices: a host reads its own rows from
``array.addressable_shards``, as ``status.message`` and the text of a result do.

With ``initialize(..., heartbeat_timeout_seconds=30)`` a host that is lost ends the others within a minute;
what they print names it by its number. A search that has to outlive that is
``minimize_resumable`` on every host, with its share of the keys and a path of its own: the same call goes on.
"""

from collections.abc import Callable, Sequence
from functools import cache, partial
from typing import Any

import jax
import numpy as np
from jax.sharding import Mesh, NamedSharding, PartitionSpec

from jaxswarm.errors import InputError
from jaxswarm.swarm.minimize import axes_of_runs
from jaxswarm.swarm.needed import refuse_too_many
from jaxswarm.swarm.result import Result
from jaxswarm.swarm.search import optimizer_for, rule, runs_of, search, start_for, the_loop
from jaxswarm.swarm.space import Space
from jaxswarm.swarm.telling import told

__all__ = ["minimize_sharded"]

SPLIT, COPIED = PartitionSpec("runs"), PartitionSpec()


def minimize_sharded(
    fn: Callable[..., jax.Array],
    optimizer: Any,
    space: Space,
    keys: jax.Array,
    args: Any = None,
    *,
    num_steps: int,
    devices: Sequence[jax.Device] | None = None,
    start: Any = None,
    stop: Any = None,
    record: Any = None,
    vectorized: bool = True,
    noisy: bool = False,
    args_axes: Any = None,
    progress: Callable[[int, Any], None] | None = None,
    progress_every: int = 10,
) -> Result:
    """Minimize from many keys, the runs shared out among devices.

    Args:
      keys: (runs,) JAX keys; the number of runs must be a multiple of the number of devices.
      devices: default all devices of all hosts.
      progress: as for ``minimize_runs``; every device tells of its own runs, on its own host.
      fn, optimizer, space, args, num_steps, start, stop, record, vectorized, noisy, args_axes,
        progress_every: as for ``minimize_runs``; with a stop rule each device ends when its own runs
        have.

    Returns:
      A ``Result`` with a leading axis of runs, equal to that of ``minimize_runs``.

    Raises:
      InputError: runs that do not divide evenly among the devices, too little memory.
    """
    devices = jax.devices() if devices is None else list(devices)
    if not devices:
        raise InputError("devices is empty: give at least one, or leave it out for all.")
    runs = runs_of(keys)
    if runs % len(devices):
        raise InputError(
            f"keys has {runs} runs for {len(devices)} devices: give a multiple of {len(devices)}."
        )
    mesh = Mesh(np.array(devices), ("runs",))
    axes = axes_of_runs(args, args_axes, keys)
    options = dict(record=record, vectorized=vectorized, noisy=noisy, args_axes=axes, runs=True)
    telling = dict(progress=progress, progress_every=progress_every)
    loop = the_loop(fn, space, num_steps, **options, **telling)
    optimizer = optimizer_for(optimizer, num_steps)
    refuse_too_many(optimizer, space, loop.num_steps, runs * _here(devices) // len(devices))
    rest = loop, optimizer, space, rule(stop), start_for(space, start)
    run = _sharded(mesh, axes)
    # All of it is put where it belongs by name, in ways of JAX that a transfer guard takes for unasked.
    with jax.transfer_guard("allow"):
        given = _placed(keys, mesh, SPLIT), _by_axes(_placed, args, axes, mesh), _placed(rest, mesh)
        return told(loop.progress, run, *given)


def _here(devices) -> int:
    """How many of the devices compute in the memory of this host."""
    host = jax.process_index()
    return sum(one.platform == "cpu" and one.process_index == host for one in devices)


@cache
def _sharded(mesh, axes):
    """The compiled search on a mesh; JAX tells apart what is searched."""

    def run(keys, args, rest):
        loop, optimizer, space, stop, start = rest
        return search(loop, optimizer, space, keys, args, stop, start, None)[0]

    parts = (
        tuple(SPLIT if axis == 0 else COPIED for axis in axes) if isinstance(axes, tuple) else None
    )
    specs = SPLIT, parts or (SPLIT if axes == 0 else COPIED), COPIED
    # No collective is needed, and the carry of a loop starts from constants: skip that check.
    mapped = partial(jax.shard_map, mesh=mesh, in_specs=specs, out_specs=SPLIT, check_vma=False)
    return jax.jit(mapped(run))


def _by_axes(place, args, axes, mesh):
    if isinstance(axes, tuple):
        return tuple(_by_axes(place, *pair, mesh) for pair in zip(args, axes, strict=True))
    return place(args, mesh, SPLIT if axes == 0 else COPIED)


def _placed(tree, mesh, spec=COPIED):
    """Arrays as every host holds them, as one array over the devices of all hosts."""
    sharding = NamedSharding(mesh, spec)

    def place(leaf):
        if not isinstance(leaf, jax.Array | np.ndarray):
            return leaf
        typed = jax.numpy.issubdtype(leaf.dtype, jax.dtypes.prng_key)
        data = np.asarray(jax.random.key_data(leaf) if typed else leaf)
        spread = jax.make_array_from_callback(data.shape, sharding, lambda index: data[index])
        # ``device_put`` of keys reaches no device of another host; their words do.
        return jax.random.wrap_key_data(spread, impl=jax.random.key_impl(leaf)) if typed else spread

    return jax.tree.map(place, tree)
