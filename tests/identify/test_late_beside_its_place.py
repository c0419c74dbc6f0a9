"""What goes by a joint's position is no late torque, however late it looks; a late torque is one beside it."""

from dataclasses import replace

import numpy as np
import pytest
from test_late_beside_a_line import JOINT, RATE, arm, late, told

from jaxswarm.identify.checks.late import _apart
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import fine_samples
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments

__all__ = ["arm"]


def with_a_stop(arm, size=6.0):
    """A log of a joint that runs into a stop at one end of its way [N m]."""
    log = synthetic_log(arm, (), 3, noise=Noise(2e-5, 0.05), rate=RATE, duration=20.0)
    q = log.q[:, JOINT]
    tau = log.tau.copy()
    tau[:, JOINT] += size * np.exp((q - q.max()) / (0.1 * np.ptp(q)))
    return replace(log, tau=tau)


def left_and_time(arm, log):
    """What a fine model leaves of the joint, and by how much it is late [s], both beside its place and not."""
    fine = Rough(arm, fine_samples(prepare_segments(log, Filtering())[1]))
    sigma = fine.as_logged()[1]
    beside, alone = fine.lateness_beside_its_place(sigma, JOINT), fine.lateness(sigma)
    return [(one.gain[JOINT], _apart(one)[JOINT]) for one in (alone, beside)]


def test_beside_its_place_nothing_of_a_stop_is_late(arm):
    (_, alone), (gain, beside) = left_and_time(arm, with_a_stop(arm))
    assert abs(beside) < 0.3 * abs(alone) and gain > -0.02
    assert told(arm, with_a_stop(arm)) == []


@pytest.mark.parametrize("size", [0.0, 6.0])
def test_a_late_torque_is_as_late_beside_its_place(arm, size):
    log = late(with_a_stop(arm, size), JOINT)
    (_, alone), (_, beside) = left_and_time(arm, log)
    assert beside == pytest.approx(0.02, rel=0.2)
    assert size or beside == pytest.approx(alone, rel=0.2)
    assert told(arm, log) == ["late_torque"]
