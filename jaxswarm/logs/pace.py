"""A clock in milliseconds that passes for one in seconds: all stands nearly still, a few times a second.

Of a log of one kilohertz and less such a clock shows by itself, no motion is logged every second. One of five
kilohertz seems to have five samples a second.
"""

import numpy as np

from jaxswarm.logs.finding import Finding
from jaxswarm.logs.log import Log
from jaxswarm.logs.sampling import usual_period

# Periods [s] that logs of 2 to 10 kHz have in milliseconds, read as seconds; longer ones are refused at once.
_PERIODS = 0.1, 0.5
# Speed [rad/s or m/s] below which nothing creeps: tests of friction do at a degree a second (0.017), and the
# wrist of a fast arm (TX40) turns at 11.9 in true seconds.
_CREEPING = 0.015
# Travel [rad or m] of a log with a motion.
_TRAVEL = 0.05


def slow_clock(log: Log) -> list[Finding]:
    """What is told of a clock by which an arm creeps, sampled as seldom as no creeping needs.

    >>> t = np.arange(5000) * 0.2
    >>> fast = Log("demo", ("joint1",), t, np.sin(2e-3 * t)[:, None])
    >>> [finding.check for finding in slow_clock(fast)]
    ['time_scale']
    """
    if len(log.t) < 3 or not _PERIODS[0] <= usual_period(log.t) <= _PERIODS[1]:
        return []
    fastest = float(np.max(np.abs(np.diff(log.q, axis=0)) / np.diff(log.t)[:, None]))
    if fastest > _CREEPING or float(np.ptp(log.q, axis=0).max()) < _TRAVEL:
        return []
    what = (
        f"with {1.0 / usual_period(log.t):.2g} samples a second no joint moves faster than {fastest:.2g} rad/s "
        "(m/s): time seems to be in milliseconds"
    )
    return [Finding("time_scale", what, "Name the unit: --columns t:ms")]
