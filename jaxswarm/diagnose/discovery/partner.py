"""Rows of a partner that is not explained yet say nothing of the arm while its joint is searched.

What is stored between two joints acts on both. Its torque on one bends the parameters of the arm that both
joints share, and by them what is seen of it on the other: of a cable over a pulley the right form left four
times the noise of its joint so, and 1.2 times without the partner's rows.
"""

from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.folds.partial_out import CrossFit, Fold


def without_joint(crossfit: CrossFit, joint: int) -> CrossFit:
    """The folds of the same model, fitted without the rows of a joint."""
    kept = np.arange(crossfit.weight.shape[1]) != joint

    def fitted(fold: Fold) -> Fold:
        seen = replace(
            fold, project=fold.project * kept[:, None], residual=np.where(kept, fold.residual, 0.0)
        )
        return seen.trained_on(fold.train)

    whole, one, two = map(fitted, crossfit.folds)
    return replace(
        crossfit, weight=crossfit.weight * kept, whole=whole, halves=(one, two), structure={}
    )
