"""Motion that was not fitted, within a log: regions of its states, each predicted by a fit to the others.

Exciting motion is periodic, so that a block of time held out repeats one that was fitted. States do not
repeat: rows are grouped by where the joints are and how fast they move, and one group is held out at a
time. What a wrong law has learned in one region it gets wrong in another.
"""

import numpy as np

from jaxswarm.identify.estimation.estimate import Estimate

# Groups that are tried, the least number of them, and of rows in one.
_GROUPS, _FEWEST, _LEAST_ROWS = (6, 4, 3), 3, 15


def regions(found: Estimate) -> np.ndarray | None:
    """Region of every row, (T,); None where the log is too short for any."""
    from scipy.cluster.vq import kmeans2  # asked for only where something is about to be added

    parts = []
    for motion in found.motions:
        kept = motion.decimator.kept(len(motion.t))
        parts.append(np.concatenate([motion.q[kept], motion.dq[kept]], axis=1))
    states = np.concatenate(parts)
    spread = states.std(axis=0)
    states = states[:, spread > 1e-9] / spread[spread > 1e-9]
    labels = []
    for count in _GROUPS if states.shape[1] else ():
        if len(states) < 2 * count * _LEAST_ROWS:
            continue
        _, label = kmeans2(states, count, minit="++", rng=np.random.default_rng(0))
        if (np.bincount(label, minlength=count) >= _LEAST_ROWS).all():
            return label
        labels.append(label)
    # A few rows far from all others, as point-to-point motion has, are a group by themselves of any number.
    joined = (_joined(states, label) for label in labels)
    return next((label for label in joined if label.max() + 1 >= _FEWEST), None)


def _joined(states: np.ndarray, label: np.ndarray) -> np.ndarray:
    """Groups of states (T, d) where each that is too small is one with the group nearest to it."""
    while True:
        label = np.unique(label, return_inverse=True)[1]
        size = np.bincount(label)
        if len(size) == 1 or size.min() >= _LEAST_ROWS:
            return label
        center = np.array([states[label == k].mean(axis=0) for k in range(len(size))])
        small = int(size.argmin())
        apart = np.linalg.norm(center - center[small], axis=1)
        apart[small] = np.inf
        label[label == small] = apart.argmin()
