"""Single samples far off the samples around them: no machine jumps there and back within two samples.

A drive may, and then the joint's speed jumps with its torque: a torque that the motion answers is no spike. Of
a controller that met a step with 216 N m in one sample of 4 ms, which doubled a joint's speed, the torque was
bridged, and a clean log left with 10 times its noise.
"""

from dataclasses import replace

import numpy as np

from jaxswarm.logs.finding import Finding
from jaxswarm.logs.log import Log
from jaxswarm.logs.quality import quantum
from jaxswarm.logs.sampling import sampling

NAME = "spikes"
# A spike is off by this many times the deviation that three quarters of the samples stay below. On 110 clean
# logs, measured ones among them, no sample is off by 20 times; real spikes are by hundreds.
_FAR = 24.0
# Or by so many, which is so many times what any other sample is off by, and the others by no more than that. On
# 100 logs, measured ones among them, one sample of one (KUKA KR300) is off by 16 times and by 3.1 times what is
# elsewhere; spikes as high as a torque's whole range, under noise of a twentieth of it, by 16 and by 4.6 times
# that. Plain noise leaves 4.3 in a million samples: where the others are such there is no tail that a sample
# off by more could belong to, and no channel of 113 logs has one; KUKA's others are off by up to 5.1.
_STANDS_OUT = ((12.0, 4.0, np.inf), (8.0, 1.0, 4.3))
# Samples whose deviation a spike disturbs.
_DISTURBED = 5
# Share of samples whose deviation counts as usual: a spike disturbs five, so five percent of spikes spare it.
_USUAL = 0.75
# More spikes than this share are no accidents: the rest of the channel is not to be trusted either.
_MOST = 0.01
# Neighbors of a sample differ from each other by less than this share of a spike.
_ALIKE = 0.3
_LEAST_SAMPLES = 50


def find_spikes(values: np.ndarray) -> np.ndarray:
    """Whether samples (T,) are spikes: far off a cubic through their neighbors, to one side of both.

    >>> x = np.sin(np.arange(500) * 0.03) + 1e-3 * np.random.default_rng(0).normal(size=500)
    >>> x[200] += 1.0
    >>> np.flatnonzero(find_spikes(x))
    array([200])
    """
    found = np.zeros(len(values), dtype=bool)
    if len(values) < _LEAST_SAMPLES:
        return found
    inner = values[2:-2]
    near = values[1:-3], values[3:-1]
    off = inner - (4.0 * (near[0] + near[1]) - values[:-4] - values[4:]) / 6.0
    usual = max(float(np.quantile(np.abs(off), _USUAL)), quantum(values))
    height = np.minimum(np.abs(inner - near[0]), np.abs(inner - near[1]))
    peak = (inner - near[0]) * (inner - near[1]) > 0
    alike = np.abs(near[0] - near[1]) < _ALIKE * height
    size = np.where(peak & alike, np.minimum(np.abs(off), height), 0.0)
    found[2:-2] = (size > _FAR * usual) | _stands_out(size, np.abs(off), usual)
    return found if usual > 0.0 else np.zeros(len(values), dtype=bool)


def _stands_out(size: np.ndarray, off: np.ndarray, usual: float) -> np.ndarray:
    """Samples that are clearly off where all the others, but for those beside them, are far less so."""
    found = np.zeros(len(size), dtype=bool)
    for least, times, most in _STANDS_OUT:
        clear = size > least * usual
        others = off[np.convolve(clear, np.ones(_DISTURBED), "same") < 0.5]
        if clear.any() and others.size:
            elsewhere = float(others.max())
            alone = size[clear].min() > times * elsewhere and elsewhere < most * usual
            found |= clear & bool(alone)
    return found


def _beside_gaps(log: Log) -> np.ndarray:
    """Samples (T,) with a gap among their neighbors: where a joint turned in it, one looks like a spike."""
    beside = np.zeros(len(log.t), dtype=bool)
    for gap in sampling(log.t, log.q).gaps if len(log.t) > 2 else ():
        beside[max(0, gap.sample - 1) : gap.sample + 3] = True
    return beside


def _answered(torque: np.ndarray, spikes: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Rows (T,) with spikes in which the speed of a joint jumps with its torque, as far as no usual one does.

    What one joint answers is no accident of the others: a controller that decouples them moves all torques.

    Args:
        torque: (T, n).
        spikes: Whether they are spikes, (T, n).
        q: Positions, (T, n).
    """
    rows = np.flatnonzero(spikes.any(axis=1))
    answered = np.zeros(len(q), dtype=bool)
    for x, own in zip(q.T, torque.T, strict=True):
        # Change of the speed from one side of a sample to the other, and what changes it steadily.
        jump = np.zeros(len(x))
        jump[2:-2] = x[4:] - x[3:-1] - (x[1:-3] - x[:-4])
        jump[5:-5] -= 0.5 * (jump[2:-8] + jump[8:-2])
        height = own[rows] - 0.5 * (own[rows - 1] + own[rows + 1])
        usual = max(float(np.quantile(np.abs(jump), _USUAL)), quantum(x))
        answered[rows] |= jump[rows] * np.sign(height) > _FAR * usual
    return answered


def bridged(log: Log) -> tuple[Log, list[Finding]]:
    """The log with spikes of positions and torques bridged, and what was found."""
    findings: list[Finding] = []
    apart = ~_beside_gaps(log)[:, None]
    for quantity, name in (("q", "position"), ("tau", "torque")):
        values = getattr(log, quantity)
        if values is None:
            continue
        bad = np.column_stack([find_spikes(x) for x in values.T]) & apart
        if not bad.any():
            continue
        if quantity == "tau":
            bad &= ~_answered(values, bad, log.q)[:, None]
        mended = values.copy()
        for j in np.flatnonzero(bad.any(axis=0)):
            count, rows = int(bad[:, j].sum()), bad[:, j]
            where = (
                f"{count} samples of the {name} of {log.joints[j]} are spikes, the first at t = "
            )
            what = f"{where}{log.t[np.argmax(rows)]:.6g} s"
            if count <= _MOST * len(rows):
                mended[rows, j] = np.interp(log.t[rows], log.t[~rows], values[~rows, j])
                findings.append(Finding(NAME, what, "They are bridged", refused=False))
            else:
                remedy = "Mend the wiring or the driver, and log it again"
                findings.append(Finding(NAME, what, remedy))
        log = replace(log, **{quantity: mended})
    return log, findings
