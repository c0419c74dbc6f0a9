"""Logs on Dask: one task each, on a cluster of this machine or one that exists.

Workers have one thread each, as every log is one chain of work, and share the compile cache on disk. Only
as many logs are handed over at a time as keep the workers busy, so that the scheduler's memory does not
grow with the fleet. A task whose worker is lost is done again by another one; one that has cost several
workers their lives, of too little memory for example, is given up with that reason.
"""

import logging
import os
import signal
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import Any

from jaxswarm.errors import InputError
from jaxswarm.fleet.one_log import FAILED, Settings, examine, unused
from jaxswarm.fleet.sources import Source
from jaxswarm.memory import refuse_beyond_free
from jaxswarm.runtime import start

# Tasks handed over for every worker, and the least of them: an adaptive cluster grows by what waits.
_AHEAD, _LEAST = 4, 64
# Memory [GiB] of a worker that has loaded everything.
_WORKER = 0.4
# Times a task is begun again where its worker was lost.
_RETRIES = 2
# Time [s] in which an existing scheduler has to answer.
_PATIENCE = 10.0


@dataclass(frozen=True)
class Cluster:
    """Where logs are worked on.

    Attributes:
        workers: Processes of this machine; None: one for every core.
        scheduler: Address of an existing scheduler, in place of them.
        adaptive: Whether the number of workers follows the work, up to ``workers``.
        processes: Whether workers are processes; threads of this one serve small tests.
    """

    workers: int | None = None
    scheduler: str | None = None
    adaptive: bool = False
    processes: bool = True


@contextmanager
def connected(cluster: Cluster) -> Iterator[Any]:
    """A client of the cluster; a cluster of this machine ends with it.

    Raises:
        InputError: If the scheduler does not answer, or no worker can be started.
    """
    from distributed import Client, LocalCluster

    # What happens to a task is told by its answer; Dask's own account of it is for its developers.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    own = None
    if cluster.scheduler is None:
        count = cluster.workers or _cores()
        if cluster.processes and cluster.workers:
            refuse_beyond_free(_WORKER * count, f"{count} workers take", "ask for fewer --workers")
        try:
            own = LocalCluster(
                n_workers=0 if cluster.adaptive else count,
                threads_per_worker=1,
                processes=cluster.processes,
                dashboard_address=":0",  # whichever port is free
                silence_logs=logging.CRITICAL,
            )
        except (OSError, RuntimeError) as error:
            raise InputError(
                f"--workers {count}: they cannot be started ({type(error).__name__}: {error}). Ask for fewer; "
                'in a script, call it below if __name__ == "__main__": each worker reads the script again'
            ) from None
        if cluster.adaptive:
            own.adapt(minimum=1, maximum=count)
    try:
        client = Client(own or cluster.scheduler, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise InputError(
            f"--scheduler {cluster.scheduler}: does not answer ({type(error).__name__}); give its "
            "address as tcp://host:8786"
        ) from None
    try:
        client.register_plugin(_preparation())
        yield client
    except BaseException:
        _kill(own)
        raise
    finally:
        with suppress(Exception):  # the end of the work must not be hidden by a worker that hangs
            client.close(timeout=_PATIENCE)
        if own is not None:
            with suppress(Exception):
                own.close(timeout=_PATIENCE)


def answers(
    client: Any, sources: Iterable[Source], settings: Settings
) -> Iterator[tuple[Source, dict]]:
    """What comes of every log, in the order in which they are done; see :func:`examine`."""
    from distributed import as_completed

    todo, under_way = iter(sources), dict[Any, Source]()
    finished = as_completed(loop=client.loop)

    def hand_over(most: int) -> None:
        while len(under_way) < most and (source := next(todo, None)) is not None:
            future = client.submit(examine, source.address, settings, pure=False, retries=_RETRIES)
            under_way[future.key] = source
            finished.add(future)

    hand_over(_ahead(client))
    try:
        for future in finished:
            source = under_way.pop(future.key)
            yield source, _answer(future)
            future.release()
            hand_over(_ahead(client))
    finally:
        with suppress(Exception):
            client.cancel(list(finished.futures), force=True)


def _kill(own: Any) -> None:
    """End worker processes in the midst of their work: asked politely, they would first finish it."""
    for nanny in own.workers.values() if own is not None else ():
        with suppress(AttributeError, OSError):  # a thread of this process, or gone already
            nanny.auto_restart = False
            os.kill(nanny.pid, signal.SIGKILL)


def _preparation() -> Any:
    """Sets in every worker what every process sets before it computes; in those that come later too."""
    from distributed import WorkerPlugin

    class Prepare(WorkerPlugin):
        name = "jaxswarm-start"

        def setup(self, worker: Any) -> None:
            start(queue=False)

    return Prepare()


def _ahead(client: Any) -> int:
    return max(_LEAST, _AHEAD * len(client.nthreads()))


def _answer(future: Any) -> dict:
    if future.status == "finished":
        return future.result()
    error = future.exception() if future.status == "error" else None
    if error is None:
        return {"stamp": None, **unused(FAILED, f"the task was {future.status}")}
    return {"stamp": None, **unused(FAILED, _explained(error))}


def _explained(error: BaseException) -> str:
    from distributed.scheduler import KilledWorker

    if isinstance(error, KilledWorker):
        return (
            "every worker that began it was lost, probably for want of memory: use fewer --workers, "
            "shorter logs or a lower rate"
        )
    return f"{type(error).__name__}: {(str(error).splitlines() or [''])[0]}"


def _cores() -> int:
    from dask.system import CPU_COUNT

    return CPU_COUNT


def by_size(sources: Iterable[Source]) -> list[Source]:
    """Largest first: what takes longest does not come last, and logs of like length meet one program."""
    return sorted(sources, key=lambda source: (-source.size, source.path))
