"""A worker that is killed in the midst of a log costs no log: another one begins it again."""

import os
import signal
from pathlib import Path

import pytest

pytest.importorskip("distributed")

from distributed.scheduler import KilledWorker

from jaxswarm.fleet import schedule
from jaxswarm.fleet.schedule import Cluster, answers, connected
from jaxswarm.fleet.sources import Source


def test_a_log_whose_worker_was_killed_is_done_again(tmp_path, monkeypatch):
    def deadly(address, settings):
        """Kill the worker's process on the first try of one log."""
        place = Path(address)
        tries = len(list(place.parent.glob(f"{place.name}.*")))
        Path(f"{place}.{tries}").touch()
        if place.name == "deadly" and tries == 0:
            os.kill(os.getpid(), signal.SIGKILL)
        return {"stamp": place.name, "result": {"process": os.getpid()}}

    monkeypatch.setattr(schedule, "examine", deadly)
    monkeypatch.setattr(schedule, "start", lambda queue: None)  # nothing is computed there
    names = ["first", "deadly", "last"]
    sources = [Source(str(tmp_path / n), n, n, None, 1) for n in names]
    with connected(Cluster(workers=1)) as client:
        found = {source.path: told for source, told in answers(client, sources, None)}
    assert {n: told["stamp"] for n, told in found.items()} == {n: n for n in names}
    assert len(list(tmp_path.glob("deadly.*"))) >= 2
    assert os.getpid() not in {told["result"]["process"] for told in found.values()}


def test_a_log_that_costs_every_worker_its_life_is_told():
    error = KilledWorker("log", None, 4)
    assert "every worker that began it was lost" in schedule._explained(error)
