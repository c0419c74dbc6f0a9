r"""A joint with backlash whose impacts can be predicted one by one.

Between two flanks the link flies freely; the moment and the force of an impact follow from the motion if
the rigid parameters are good enough. Two things spoil those of the present fit. The impacts themselves,
a few large residuals, pull them: they are fitted again without the rows beyond three times the noise.
And while the link follows its motor, inertia of the rotor and of the link are one: where a rotor is
declared, divisions of the joint's inertia between the two are tried with every gap.

Where the best of these explains most of what the joint lacks, impacts are predictable; where it does
not, :mod:`jaxswarm.diagnose.candidates.transmission` asks how the load shifts around an impact.
"""

from dataclasses import replace
from itertools import groupby
from typing import NamedTuple

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.link_lag import ROTOR_SHARES, gears, lag_torque
from jaxswarm.diagnose.candidates.thinned import usual_inertia
from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.effects.term import Term
from jaxswarm.memory import joined

# Share of the joint's squared error that predicted impacts must explain, on unseen blocks of time too.
_MOST = 0.5
# Second lattice about the best point: factors on the gap, changes of the rotor's share, flanks [Hz].
_FINE_GAPS, _FINE_SHARES = np.geomspace(0.85, 1.18, 13), np.linspace(-0.075, 0.075, 5)
_FLANKS = (20.0, 40.0, 80.0)


class _Point(NamedTuple):
    """A joint with backlash: gap [rad], rotor's share of the inertia, frequency on the flank [Hz]."""

    gap: float
    share: float
    flank: float


def sharp_candidate(lin: Linearization, term: Term) -> Candidate | None:
    """The gap of a joint with its impacts where they happen; None where those cannot be predicted."""
    (pi, residual), j = lin.steady, term.index
    along, counts = lin.rotor(j), lin.found.regression.shares
    divided = bool(along.any())

    def curves_at(points: list[_Point], longer: float, own: bool = False) -> np.ndarray:
        parts = [
            _curves(lin, term, list(group), pi - share * along, longer, own)
            for share, group in groupby(points, lambda p: p.share)
        ]
        curves = joined(parts, axis=0)
        curves *= counts[:, [j]] if own else counts  # where nothing is fitted nothing is left
        return curves

    inertia = usual_inertia(lin.sensed(j)[0], lin.pi)
    tried = term.law_of(TransmissionLaw).lattice
    assert tried is not None  # every dead zone has it
    lattice = [(o["gap"], o["flank"]) for o in tried(inertia)]
    coarse = [_Point(g, s, f) for s in (ROTOR_SHARES if divided else (0.0,)) for g, f in lattice]
    curves = curves_at(coarse, 2.0, own=True)[:, :, 0]
    shares_of = _explained(curves, residual[:, j])
    if shares_of.max() < 0.5 * _MOST:
        return None
    best = coarse[int(np.argmax(shares_of))]
    shares = np.unique(np.clip(best.share + _FINE_SHARES, 0.0, 0.95)) if divided else (0.0,)
    fine = [_Point(best.gap * g, s, f) for s in shares for f in _FLANKS for g in _FINE_GAPS]
    curves = curves_at(fine, 1.0)
    folds = lin.crossfit.folds
    picks = [int(np.argmax(_explained(curves[:, f.train, j], residual[f.train, j]))) for f in folds]
    unseen = [
        _explained(curves[[pick]][:, ~fold.train, j], residual[~fold.train, j])[0]
        for pick, fold in zip(picks[1:], folds[1:], strict=True)
    ]
    if min(unseen) < _MOST:
        return None
    best = fine[picks[0]]
    return Candidate(
        replace(term, values={"gap": float(best.gap), "flank": best.flank, "blur": 0.0}),
        tuple(lin.crossfit.weigh(curves[pick][:, :, None]) for pick in picks),
        3,
        start=pi - best.share * along,
    )


def _explained(own: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Share of the squares of a joint's residual (T',) that curves (m, T') of it take off, (m,)."""
    size, inner = (own**2).sum(axis=1), np.maximum(own @ target, 0.0)
    return inner**2 / np.maximum(size * (target @ target), 1e-300)


def _curves(
    lin: Linearization,
    term: Term,
    points: list[_Point],
    pi: np.ndarray,
    longer: float,
    own: bool = False,
) -> np.ndarray:
    """Torque (m, T', n) that the link changes for each of the points, all logs; its own (m, T', 1)."""
    motions, sensed = lin.found.motions, lin.sensed(term.index)
    options = [{"gap": p.gap, "flank": p.flank} for p in points]
    terms, law = lin.found.model.terms, term.law_of(TransmissionLaw)
    parts = [
        lag_torque(motion, one, pi[None], *gears(law, options, one, pi), longer, terms, own)
        for motion, one in zip(motions, sensed, strict=True)
    ]
    return joined(parts, axis=1)
