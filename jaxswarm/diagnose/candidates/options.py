"""The option of a transmission that explains most of what a model leaves."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.folds.partial_out import Fold
from jaxswarm.effects.term import Term

# Numbers that the curves which pass at a time may hold. Four copies of them stand beside one another: of seven
# joints and a rotor, 476 options, they were 0.6 GB beside 6,000 rows.
_AT_ONCE = 2**22


def best_option(probe: Candidate, fold: Fold, curves: np.ndarray) -> int:
    """The option whose torque, with a positive coefficient, explains most of a fold's rows.

    ``curves`` are the weighted torques (m, T', n) of all options.
    """
    residual = probe.view(fold.residual)[fold.train].ravel()
    at_once = max(1, _AT_ONCE // curves[0].size)
    gains = []
    for start in range(0, len(curves), at_once):
        some = np.moveaxis(curves[start : start + at_once], 0, 2)  # one column each
        free = probe.view(fold.free_part(some))[fold.train].reshape(-1, some.shape[2])
        size, inner = (free**2).sum(axis=0), free.T @ residual
        gains.append(np.where((size > 0) & (inner > 0), inner**2 / np.maximum(size, 1e-300), 0.0))
    return int(np.argmax(np.concatenate(gains)))


def share_of(probe: Candidate, fold: Fold, curve: np.ndarray) -> float:
    """Share of the squared residual of a fold's rows that a weighted torque (T', n) takes off, of any sign."""
    residual = probe.view(fold.residual)[fold.train].ravel()
    free = probe.view(fold.free_part(curve[:, :, None]))[fold.train].ravel()
    size = float(free @ free) * float(residual @ residual)
    return float(free @ residual) ** 2 / size if size > 0.0 else 0.0


def chosen(curves: np.ndarray, picks: Sequence[int]) -> tuple[np.ndarray, ...]:
    """Columns (T', n, 1) of the options that folds picked of all curves (m, T', n).

    They are copies: a view of one would keep all, 160 MB of seven joints and 6,000 rows with a rotor.
    """
    own = {pick: curves[pick][:, :, None].copy() for pick in set(picks)}
    return tuple(own[pick] for pick in picks)


def placed(term: Term, option: dict[str, float]) -> Term:
    """The term with an option's values of its parameters."""
    return replace(term, values={p.name: option[p.name] for p in term.law.parameters})
