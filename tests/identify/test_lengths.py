"""Logs of another length need no further programs, and their numbers are those of the log alone."""

import numpy as np
import pytest

from jaxswarm.diagnose.candidates.link_lag import lag_torque
from jaxswarm.effects import REGISTRY
from jaxswarm.effects.deflection import deflection
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.series import law_columns
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward import columns
from jaxswarm.identify.forward.joint_series import joint_series
from jaxswarm.identify.forward.lengths import CHUNK
from jaxswarm.identify.forward.link_lag import calm_start
from jaxswarm.identify.forward.sensitivity import sensitivity_of
from jaxswarm.identify.forward.written_down import report
from jaxswarm.identify.synthetic import fourier_motion, random_links
from jaxswarm.logs import log_from_arrays
from jaxswarm.logs.motion import Filtering, prepare
from jaxswarm.robot import robot_from_dh

LAWS = sorted(n for n, law in REGISTRY.items() if isinstance(law, TorqueLaw) and law.linear)


def arm():
    bare = robot_from_dh(
        "two", convention="modified", alpha=[np.pi / 2, 0.3], a=[0.0, 0.35], d=[0.0, 0.1]
    )
    return bare.replace(parameters=random_links(bare, np.random.default_rng(0), mass=6.0))


def motion(samples):
    t, q, dq, _ = fourier_motion(2, np.random.default_rng(1), samples / 125.0, 125.0)
    heat = 25.0 + np.stack([t, 2 * t], axis=1)
    log = log_from_arrays(t, q, dq, joints=("joint1", "joint2"), channels={"temperature": heat})
    return prepare(log, Filtering(20.0, 10.0))


@pytest.mark.parametrize("name", LAWS)
def test_columns_of_a_law_are_those_of_the_log_alone(name):
    law, seen = REGISTRY[name], motion(CHUNK - 200)
    other = 1 if law.scope == "pair" else None
    values = {p.name: p.nominal for p in law.nonlinear}
    found = columns.term_columns(Term(name, 0, other, values=values), seen, (0.01, 0.01))
    series = joint_series(seen, (0.01, 0.01), None, 0, other)
    np.testing.assert_allclose(found, law_columns(law, values, series), rtol=1e-12, atol=1e-12)


def test_a_log_of_another_length_compiles_no_law_again():
    term = Term("viscous_friction", 0)
    columns.term_columns(term, motion(CHUNK - 200), (0.01, 0.01))
    programs = columns._law.made
    for samples in (CHUNK - 150, CHUNK - 7):
        seen = motion(samples)
        assert len(columns.term_columns(term, seen, (0.01, 0.01))) == len(seen.t)
    assert columns._law.made == programs


def test_the_lag_of_a_link_is_that_of_the_log_alone_and_compiles_once():
    robot = arm()
    pi = np.asarray(robot.parameters).ravel()
    gear = [np.array([x]) for x in (500.0, 2.0, 0.0, 0.0)]
    long = motion(CHUNK - 150)
    lag_torque(long, sensitivity_of(robot, long, 0), pi[None], *gear)
    programs = deflection.made
    seen = motion(CHUNK - 200)
    sensed = sensitivity_of(robot, seen, 0)
    found = lag_torque(seen, sensed, pi[None], *gear)
    assert deflection.made == programs
    torque, by_q, by_dq, by_ddq = (x[:, 0] for x in sensed.at(pi))
    clock = 1.0 / seen.rate, calm_start(seen), 2
    e, v, a = deflection(by_ddq, by_dq, by_q, torque, 500.0, 2.0, 0.0, 0.0, *clock)
    _, by_q, by_dq, by_ddq = sensed.at(pi)
    change = -(
        np.outer(e, [1, 1]) * by_q + np.outer(v, [1, 1]) * by_dq + np.outer(a, [1, 1]) * by_ddq
    )
    np.testing.assert_allclose(found[0], seen.decimator.apply(change), rtol=1e-9, atol=1e-9)


def test_a_late_clock_holds_the_end_of_the_log_as_before():
    seen = motion(CHUNK - 200)
    late = report((Term("time_delay", values={"seconds": -0.02}),), seen, seen.dq[:, :, None])
    assert late.shape == (*seen.dq.shape, 1)
    np.testing.assert_allclose(late[-1, :, 0], seen.dq[-1], rtol=1e-12)
