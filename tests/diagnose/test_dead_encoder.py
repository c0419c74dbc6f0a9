"""A joint whose encoder is dead is told apart from one that is held."""

from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, DECLARED, log_with, small_arm

from jaxswarm.errors import InputError
from jaxswarm.identify.checks.check_log import checked
from jaxswarm.identify.forward.model import Model, model_torque
from jaxswarm.logs.motion import Filtering, prepare


def held(joint):
    """A log in which a joint does not move, with the torque that this needs."""
    log = log_with()
    q = log.q.copy()
    q[:, joint] = 0.3
    motion = prepare(replace(log, q=q, channels={}), BAND)
    friction = tuple(t for t in DECLARED if t.joint != joint)
    arm = small_arm()
    model = Model(arm, friction, (0.01,) * 2, Filtering(), (1.0,) * 2)
    noise = np.random.default_rng(0).normal(size=motion.q.shape)
    tau = model_torque(model, motion) + 0.1 * noise
    return replace(log, t=motion.t, q=motion.q, tau=tau, dq=None, channels={})


@pytest.mark.parametrize("joint", [0, 1])
def test_a_frozen_position_is_refused_by_name(joint):
    log = log_with()
    q = log.q.copy()
    q[:, joint] = q[0, joint]
    frozen = replace(log, q=q, dq=None)
    with pytest.raises(InputError, match=f"stuck: the position of joint{joint + 1} never changes"):
        checked(frozen, small_arm(), BAND)
    again, _ = checked(frozen, small_arm(), BAND, ("stuck",))
    assert any("never changes" in note for note in again.notes)


@pytest.mark.parametrize("joint", [0, 1])
def test_a_held_joint_is_no_dead_encoder(joint):
    log, _ = checked(held(joint), small_arm(), BAND)
    assert not any("stuck" in note for note in log.notes)
    braked = log.tau.copy()
    braked[:, joint] = 0.2 + 0.05 * np.random.default_rng(1).normal(size=len(braked))
    log, _ = checked(replace(held(joint), tau=braked), small_arm(), BAND)
    assert not any("stuck" in note for note in log.notes)
