r"""The decision: what a candidate is worth on time it was not fitted to, and whether that can be chance.

Every block of time is predicted by the fit to the blocks of the other half, nonlinear parameters
included. The gain of a block is how much the weighted squared error falls. A row of which the fit knows less
than the noise of one row counts by what it knows (:func:`foretold`). A candidate passes if

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
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.decision.event import score_event
from jaxswarm.diagnose.decision.judged import can_be, told_on
from jaxswarm.diagnose.decision.significance import helped, no_more_than, share_of, slope_p_value
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.foretold import foretold
from jaxswarm.diagnose.folds.free_parts import coefficients, free_parts
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.effects.kinds import TransmissionLaw


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
        return score_event(candidate, crossfit, parts[0])
    count = int(crossfit.block.max()) + 1
    joints = crossfit.weight.shape[1]
    gains = np.zeros((count, joints))
    inner, square, size = (np.zeros((count, joints)) for _ in range(3))
    signs, trained = [], 0.0
    for fold, free in zip(crossfit.halves, parts[1:], strict=True):
        a = coefficients(candidate.view(free), fold, candidate.view(fold.residual))
        signs.append(a)
        out = ~fold.train
        predicted, residual = candidate.view(free @ a), candidate.view(fold.residual)
        trained = max(trained, share_of(predicted[fold.train], residual[fold.train]))
        known = foretold(fold.project[out])
        predicted, residual = predicted[out] * known, residual[out] * known
        fall = residual**2 - (residual - predicted) ** 2
        np.add.at(gains, crossfit.block[out], fall)
        np.add.at(inner, crossfit.block[out], predicted * residual)
        np.add.at(square, crossfit.block[out], predicted**2)
        np.add.at(size, crossfit.block[out], residual**2)
    inner, square = no_more_than(size, inner, square)
    before = size.sum(axis=0)
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
        allowed=can_be(candidate, [*signs, whole], p_value, count, interval),
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
        allowed=can_be(seen.candidate, found, p_value, len(inner), interval),
        over_noise=over_noise,
        over_torque=over_torque,
        own=None,
    )


def _sizes(crossfit: CrossFit, per_joint: np.ndarray, joint: int) -> tuple[float, float]:
    """RMS torque that a gain (n,) is worth on a joint, over the noise of each row and over the torque.

    Rows count by their noise. Over the noise of all rows a ripple that took 94 % off a joint at 10.7 times its
    noise was too small to matter: at rest, where its sign may be any, its model was 18 times as uncertain.
    """
    rms = np.sqrt(max(per_joint[joint], 0.0) / len(crossfit.weight))
    rms /= crossfit.weight[:, joint].max()
    return float(rms / crossfit.quiet[joint]), float(rms / max(crossfit.size[joint], 1e-300))
