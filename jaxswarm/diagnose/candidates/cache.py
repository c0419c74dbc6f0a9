"""What earlier rounds found, so that a round searches only what may have changed."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jaxswarm.diagnose.candidates.journal import Journal
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.columns import Rigid
from jaxswarm.logs.motion import Motion

# A joint's residual that changed by less than this part asks for no new search of nonlinear parameters.
_SAME = 0.05
# A search may have missed so much of what a law can explain.
_UNSURE = 0.02


@dataclass
class _Known:
    """Values per fold of a term, the residuals they were found on, and the share they explained of them."""

    values: list[dict[str, float]]
    residuals: np.ndarray
    share: float | None = None


@dataclass
class Memory:
    """Nonlinear parameters found in earlier rounds, with the residuals they were found on.

    Attributes:
        journal: Keeps what was searched on disk; None: nothing is kept.
        least: Share of a joint's squared error below which no term is of interest.
        round: Number of the present round, from zero.
        known: What was found, by effect, joint and partner.
        gravity: Columns of gravity along each base axis, by the logs they belong to.
        laws: Decimated columns of laws on the logs, by term, values and width of the sign.
        misread: How errors of encoders on the logs follow their parameters, by term and log.
        positions: Of the logs that columns are kept of.
        rigids: Rigid columns of these logs.
    """

    journal: Journal | None = None
    least: float = 0.0
    round: int = -1
    known: dict = field(default_factory=dict)
    gravity: dict = field(default_factory=dict)
    laws: dict = field(default_factory=dict)
    misread: dict = field(default_factory=dict)
    positions: tuple[np.ndarray, ...] = ()
    rigids: tuple[Rigid, ...] = ()

    def look_at(self, motions: Sequence[Motion], rigids: Sequence[Rigid] = ()) -> None:
        """Forget the columns of other logs. What is found out about the noise of a log leaves its motion.

        A log with another clock is another log: of 12,000 samples of seven joints each takes 0.6 GB, and
        a diagnosis sees several clocks.
        """
        for old in self.rigids:
            if not any(old is one for one in rigids):
                old.forget()
        self.rigids = tuple(rigids)
        positions = tuple(m.q for m in motions)
        if [*map(id, positions)] != [*map(id, self.positions)]:
            self.laws, self.misread, self.positions = {}, {}, positions

    def aside(self) -> "Memory":
        """For a look at other rows of these logs: what follows from their motion, nothing that was found."""
        return replace(self, journal=None, known={})

    def recall(self, term: Term, residuals: np.ndarray) -> list[dict[str, float]] | None:
        """The values per fold, if a new search would not change the decision; else None.

        That is so where the joint's residuals r (folds, T) are still what they were, and where the
        best values explained so little, a share s, that none can explain much now: by the triangle
        inequality at most ((sqrt(s) + c) / (1 - c))^2 with c = |r - r_old| / |r_old|.
        """
        old = self.known.get(term.place)
        if old is None or old.residuals.shape != residuals.shape:
            return None
        change = np.linalg.norm(residuals - old.residuals, axis=1)
        change = change / np.maximum(np.linalg.norm(old.residuals, axis=1), 1e-300)
        share = 1.0 if old.share is None else max(old.share, _UNSURE)
        slight = np.sqrt(share) + change < np.sqrt(self.least) * (1.0 - change)
        return old.values if ((change < _SAME) | slight).all() else None

    def keep(self, term: Term, residuals: np.ndarray, values: list[dict[str, float]]) -> None:
        """Remember the values per fold of a term."""
        self.known[term.place] = _Known(values, residuals)

    def explained(self, term: Term, share: float) -> None:
        """Remember what the values of a term explained of the residuals they were found on."""
        known = self.known.get(term.place)
        if known is not None and known.share is None:
            known.share = share
