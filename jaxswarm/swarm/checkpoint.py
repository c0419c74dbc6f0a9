"""Checkpoint and resume: a search that is interrupted goes on as if it had not been.

A state is written as one ``.npz``: every leaf under its path in the tree, and a JSON header with
what it belongs to. The file is written beside its place, flushed to the disk and renamed, so that
at any moment the place holds a whole file, the old or the new one. Reading compares every leaf with
a prototype and refuses what does not fit. Keys are derived from the count of updates, so the state
is all there is.
"""

import dataclasses
import json
import os
import platform
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.swarm.fingerprint import fingerprint
from jaxswarm.swarm.minimize import minimize
from jaxswarm.swarm.optimizers.base import at_least
from jaxswarm.swarm.result import Result
from jaxswarm.swarm.schedules import for_run
from jaxswarm.swarm.space import Space

__all__ = ["minimize_resumable", "restore", "save"]

FORMAT = 2
HEADER = "__header__"


def save(path: str | os.PathLike, tree: Any, **header: Any) -> None:
    """Write a tree of arrays, whole or not at all.

    Args:
      path: file to (re)place; its folder must exist.
      tree: any pytree of arrays, such as ``result.state``.
      **header: JSON values kept with it and compared by :func:`restore`.
    """
    path = Path(path)
    arrays = {name: np.asarray(leaf) for name, leaf in _named_leaves(tree).items()}
    text = json.dumps({"format": FORMAT, **header}, sort_keys=True)
    mark = f".{path.name}.{platform.node() or 'here'}-"
    _sweep(path.parent, mark)
    part = path.with_name(f"{mark}{os.getpid()}.part")
    try:
        with open(part, "wb") as file:
            np.savez(file, **{HEADER: np.array(text)}, **arrays)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)  # the rename itself must reach the disk
    finally:
        os.close(folder)


def _sweep(folder: Path, mark: str) -> None:
    """Remove unfinished files of this checkpoint whose process, on this machine, is no more."""
    for name in os.listdir(folder) if os.name != "nt" else ():  # there, signal 0 ends a process
        process = name.removeprefix(mark).removesuffix(".part")
        if name != f"{mark}{process}.part" or not process.isdigit():
            continue
        try:
            os.kill(int(process), 0)
        except (ProcessLookupError, OverflowError):
            (folder / name).unlink(missing_ok=True)
        except OSError:
            pass  # it lives, but is another user's


def restore(path: str | os.PathLike, like: Any, **header: Any) -> Any:
    """Read what :func:`save` wrote, against a prototype.

    Args:
      path: file to read.
      like: tree of arrays or ``jax.ShapeDtypeStruct`` with the structure, shapes and dtypes
        expected, e.g. from ``jax.eval_shape(optimizer.init, key, num_dims)``.
      **header: what the file must say of itself.

    Raises:
      InputError: not a checkpoint, or of another search: names the first difference.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            stored = {name: file[name] for name in file.files}
        found = dict(json.loads(str(stored.pop(HEADER))))
    except Exception as error:  # parsers raise anything on damaged bytes
        raise InputError(f"{path} is no checkpoint of jaxswarm ({error}).") from error
    for name, expected in {"format": FORMAT, **header}.items():
        if found.get(name) != expected:
            raise InputError(
                f"{path}: {name} is {found.get(name)!r}, expected {expected!r}: it belongs to "
                "another search; remove it or give another path."
            )
    wanted = _named_leaves(like)
    for name in sorted(wanted.keys() ^ stored.keys()):
        where = "is missing" if name in wanted else "is not expected"
        raise InputError(f"{path}: {name} {where}: it belongs to another optimizer or version.")
    for name, leaf in wanted.items():
        here = stored[name]
        if here.shape != leaf.shape or here.dtype != leaf.dtype:
            raise InputError(
                f"{path}: {name} has shape {here.shape} and dtype {here.dtype}, expected "
                f"{leaf.shape} and {leaf.dtype}."
            )
    leaves = [jnp.asarray(stored[name]) for name in wanted]
    return jax.tree_util.tree_unflatten(jax.tree_util.tree_structure(like), leaves)


def minimize_resumable(
    fn: Callable[[Any, Any], jax.Array],
    optimizer: Any,
    space: Space,
    key: jax.Array,
    args: Any = None,
    *,
    num_steps: int,
    path: str | os.PathLike,
    every: int = 100,
    vectorized: bool = False,
    record: Any = None,
) -> Result:
    """Minimize with a checkpoint every ``every`` steps; the same call goes on after a break.

    The result is bit for bit that of the uninterrupted call, and its history covers all steps.

    Args:
      path: the checkpoint; made if missing, gone on from if present. A finished search is returned
        from it without a step.
      every: updates between two checkpoints.
      fn, optimizer, space, key, args, num_steps, vectorized, record: as for ``minimize``; data are
        not stored, so give the same ones again.

    Raises:
      InputError: the checkpoint belongs to another optimizer, space, key or number of steps. A
        search goes on beyond the ``num_steps`` it was begun with only if its schedules have lengths
        of their own: those that last as long as the run would have been others from the start.
    """
    at_least("every", every, 1, "a checkpoint follows a step")
    # Once, for all pieces: a schedule that lasts as long as the run must know the whole of it.
    optimizer = for_run(optimizer, float(at_least("num_steps", num_steps, 1, "nothing to do")))
    header = dict(
        optimizer=fingerprint(optimizer),
        space=[
            list(space.names),
            np.asarray(space.lower).tolist(),
            np.asarray(space.upper).tolist(),
        ],
        key=_key_words(key),
    )
    run = dict(vectorized=vectorized, record=record)
    result, done = None, 0
    if Path(path).exists():
        # The prototype's history grows with the steps done, which only the file knows.
        done = min(_steps_done(path), num_steps)
        result = _restore_result(path, fn, optimizer, space, key, args, done, run, header)
    while done < num_steps:
        size = min(every, num_steps - done)
        state = None if result is None else result.state
        new = minimize(fn, optimizer, space, key, args, num_steps=size, state=state, **run)
        result = new if result is None else _joined(result, new)
        done += size
        save(path, result, steps=done, **header)
    return result


def _restore_result(path, fn, optimizer, space, key, args, done, run, header):
    def build(key, args):
        return minimize(fn, optimizer, space, key, args, num_steps=done, **run)

    like = jax.eval_shape(build, key, args)
    return restore(path, like, steps=done, **header)


def _joined(old: Result, new: Result) -> Result:
    history = jax.tree.map(lambda a, b: jnp.concatenate([a, b]), old.history, new.history)
    return dataclasses.replace(
        new,
        history=history,
        num_steps=old.num_steps + new.num_steps,
        num_evaluations=old.num_evaluations + new.num_evaluations,
    )


def _steps_done(path) -> int:
    try:
        with np.load(path, allow_pickle=False) as file:
            return int(json.loads(str(file[HEADER]))["steps"])
    except Exception as error:  # as above
        raise InputError(f"{path} is no checkpoint of a search ({error}).") from error


def _named_leaves(tree: Any) -> dict[str, Any]:
    leaves = jax.tree_util.tree_flatten_with_path(tree)[0]
    return {jax.tree_util.keystr(path): leaf for path, leaf in leaves}


def _key_words(key: jax.Array) -> list[int]:
    data = jax.random.key_data(key) if jnp.issubdtype(key.dtype, jax.dtypes.prng_key) else key
    return np.asarray(data).tolist()
