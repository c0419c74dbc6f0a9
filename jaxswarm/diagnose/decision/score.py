r"""The decision: what a candidate is worth on time it was not fitted to, and whether that can be chance.

Every block of time is predicted by the fit to the blocks of the other half, nonlinear parameters
included. The gain of a block is how much the weighted squared error falls. A candidate passes if

* what it predicts for unseen blocks is in the residual there: the slope of the residual on the prediction
  is positive beyond chance. Its standard error is the jackknife over blocks, which are longer than the
  residual's memory, so neither autocorrelation nor one lucky block can feign evidence; the level is
  divided by the number of candidates asked;
* it takes off at least a given share of its joints' squared error, beyond what it spends;
* it helps in most blocks that carry a tenth of the mean gain or more; and its coefficients have the sign
  physics wants, in both halves.

Reference: J. G. MacKinnon, M. O. Nielsen, M. D. Webb, J. Appl. Econometrics 38 (2023) for the cluster
jackknife.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from jaxswarm.decomposition import lstsq
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.contact import loudest
from jaxswarm.diagnose.decision.judged import can_be, told_on
from jaxswarm.diagnose.decision.rules import MOST_TAKEN, OTHERS, SELECTED, Rules
from jaxswarm.diagnose.decision.significance import (
    helped,
    share_of,
    slope_p_value,
    stands_out,
)
from jaxswarm.diagnose.folds.free_parts import free_parts
from jaxswarm.diagnose.folds.partial_out import CrossFit, Fold
from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.identify.estimation.covariance import correlation_length


@dataclass(frozen=True)
class Score:
    """What a candidate is worth on held-out time.

    Attributes:
        candidate: Who.
        gain: Fall of the weighted squared error, all joints.
        per_joint: The same per joint, shape (n,).
        blocks: Per block, shape (B,).
        share: Share of its joint's squared error taken off.
        trained: The same on the rows it was fitted to, where it is largest.
        joint: The joint where that is.
        p_value: One-sided, that the prediction is not in the residual of unseen blocks.
        repeats: Share of blocks in which it helps.
        coefficients: Linear coefficients of the whole fit, (k,).
        allowed: Whether signs agree with physics.
        over_noise, over_torque: RMS torque that it takes off its joint's error, over that of the noise
            and of the torque; events are scored by their own torque instead.
        own: Per block, on its own joint, (B,); None where it does not show there, or not there alone.
        on_all: The same candidate judged by all joints, of a law by which links move otherwise than motors.
    """

    candidate: Candidate
    gain: float
    per_joint: np.ndarray
    blocks: np.ndarray
    share: float
    trained: float
    joint: int
    p_value: float
    repeats: float
    coefficients: np.ndarray
    allowed: bool
    over_noise: float = np.inf
    over_torque: float = np.inf
    own: np.ndarray | None = None
    on_all: "Score | None" = None

    @property
    def worth(self) -> float:
        """Gain on its own joint if it shows there, else on all.

        Half a short log may know so little of what joints share that the others lose more than its own gains:
        bristles that took 96 % off their joint's error at p = 1e-12 had a gain below zero in all.
        """
        return self.gain if self.own is None else float(self.own.sum())

    def beside(self, other: "Score") -> np.ndarray:
        """Gain per block (B,) by which it is compared: on their joint if both show on the same one."""
        return self.own if self.own is not None and self.shows_with(other) else self.blocks

    def judged_as(self, other: "Score") -> "Score":
        """The same candidate by all joints, where it has such a score and the other one is by all joints."""
        return self.on_all if self.on_all is not None and other.own is None else self

    def shows_with(self, other: "Score") -> bool:
        """Whether both show on one and the same joint of their own."""
        return self.own is not None and other.own is not None and self.joint == other.joint


def coefficients(free: np.ndarray, fold: Fold, residual: np.ndarray | None = None) -> np.ndarray:
    """Least-squares coefficients (k,) of free columns (T, n, k) on the training rows."""
    residual = fold.residual if residual is None else residual
    rows = free[fold.train].reshape(-1, free.shape[2])
    scale = np.linalg.norm(rows, axis=0)
    scale[scale == 0] = 1.0
    return lstsq(rows / scale, residual[fold.train].ravel(), rcond=1e-6) / scale


def score(
    candidate: Candidate,
    crossfit: CrossFit,
    interval: float = 0.0,
    parts: Sequence[np.ndarray] | None = None,
) -> Score:
    """Fit a candidate on each half and score it on the other.

    ``interval``: the log's [s], by which a delay is told from its own; ``parts``: free parts where known.
    """
    parts = parts or next(free_parts([candidate.columns], crossfit))
    if candidate.term.law.recurring:
        return _score_event(candidate, crossfit, parts[0])
    count = int(crossfit.block.max()) + 1
    joints = crossfit.weight.shape[1]
    gains = np.zeros((count, joints))
    before = np.zeros(joints)
    inner, square = np.zeros((count, joints)), np.zeros((count, joints))
    signs, trained = [], 0.0
    for fold, free in zip(crossfit.halves, parts[1:], strict=True):
        a = coefficients(candidate.view(free), fold, candidate.view(fold.residual))
        signs.append(a)
        out = ~fold.train
        predicted, residual = candidate.view(free @ a), candidate.view(fold.residual)
        trained = max(trained, share_of(predicted[fold.train], residual[fold.train]))
        predicted, residual = predicted[out], residual[out]
        fall = residual**2 - (residual - predicted) ** 2
        np.add.at(gains, crossfit.block[out], fall)
        np.add.at(inner, crossfit.block[out], predicted * residual)
        np.add.at(square, crossfit.block[out], predicted**2)
        before += (residual**2).sum(axis=0)
    whole = coefficients(parts[0], crossfit.whole)
    per_joint = gains.sum(axis=0)
    blocks = gains.sum(axis=1)
    joint, told = told_on(candidate.term, per_joint / before)
    p_value = slope_p_value(inner[:, told].sum(axis=1), square[:, told].sum(axis=1))
    own = gains[:, told].sum(axis=1)
    over_noise, over_torque = _sizes(crossfit, per_joint, joint)
    seen = Score(
        candidate=candidate,
        gain=float(blocks.sum()),
        per_joint=per_joint,
        blocks=blocks,
        share=float(per_joint[joint] / before[joint]),
        trained=trained,
        joint=joint,
        p_value=p_value,
        repeats=helped(own),
        coefficients=whole,
        allowed=can_be(candidate, [*signs, whole], p_value, interval),
        over_noise=over_noise,
        over_torque=over_torque,
        own=None if told == slice(None) else own,
    )
    sums = inner, square, before
    return replace(seen, on_all=_on_all(seen, crossfit, sums, [*signs, whole], interval))


def _on_all(
    seen: Score,
    crossfit: CrossFit,
    sums: tuple[np.ndarray, ...],
    found: Sequence[np.ndarray],
    interval: float,
) -> Score | None:
    """The score of a transmission by all joints, from sums over blocks and halves; None of other laws."""
    if not isinstance(seen.candidate.term.law, TransmissionLaw):
        return None
    inner, square, before = sums
    joint = int(np.argmax(seen.per_joint / before))
    p_value = slope_p_value(inner.sum(axis=1), square.sum(axis=1))
    over_noise, over_torque = _sizes(crossfit, seen.per_joint, joint)
    return replace(
        seen,
        share=float(seen.per_joint[joint] / before[joint]),
        joint=joint,
        p_value=p_value,
        repeats=helped(seen.blocks),
        allowed=can_be(seen.candidate, found, p_value, interval),
        over_noise=over_noise,
        over_torque=over_torque,
        own=None,
    )


def _sizes(crossfit: CrossFit, per_joint: np.ndarray, joint: int) -> tuple[float, float]:
    """RMS torque that a gain (n,) is worth on a joint, over that of the noise and of the torque."""
    rms = np.sqrt(max(per_joint[joint], 0.0) / len(crossfit.weight))
    rms /= crossfit.weight[:, joint].max()
    return float(rms / crossfit.noise[joint]), float(rms / max(crossfit.size[joint], 1e-300))


def _score_event(candidate: Candidate, crossfit: CrossFit, free: np.ndarray) -> Score:
    """What a window of time is worth: no other time can tell, so that it has to stand out by itself.

    Neither it nor what a few other windows show is error of which it takes a share, or memory of the noise that
    it is told against. The share is that of the squared torque, not bounded as in the gain: the few samples of
    an event are what the bounds are made against.
    """
    whole, weight = crossfit.whole, crossfit.weight
    inside: np.ndarray = np.any(candidate.columns[0], axis=(1, 2))
    timing = crossfit.timing
    free, residual = free * timing[:, :, None], whole.residual * timing
    a = coefficients(free, whole, residual)
    predicted = free @ a
    fall = residual**2 - (residual - predicted) ** 2
    left, one_log = residual - predicted, np.zeros(len(residual))
    pushes = weight * timing * ~inside[:, None]
    others = loudest(pushes, left, one_log, OTHERS, stands_out)
    if others.any():  # what they did to the fit is no memory either
        quiet = ~(inside | others)
        left = whole.trained_on(quiet).residual * timing * quiet[:, None]
    raw = np.divide(1.0, weight**2, where=weight > 0, out=np.zeros_like(weight))
    shares = (fall * raw).sum(axis=0) / np.maximum((residual**2 * raw)[~others].sum(axis=0), 1e-300)
    joint, per_joint = int(np.argmax(shares)), fall.sum(axis=0)
    gain = float(per_joint.sum())
    memory = correlation_length(left, one_log)
    windows = len(residual) / max(int(inside.sum()), 1)
    blocks = np.bincount(crossfit.block, fall.sum(axis=1))
    chance = scipy.special.chdtrc(weight.shape[1], max(gain, 0.0) / memory / SELECTED) * windows
    dense = stands_out(float(shares[joint]), 1.0 / windows)
    return Score(
        candidate=candidate,
        gain=gain,
        per_joint=per_joint,
        blocks=blocks,
        share=float(shares[joint]),
        trained=float(shares[joint]),
        joint=joint,
        p_value=float(min(1.0, chance)),
        repeats=1.0,
        coefficients=a,
        allowed=dense and inside.mean() <= MOST_TAKEN,
    )


def passes(item: Score, asked: int, rules: Rules) -> bool:
    """Whether a candidate passes, alone against the current model."""
    return (
        item.allowed
        and item.worth > 0
        and item.p_value * asked < rules.significance
        and item.share >= rules.share
        and item.repeats >= rules.repeat
        and item.over_noise >= rules.over_noise
        and item.over_torque >= rules.over_torque
    )
