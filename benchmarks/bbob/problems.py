"""BBOB's functions and what is kept of a run: after how many evaluations each target was reached.

The functions are those of ``ioh``. A target is a distance to the lowest value; as in COCO there are 51,
10^2 to 10^-8, and a run is summed up by the share of them that it reached.

Reference:
    N. Hansen et al., "COCO: a platform for comparing continuous optimizers in a black-box setting",
    Optim. Methods Softw. 36 (2021), doi 10.1080/10556788.2020.1808977.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

TARGETS = 10.0 ** np.linspace(2.0, -8.0, 51)
FUNCTIONS = tuple(range(1, 25))
GROUPS = {
    "separable": range(1, 6),
    "moderate": range(6, 10),
    "ill-conditioned": range(10, 15),
    "multimodal": range(15, 20),
    "weak structure": range(20, 25),
}
BOUND = 5.0
"""All functions have their lowest value within [-5, 5] in every coordinate."""


def bbob(function: int, instance: int, dims: int) -> Any:
    """One function of ``ioh``: call it with (d,) or (n, d); ``.optimum.y`` is its lowest value."""
    import ioh

    kind = ioh.ProblemClass.BBOB
    return ioh.get_problem(function, instance=instance, dimension=dims, problem_class=kind)


class Spent(Exception):
    """Nothing more is to be evaluated: the budget is spent, or the last target reached."""


class Record:
    """Evaluations and targets of several runs side by side.

    Attributes:
        hits: (runs, 51) evaluations after which each target was reached, 0 for never.
        spent: Evaluations of each run, the same for all.
    """

    def __init__(self, problems: Sequence[Any], budget: int):
        self.problems, self.budget, self.spent = problems, budget, 0
        self.best = np.full(len(problems), np.inf)
        self.hits = np.zeros((len(problems), TARGETS.size), int)

    @property
    def solved(self) -> np.ndarray:
        """(runs,) bool: nothing is left to reach."""
        return self.hits[:, -1] > 0

    def evaluate(self, x: np.ndarray) -> np.ndarray:
        """Values (runs, n) of candidates (runs, n, d); runs that are solved are not evaluated."""
        values = np.zeros(x.shape[:2])
        for run in np.flatnonzero(~self.solved):
            values[run] = self.problems[run](x[run])
            self._enter(run, values[run] - self.problems[run].optimum.y)
        self.spent += x.shape[1]
        return values

    def _enter(self, run: int, gaps: np.ndarray) -> None:
        gaps = gaps[: self.budget - self.spent]
        if not gaps.size or not gaps.min() < self.best[run]:
            return
        before = np.count_nonzero(self.best[run] <= TARGETS)
        lowest = np.minimum.accumulate(gaps)
        self.best[run] = lowest[-1]
        after = np.count_nonzero(lowest[-1] <= TARGETS)
        first = np.argmax(lowest <= TARGETS[before:after, None], axis=1)
        self.hits[run, before:after] = self.spent + 1 + first


class Single:
    """One run as a function of one candidate or of several, for libraries that run one at a time."""

    def __init__(self, problem: Any, budget: int):
        self.record = Record([problem], budget)

    def __call__(self, x: np.ndarray) -> Any:
        """Return the value of (d,) as a number, of (n, d) as (n,).

        Raises:
            Spent: Instead of the values, once nothing more is to be evaluated.
        """
        if self.record.spent >= self.record.budget or self.record.solved[0]:
            raise Spent
        x = np.asarray(x, float)
        values = self.record.evaluate(np.atleast_2d(x)[None])[0]
        return values if x.ndim == 2 else float(values[0])
