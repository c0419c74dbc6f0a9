"""A candidate term with the columns it would add to the model."""

from dataclasses import dataclass

import numpy as np
import scipy

from jaxswarm.effects.term import Term


@dataclass(frozen=True, eq=False)
class Candidate:
    """A candidate term with what it would add; two are the same where they are one object.

    Attributes:
        term: With the nonlinear parameters found on all rows.
        columns: Weighted columns (T, n, k) for the whole log and for every fold, each
            with the nonlinear parameters found on its own rows.
        size: Parameters it spends, linear and nonlinear.
        blur: Rows over which it is averaged before it is scored. When the flanks of a gear meet is decided
            by torques below the noise; how the load shifts around the impact is not.
        start: Rigid parameters (10 n,) to refit from; None: those of the current model.
        signed: Whether the coefficient is a change of something known, of either sign.
        apart: Rows (T,) of which it says nothing and by which it is not scored; None: it speaks of all.
    """

    term: Term
    columns: tuple[np.ndarray, ...]
    size: int
    blur: int = 1
    signed: bool = False
    start: np.ndarray | None = None
    apart: np.ndarray | None = None

    def view(self, x: np.ndarray) -> np.ndarray:
        """Average (T, ...) over ``blur`` rows, with nothing in those that it is not scored by."""
        if self.apart is not None:
            x = np.where(self.apart.reshape(-1, *(1,) * (x.ndim - 1)), 0.0, x)
        if self.blur == 1:
            return x
        return scipy.ndimage.uniform_filter1d(x, self.blur, axis=0, mode="nearest")

    @property
    def positive(self) -> bool:
        """Whether physics wants its single coefficient positive."""
        return not self.signed and self.term.law.positive
