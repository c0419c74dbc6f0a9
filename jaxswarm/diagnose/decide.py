r"""The decision: what a suspect is worth on time it was not fitted to, and whether that can be chance.

Every block of time is predicted by the fit to the blocks of the other half, nonlinear parameters
included. The gain of a block is how much the weighted squared error falls. A suspect passes if

* the mean gain over blocks is significant (one-sided t over blocks, which are longer than the residual's
  memory, so that autocorrelation cannot feign evidence), after Holm-Bonferroni for all suspects asked;
* it takes off at least a given share of its joints' squared error, beyond what it spends;
* it helps in most blocks that carry a tenth of the mean gain or more; and its coefficients have the sign
  physics wants, in both halves.

References: S. Holm, Scand. J. Stat. 6 (1979); Q. H. Vuong, Econometrica 57 (1989) for the comparison of
rivals; D. Rivers, Q. H. Vuong, Econometrics J. 5 (2002) for doing it under autocorrelation.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from jaxswarm.diagnose.background import Background, Fold
from jaxswarm.diagnose.candidates import Candidate


@dataclass(frozen=True)
class Rules:
    """Thresholds of the decision.

    Attributes:
        significance: Chance that anything is added to a log without a missing effect.
        share: Least share of a joint's held-out squared error that an effect has to take off.
        repeat: Least share of blocks in which it has to help.
        tie: Rivals whose gains differ by fewer standard errors than this are not told apart.
    """

    significance: float = 0.01
    share: float = 0.05
    repeat: float = 0.6
    tie: float = 2.0


@dataclass(frozen=True)
class Score:
    """What a candidate is worth on held-out time.

    Attributes:
        candidate: Who.
        gain: Fall of the weighted squared error, all joints.
        per_joint: The same per joint, shape (n,).
        blocks: Per block, shape (B,).
        share: Largest share of a joint's squared error taken off.
        joint: The joint where that is.
        p_value: One-sided, for the mean over blocks.
        repeats: Share of blocks in which it helps.
        coefficients: Linear coefficients of the whole fit, (k,).
        allowed: Whether signs agree with physics.
    """

    candidate: Candidate
    gain: float
    per_joint: np.ndarray
    blocks: np.ndarray
    share: float
    joint: int
    p_value: float
    repeats: float
    coefficients: np.ndarray
    allowed: bool


def coefficients(free: np.ndarray, fold: Fold) -> np.ndarray:
    """Least-squares coefficients (k,) of free columns (T, n, k) on the training rows."""
    rows = free[fold.train].reshape(-1, free.shape[2])
    scale = np.linalg.norm(rows, axis=0)
    scale[scale == 0] = 1.0
    return np.linalg.lstsq(rows / scale, fold.residual[fold.train].ravel(), rcond=1e-6)[0] / scale


def score(candidate: Candidate, background: Background) -> Score:
    """Fit a candidate on each half and score it on the other."""
    count = int(background.block.max()) + 1
    joints = len(background.sigma)
    gains = np.zeros((count, joints))
    before = np.zeros(joints)
    signs = []
    for fold, columns in zip(background.halves, candidate.columns[1:], strict=True):
        free = fold.free_part(columns)
        a = coefficients(free, fold)
        signs.append(a)
        out = ~fold.train
        error = fold.residual[out] - free[out] @ a
        fall = fold.residual[out] ** 2 - error**2
        np.add.at(gains, background.block[out], fall)
        before += (fold.residual[out] ** 2).sum(axis=0)
    whole = coefficients(background.whole.free_part(candidate.columns[0]), background.whole)
    per_joint = gains.sum(axis=0)
    blocks = gains.sum(axis=1)
    joint = candidate.term.joint
    if joint is None:
        joint = int(np.argmax(per_joint / before))
    # A joint effect is a matter of its own joint; others may gain through shared parameters.
    share = float(max(per_joint[joint] / before[joint], (per_joint / before).max()))
    spread = blocks.std(ddof=1) / np.sqrt(count)
    t = blocks.mean() / max(spread, 1e-300)
    allowed = not candidate.positive or all(s[0] > 0 for s in (*signs, whole))
    weighty = np.abs(blocks) > 0.1 * abs(blocks.mean())
    return Score(
        candidate=candidate,
        gain=float(blocks.sum()),
        per_joint=per_joint,
        blocks=blocks,
        share=share,
        joint=joint,
        p_value=float(stats.t.sf(t, count - 1)),
        repeats=float((blocks[weighty] > 0).mean()) if weighty.any() else 0.0,
        coefficients=whole,
        allowed=bool(allowed),
    )


def passes(item: Score, asked: int, rules: Rules) -> bool:
    """Whether a suspect is guilty, alone against the current model."""
    # A touch happens once: it cannot repeat over blocks, so its window must explain far more.
    once = item.candidate.term.effect == "contact"
    significant = item.p_value * asked < rules.significance
    if once:
        spent = item.candidate.size
        significant = item.gain > 40.0 * spent
    return (
        item.allowed
        and item.gain > 0
        and significant
        and item.share >= rules.share
        and (once or item.repeats >= rules.repeat)
    )


def difference(one: Score, other: Score) -> float:
    """Standard errors by which the first gains more per block than the second."""
    change = one.blocks - other.blocks
    spread = change.std(ddof=1) / np.sqrt(len(change))
    return float(change.mean() / max(spread, 1e-12 * abs(one.blocks).max() + 1e-300))


def choose(guilty: list[Score], rules: Rules) -> tuple[Score, list[Score]]:
    """The best of the guilty, and its rivals: those the data do not tell from it.

    Among rivals within ``rules.tie`` standard errors the one with the fewest parameters is chosen.
    """
    ranked = sorted(guilty, key=lambda s: -s.gain)
    best = ranked[0]
    close = [
        s
        for s in ranked
        if s is best or difference(best, s) < rules.tie or s.gain > 0.995 * best.gain
    ]
    chosen = min(close, key=lambda s: (s.candidate.size, -s.gain))
    return chosen, [s for s in close if s is not chosen]
