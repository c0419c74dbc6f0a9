"""A suspect with the columns it would add to the model."""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from jaxswarm.effects.term import Term
from jaxswarm.effects.warps import LAGGING


@dataclass(frozen=True)
class Candidate:
    """A suspect with what it would add.

    Attributes:
        term: With the nonlinear parameters found on all rows.
        columns: Weighted columns (T, n, k) for the whole log, the first half, the second half, each
            with the nonlinear parameters found on its own rows.
        size: Parameters it spends, linear and nonlinear.
        blur: Rows over which it is averaged before it is judged. When a loose gear strikes is decided
            by torques below the noise; how the load shifts around the strike is not.
        start: Rigid parameters (10 n,) to refit from; None: those of the current model.
        signed: Whether the coefficient is a change of something known, of either sign.
    """

    term: Term
    columns: tuple[np.ndarray, np.ndarray, np.ndarray]
    size: int
    blur: int = 1
    signed: bool = False
    start: np.ndarray | None = None

    def view(self, x: np.ndarray) -> np.ndarray:
        """Average (T, ...) over ``blur`` rows."""
        if self.blur == 1:
            return x
        return ndimage.uniform_filter1d(x, self.blur, axis=0, mode="nearest")

    @property
    def positive(self) -> bool:
        """Whether physics wants its single coefficient positive."""
        law = self.term.law
        if self.signed:
            return False
        if law.warp in LAGGING:
            return True
        return len(law.linear) == 1 and law.linear[0].lower >= 0
