"""Whether a load between two times is one: its torques follow the arm, as no constant ones do."""

import numpy as np

from jaxswarm.diagnose.decision.common_error import p_value_beside_fit
from jaxswarm.diagnose.decision.rules import CARRIED
from jaxswarm.diagnose.decision.score import score
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.partial_out import CrossFit


def is_carried(item: Score, crossfit: CrossFit) -> bool:
    """Whether a body that is carried for a while explains what constant torques in that time leave.

    A mass loads every joint by the arm's posture. Half a newton meter by which the zero of a torque had
    wandered was told as 0.1 kg picked up at 8.3 s, and noise with a memory of seconds as a load of -0.1 kg.
    """
    joints = np.eye(crossfit.weight.shape[1])
    steady = tuple(
        crossfit.weigh(np.any(columns, axis=(1, 2), keepdims=True) * joints)
        for columns in item.candidate.columns
    )
    beside = crossfit.with_columns(steady)
    return p_value_beside_fit(score(item.candidate, beside), beside) < CARRIED
