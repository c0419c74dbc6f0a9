r"""How sure a slope is beside the error that all blocks of a half share: that of the fit to the other half.

What a half is left with by the fit to the other one is its noise e less :math:`P z`, where
:math:`z = Q^T e_A` is what the noise of the rows that were fitted did to the model. With a prediction p, which
is independent of z since candidates are asked by what the model cannot imitate, white noise gives the slope the
variance

.. math:: \sigma^2 \frac{|p|^2 + |P^T p|^2}{|p|^4}.

The jackknife over blocks sees the first part alone: z is the same in all blocks of a half. Where the model has
to predict a half from where the other one was, the second part is several times the first: of two springs that
left the same once they were fitted (chi-squared of 2.5, the true one the more) one explained what the other
left at 6.6 standard errors, and 2.6 with it.
"""

import numpy as np
import scipy

from jaxswarm.diagnose.decision.significance import certainty
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.foretold import foretold
from jaxswarm.diagnose.folds.free_parts import coefficients, free_parts
from jaxswarm.diagnose.folds.partial_out import CrossFit


def p_value_beside_fit(item: Score, crossfit: CrossFit) -> float:
    """The p-value of a score with the error of the fits; that of an event, which is of few blocks, as it is.

    Args:
        item: The score.
        crossfit: The folds on which it was scored.
    """
    if item.candidate.term.law.recurring:
        return item.p_value
    blocks = int(crossfit.block.max()) + 1
    sure = certainty(item.p_value, blocks) / np.sqrt(1.0 + shared_error(item, crossfit))
    return float(scipy.special.stdtr(blocks - 1, -sure))


def shared_error(item: Score, crossfit: CrossFit) -> float:
    """Variance of a slope by the error of the fits, over that by the noise of its own blocks."""
    candidate = item.candidate
    joints = slice(None) if item.own is None else slice(item.joint, item.joint + 1)
    parts = next(free_parts([candidate.columns], crossfit))
    shared = own = 0.0
    for fold, free in zip(crossfit.halves, parts[1:], strict=True):
        a = coefficients(candidate.view(free), fold, candidate.view(fold.residual))
        project = fold.project[~fold.train][:, joints]
        # As a slope weighs it.
        unseen = candidate.view(free @ a)[~fold.train][:, joints] * foretold(project) ** 2
        reached = np.einsum("tjb,tj->b", project, unseen)
        shared += float(reached @ reached)
        own += float((unseen**2).sum())
    return shared / max(own, 1e-300)
