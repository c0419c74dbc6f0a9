"""Logs of a small fleet on disk, and the fleet diagnosed in this process."""

from dataclasses import replace
from functools import cache

import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.fleet.run import diagnose_fleet
from jaxswarm.fleet.schedule import Cluster
from jaxswarm.identify.synthetic import random_links, synthetic_log
from jaxswarm.logs import write_log
from jaxswarm.robot import rx60

HERE = Cluster(workers=1, processes=False)
DECLARED = "viscous_friction,coulomb_friction"
COGGING = Term("torque_ripple", 0, values={"sine": 0.9, "cosine": 0.7, "n": 22.0})


@cache
def arm():
    """The RX60 with drawn physical links."""
    return rx60().replace(parameters=random_links(rx60(), np.random.default_rng(0)))


def write_rx60(path, seed, *hidden, seconds=10.0):
    """A log with friction on every joint, and hidden effects."""
    friction = [
        Term(name, j, values={symbol: 4.0 / (1 + j)})
        for name, symbol in (("viscous_friction", "b"), ("coulomb_friction", "fc"))
        for j in range(3)
    ]
    log = synthetic_log(arm(), (*friction, *hidden), seed, duration=seconds, rate=125.0)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_log(replace(log, channels={}), path)


def diagnosed(logs, out, robot="rx60", **options):
    """The fleet, by one worker in this process."""
    return diagnose_fleet(str(logs), robot, out, declare=DECLARED, cluster=HERE, **options)
