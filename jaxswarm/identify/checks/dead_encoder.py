"""A position that never changes while the torque of its joint goes on as in a motion.

A joint that is held needs the torque that the others' motion asks of it, which is linear in the parameters of
the links. What a moving joint needs beside that (its own friction and inertia, the weight of its links on their
way) no motion of the others explains.
"""

import numpy as np

from jaxswarm.decomposition import lstsq
from jaxswarm.identify.checks.channels import STANDS
from jaxswarm.identify.checks.samples import Samples
from jaxswarm.logs.finding import Finding
from jaxswarm.logs.frozen import STUCK
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot

# Share of a standing joint's torque that the others' motion leaves, from which on it moves: what a held joint
# needs is explained but for noise and for stiction; moving joints of a small arm left half of it and more.
_LEFT = 0.25
# A torque below this part of the median of the other joints', or that changes from sample to sample by this
# part of all its change, is that of a brake: the motor does nothing.
_IDLE, _ROUGH = 0.05, 0.5


def dead_encoders(robot: Robot, samples: Samples) -> list[Finding]:
    """Joints whose position stands, to the last digit, although they move."""
    standing = np.ptp(samples.q, axis=0) < STANDS
    if not standing.any() or standing.all():
        return []
    columns = rigid_columns(robot, samples.q, samples.dq, samples.ddq)
    size = samples.tau.std(axis=0)
    found = []
    for j in np.flatnonzero(standing):
        torque, own = samples.tau[:, j] - samples.tau[:, j].mean(), columns[:, j]
        step = np.diff(torque).std()
        if size[j] < _IDLE * np.median(size[~standing]) or step > _ROUGH * size[j]:
            continue
        rows = own - own.mean(axis=0)
        left = torque - rows @ lstsq(rows, torque, rcond=1e-9)
        share = float((left**2).sum() / max((torque**2).sum(), 1e-300))
        if share > _LEFT:
            what = (
                f"the position of {robot.joints[j]} never changes, and the motion of the other joints leaves "
                f"{100 * share:.0f} % of its torque: it moved"
            )
            found.append(Finding(STUCK, what, "Check its encoder and its wiring, and log it again"))
    return found
