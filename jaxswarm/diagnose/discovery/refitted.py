"""Formulas that fit alike, each in the model that it leads to: which says most of the log once all is refitted.

They are searched, and ranked, in a model that lacks the law: with the load, the sign widths and the parameters
of the arm that it came to without it. What these are off by is of the size of what tells sin(q - c) from q - c.
On a drawn law max(q - c, 0) sign(dq) load the sine was shorter by 34 bits there, and left 2 % more than the
truth once all was refitted, of which it is 1400 independent samples' worth; on unseen motion it left 1.8 times.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.diagnose.decision.rules import GAIN
from jaxswarm.diagnose.discovery.as_term import as_term
from jaxswarm.diagnose.discovery.front import Point
from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.rivals import near_ones
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.diagnose.selection.rivals_elsewhere import left_elsewhere
from jaxswarm.effects.alike import without
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.covariance import correlation_length
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.finite_columns import Diverged
from jaxswarm.logs.motion import Motion

# Formulas that are refitted beside the chosen one.
_REFITTED = 4
# Formulas whose errors differ by less than this part say the same on the log: the shorter one is asked.
_SAME = 1e-6


def alike_refitted(
    problem: Joint, one: Point, points: Sequence[Point], after: Estimate, term: Term
) -> list[tuple[Point, Estimate]]:
    """A proved formula and those that fit like it, each with the model that it leads to, the best first.

    Args:
        problem: The joint.
        one: The formula that was proved.
        points: The others, the best first.
        after: The model with it, all refitted.
        term: Its term there.
    """
    told = [one]
    for point in near_ones(one, points):
        if all(abs(point.error / p.error - 1.0) > _SAME for p in told) and len(told) <= _REFITTED:
            told.append(point)
    kept = without(term, after.model.terms)
    fits = [(one, after)]
    for point in told[1:]:
        try:
            fits.append((point, refit(after, (*kept, as_term(problem, point.formula)))))
        except Diverged:
            continue
    return fits


def shorter(fits: Sequence[tuple[Point, Estimate]]) -> list[Point]:
    """Those that describe the log in fewer bits than the first, with all refitted, the best first."""
    lengths = descriptions(fits)
    better = [k for k in range(1, len(fits)) if lengths[k] < lengths[0]]
    return [fits[k][0] for k in sorted(better, key=lambda k: lengths[k])]


def better_elsewhere(
    fits: Sequence[tuple[Point, Estimate]],
    before: Estimate,
    joint: int,
    other: Sequence[Motion],
) -> list[Point]:
    """Those that leave clearly less than the first on the worst other log, the best first.

    Forms that say the same in the range of one log part behind it: of friction that falls with the motor's
    temperature a decay by time left as little on a log, and 25 times the true law's error on another one.
    """
    if len(fits) < 2 or not other:
        return []
    left = [left_elsewhere(fit, before, joint, other) for _, fit in fits]
    better = [k for k in range(1, len(fits)) if left[k] <= GAIN * left[0]]
    return [fits[k][0] for k in sorted(better, key=lambda k: left[k])]


def descriptions(fits: Sequence[tuple[Point, Estimate]]) -> list[float]:
    """Bits of formulas and of what the models with them leave, in independent samples of the best of these.

    What a wrong formula leaves is slow and seems to be few samples, each of which says nearly nothing: by
    those of load load0^2, at 10.6 times the noise, exp(k q) load load0 was no better, which left 0.75 times.
    """
    left = [_left(fitted) for _, fitted in fits]
    best = fits[int(np.argmin(left))][1]
    regression = best.regression
    rows = regression.used_rows.any(axis=1)
    samples = rows.sum() / correlation_length(best.fit.residual[rows], regression.log[rows])
    constants = [len(p.formula.constants) + len(p.formula.pieces) for p, _ in fits]
    return [
        float(p.bits + 0.5 * count * np.log2(samples) + 0.5 * samples * bits)
        for (p, _), count, bits in zip(fits, constants, left, strict=True)
    ]


def _left(fitted: Estimate) -> float:
    """Bits of a sample of all joints that a model leaves."""
    return float(2.0 * np.log2(fitted.regression.rms(fitted.fit.residual)).sum())
