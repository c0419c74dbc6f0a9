"""How an arm swings on a base that gives way: where what a model leaves says most of it.

A base soft enough to show swings at a few hertz, which motion excites: of arms at 5 to 10 Hz the turn by the
moment alone took 0.1 to 0.3 of the squared error off, the swing 0.4 to 0.9. Its frequency is told from a wrong
one by a part of the damping, so the lattice is of strongly damped swings, and Gauss-Newton steps follow.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import scipy

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.thinned import every_few
from jaxswarm.diagnose.folds.free_parts import coefficients
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.swing_starts import MOST_LEFT
from jaxswarm.identify.forward.base_swing import LEAST
from jaxswarm.identify.forward.columns import is_kept
from jaxswarm.identify.forward.sway_response import SwayResponse
from jaxswarm.identify.forward.written_down import report
from jaxswarm.logs.motion import Motion

# Frequencies [Hz] at the mean pose and the damping ratio that are looked at; how many of these are tried, the
# Gauss-Newton steps of each, and of the best one.
_FREQUENCIES, _DAMPING = np.geomspace(3.0, 16.0, 7), 0.1
_TRIED, _FIRST, _THEN = 4, 5, 10
# Multiple of the torque's cutoff up to which they are looked at: of 20 arms on bases of 5 to 10 Hz none swung
# at more than 2.8 times it, and a swing far beyond what is compared is a turn by the moment alone.
_BEYOND = 3.0
# Share that a turn by the moment alone takes off some joint from which on swings are looked at; those from
# which on, on this joint and a second one, they are tried: of four arms on bases of 5 to 10 Hz they were 0.27
# to 0.71 and 0.1 to 0.45, of logs with other effects up to 0.04. What one that was looked at may leave to be
# tried where they are less: of an arm with 0.10 and 0.05 it left 0.55, and 0.28 in the end.
_LOOKED, _ASKED, _TOO, _LIKELY = 0.04, 0.1, 0.05, 0.85
# Samples in a period of the torque's cutoff, or of the fastest swing, that it is sought on.
_SAMPLES = 12.0
# Inertia of the base, and of what no joint feels, beside the arm's that the lattice is tried with.
_BASE = 0.3


def with_swing(
    lin: Linearization,
    term: Term,
    left: np.ndarray,
    soft: np.ndarray,
    response: Callable[[int], SwayResponse],
) -> Term:
    """A compliance with the swing that says most of what a model leaves; as it is where none is told.

    Args:
        lin: Where the model stands.
        term: A base that turns by the moment alone.
        left: Weighted rows (T', n) that it leaves.
        soft: Its linear parameters, (2,).
        response: Of a log by its number, to turns under the model's body and masses that only a base that
            sways feels.
    """
    residual = lin.crossfit.whole.residual
    shown = 1.0 - (left**2).sum(axis=0) / np.maximum((residual**2).sum(axis=0), 1e-300)
    *_, second, most = (0.0, *np.sort(shown))
    if term.law_of(BodyChange).swing is None or most < _LOOKED or len(shown) < term.law.min_joints:
        return term
    # Of a long log the responses are too large to be kept.
    if not all(map(is_kept, lin.found.motions)):
        return term
    residuals = np.concatenate([lin.residuals(j) for j in range(len(shown))], axis=1)
    known = lin.memory.recall(term, residuals)
    if known is not None:
        return replace(term, values=known[0])
    search = _Search(lin, term, response)
    starts = [p for f in _excited(lin.found.motions) for p in search.starts(f, soft)]
    begun = sorted((search.likely(p) for p in starts), key=lambda one: one[0])
    told = term
    if min(most / _ASKED, second / _TOO) > 1.0 or begun[0][0] < _LIKELY * (residual**2).sum():
        ends = (search.descend(p, _FIRST) for _, p in begun[:_TRIED])
        best = search.descend(min(ends, key=search.cost), _THEN)
        if search.cost(best) < MOST_LEFT * (left**2).sum():
            told = search.told(best)
    lin.memory.keep(term, residuals, [told.values])
    return told


def _excited(motions: Sequence[Motion]) -> np.ndarray:
    """The frequencies [Hz] looked at on some logs: the first, and all not far beyond their torque's."""
    most = max(_BEYOND * m.torque_cutoff for m in motions)
    return _FREQUENCIES[_FREQUENCIES <= max(most, _FREQUENCIES[0])]


class _Search:
    """What a model leaves by the logarithms of a base's softnesses, frequencies and damping."""

    def __init__(self, lin: Linearization, term: Term, response: Callable[[int], SwayResponse]):
        self.lin, self.term = lin, term
        law = term.law_of(BodyChange)
        assert law.swing is not None
        self.names = [p.name for p in law.linear] + list(law.swing)
        bounds = {p.name: (p.lower, p.upper) for p in law.parameters}
        # A softness of nothing has no logarithm; at its upper bound a frequency is none.
        self.lower = np.log([max(bounds[n][0], 1e-9) for n in self.names])
        self.upper = np.log([bounds[n][1] for n in self.names]) - 1e-9
        self.responses = []
        for k, (moved, motion) in enumerate(zip(lin.moved, lin.found.motions, strict=True)):
            whole = response(k)
            few = motion.rate / (_SAMPLES * max(motion.torque_cutoff, _FREQUENCIES[-1]))
            less, part = every_few(motion, int(few))
            if less is not motion:
                q, dq, ddq = (x[part] for x in moved)
                whole = SwayResponse(lin.arm, (q, dq, ddq), less, whole.every, again=True)
            self.responses.append(whole)
        self.alone = np.eye(self.responses[0].every.shape[1])[0]

    def starts(self, often: float, given: np.ndarray) -> list[np.ndarray]:
        """Where a swing of a frequency [Hz] at the mean pose begins, (5,) each.

        As soft as its inertia says, and as a base that turns by the moment alone was found.
        """
        inertia = np.concatenate([r.inertias[..., 0] for r in self.responses])
        mean = inertia.mean(axis=0)
        # The inertia is known but for a constant: as little as leaves it positive everywhere, and something.
        least = np.linalg.eigvalsh(inertia).min()
        whole = np.diagonal(mean) - least
        whole = whole + _BASE * whole.mean()
        soft = 1.0 / (whole * (2.0 * np.pi * often) ** 2)
        usual = np.maximum(whole - np.diagonal(mean), LEAST * whole)
        own = np.sqrt(1.0 / (soft * usual)) / (2.0 * np.pi)
        given = np.maximum(given, 1e-3 * np.abs(given).max())
        places = ([*soft, *own], [*given, often, often])
        return [np.clip(np.log([*p, _DAMPING]), self.lower, self.upper) for p in places]

    def told(self, p: np.ndarray) -> Term:
        """The term at a place."""
        return replace(self.term, values=dict(zip(self.names, map(float, np.exp(p)), strict=True)))

    def cost(self, p: np.ndarray) -> float:
        """Squares that are left at a place."""
        return float((self.left(p) ** 2).sum())

    def likely(self, p: np.ndarray) -> tuple[float, np.ndarray]:
        """Squares that are left with the best multiple of the turn at a place, and the place with that."""
        fold, free = self.lin.crossfit.whole, self._free(p)
        times = coefficients(free, fold)
        left, there = fold.residual - free @ times, p.copy()
        if times[0] > 0.0:
            there[:2] += np.log(times[0])
        return float((left**2).sum()), np.clip(there, self.lower, self.upper)

    def left(self, p: np.ndarray) -> np.ndarray:
        """Weighted rows (T' n,) that a model leaves with the base at a place; masses that it feels are free."""
        fold, free = self.lin.crossfit.whole, self._free(p)
        rest, masses = fold.residual - free[:, :, 0], free[:, :, 1:]
        return (rest - masses @ coefficients(masses, fold, rest)).ravel()

    def _free(self, p: np.ndarray) -> np.ndarray:
        """What a base at a place changes of the weighted rows, beside the model, (T', n, 1 + r)."""
        return self.lin.crossfit.whole.free_part(self.columns(self.told(p)))

    def columns(self, term: Term) -> np.ndarray:
        """Weighted torque by a base, and its derivatives along masses that it feels, (T', n, 1 + r)."""
        rows, terms = [], self.lin.found.model.terms
        for motion, response in zip(self.lin.found.motions, self.responses, strict=True):
            # What the body is by itself is no direction of masses.
            made = np.delete(response.at(term, self.alone), 1, axis=2)
            low = response.motion.decimator.apply(report(terms, response.motion, made))
            rows.append(low[: len(motion.decimator.kept(len(motion.t)))])
        return self.lin.crossfit.weigh(np.concatenate(rows))

    def descend(self, p: np.ndarray, steps: int) -> np.ndarray:
        """The least squares from a place."""
        scale = np.array([0.1, 0.1, 0.1, 0.1, 1.0])
        bounds = (self.lower, self.upper)
        found = scipy.optimize.least_squares(
            self.left, p, bounds=bounds, x_scale=scale, diff_step=1e-4, max_nfev=steps
        )
        return found.x
