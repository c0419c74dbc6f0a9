"""What earlier rounds found, so that a round searches only what may have changed."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.journal import Journal
from jaxswarm.effects.term import Term
from jaxswarm.logs.motion import Motion

# A joint's residual that changed by less than this part asks for no new search of nonlinear parameters.
_SAME = 0.05
# A search may have missed so much of what a law can explain.
_UNSURE = 0.02
# A slight candidate that comes to this part of what is of interest is made anew before it is judged.
_NEARLY = 0.5
# Numbers of columns of one candidate that are kept at most: of a long log they are large.
_KEPT = 2**18


@dataclass
class _Known:
    """Values per fold of a term, the residuals they were found on, and the share they explained of them."""

    values: list[dict[str, float]]
    residuals: np.ndarray
    share: float | None = None


@dataclass(frozen=True)
class _Slight:
    """A candidate that came to nothing, the weights of its columns (T, n), and its joint's residuals then."""

    candidate: Candidate
    weight: np.ndarray
    residuals: np.ndarray
    share: float


@dataclass
class Memory:
    """Nonlinear parameters found in earlier rounds, with the residuals they were found on.

    Attributes:
        journal: Keeps what was searched on disk; None: nothing is kept.
        least: Share of a joint's squared error below which no term is of interest.
        round: Number of the present round, from zero.
        known: What was found, by effect, joint and partner.
        gravity: Columns of gravity along each base axis, by the logs they belong to.
        slights: Candidates that came to nothing, by effect, joint and partner.
        laws: Decimated columns of laws on the logs, by term, values and width of the sign.
        positions: Of the logs that columns are kept of.
    """

    journal: Journal | None = None
    least: float = 0.0
    round: int = -1
    known: dict = field(default_factory=dict)
    gravity: dict = field(default_factory=dict)
    slights: dict = field(default_factory=dict)
    laws: dict = field(default_factory=dict)
    positions: tuple[np.ndarray, ...] = ()

    def look_at(self, motions: Sequence[Motion]) -> None:
        """Forget the columns of other logs. What is found out about the noise of a log leaves its motion."""
        positions = tuple(m.q for m in motions)
        if [*map(id, positions)] != [*map(id, self.positions)]:
            self.laws, self.slights, self.positions = {}, {}, positions

    def recall(self, term: Term, residuals: np.ndarray) -> list[dict[str, float]] | None:
        """The values per fold, if a new search would not change the decision; else None.

        That is so where the joint's residuals r (folds, T) are still what they were, and where the
        best values explained so little, a share s, that none can explain much now: by the triangle
        inequality at most ((sqrt(s) + c) / (1 - c))^2 with c = |r - r_old| / |r_old|.
        """
        old = self.known.get(term.place)
        if old is None or old.residuals.shape != residuals.shape:
            return None
        change = _change(old.residuals, residuals)
        slight = _stays_below(self.least, old.share, change)
        return old.values if ((change < _SAME) | slight).all() else None

    def slight(self, term: Term, residuals: np.ndarray, weight: np.ndarray) -> Candidate | None:
        """A candidate as it was when it came to nothing, weighed anew; None if by now it may come to more.

        It is scored like the others, so that what was found about it counts, but nothing is searched, moved or
        integrated again for the columns of hundreds that the last effect has not made any better.
        """
        old = self.slights.get(term.place)
        if old is None or old.residuals.shape != residuals.shape:
            return None
        if not _stays_below(self.least, old.share, _change(old.residuals, residuals)).all():
            return None
        again = np.divide(weight, old.weight, out=np.zeros_like(weight), where=old.weight > 0)
        made = {id(x): x * again[:, :, None] for x in old.candidate.columns}
        columns = tuple(made[id(x)] for x in old.candidate.columns)
        return replace(old.candidate, columns=columns)

    def keep_slight(
        self, candidate: Candidate, share: float, residuals: np.ndarray, weight: np.ndarray
    ) -> None:
        """Remember a candidate that explained this share of its joint's residuals, if it is slight."""
        self.slights.pop(candidate.term.place, None)
        if self.is_slight(share) and candidate.columns[0].size <= _KEPT:
            self.slights[candidate.term.place] = _Slight(candidate, weight, residuals, share)

    def is_slight(self, share: float) -> bool:
        """Whether a share of a joint's squared error is far from being of interest."""
        return share < _NEARLY * self.least

    def keep(self, term: Term, residuals: np.ndarray, values: list[dict[str, float]]) -> None:
        """Remember the values per fold of a term."""
        self.known[term.place] = _Known(values, residuals)

    def explained(self, term: Term, share: float) -> None:
        """Remember what the values of a term explained of the residuals they were found on."""
        known = self.known.get(term.place)
        if known is not None and known.share is None:
            known.share = share


def _change(old: np.ndarray, new: np.ndarray) -> np.ndarray:
    """How far residuals (folds, T) moved, over what they were, (folds,)."""
    change = np.linalg.norm(new - old, axis=1)
    return change / np.maximum(np.linalg.norm(old, axis=1), 1e-300)


def _stays_below(least: float, share: float | None, change: np.ndarray) -> np.ndarray:
    """Whether what explained a share of residuals explains less than ``least`` of them after a change."""
    share = 1.0 if share is None else max(share, _UNSURE)
    return np.sqrt(share) + change < np.sqrt(least) * (1.0 - change)
