"""A transmission that extends the one a model has: what it would change of the torque of that one."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.link_lag import gears, lag_torque
from jaxswarm.diagnose.candidates.options import best_option, chosen, placed
from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.link_lag import term_deflection


def extended_candidate(lin: Linearization, term: Term) -> Candidate:
    """The best of what is tried around the values of the transmission that a joint has.

    The rigid parameters were fitted with that one, so the inertia is divided between rotor and link already.
    """
    law, residuals = term.law, lin.residuals(term.index)
    places = [(name, term.joint, None) for name in law.extends]
    held = next(t for t in lin.found.model.terms if t.place in places)
    known = lin.memory.recall(term, residuals)
    options = known or _options(lin, term, held)
    curves = _changes(lin, term, held, options)
    probe = Candidate(term, (), len(law.free(law.nominal())))
    picks: Sequence[int] = range(len(options))
    if known is None:
        picks = [best_option(probe, fold, curves) for fold in lin.crossfit.folds]
        lin.memory.keep(term, residuals, [options[p] for p in picks])
    return replace(probe, term=placed(term, options[picks[0]]), columns=chosen(curves, picks))


def _options(lin: Linearization, term: Term, held: Term) -> list[dict[str, float]]:
    """What is tried, within the law's bounds."""
    felt = [own.at(lin.pi) for own in lin.sensed(term.index)]
    logs = zip(lin.found.motions, felt, strict=True)
    joint = slice(term.index, term.index + 1)
    own = ((motion, tuple(x[:, joint] for x in sensed)) for motion, sensed in logs)
    twist = _size([term_deflection(held, *one)[0] for one in own])
    torque = _size([own[0][:, term.index] for own in felt])
    inertia = float(np.median(np.abs(felt[0][3][:, term.index])))
    limits = {p.name: (p.lower, p.upper) for p in term.law.parameters}
    around = term.law_of(TransmissionLaw).around
    assert around is not None  # what extends a law has it
    return [
        {n: float(np.clip(v, *limits[n])) for n, v in option.items()}
        for option in around(inertia, torque / twist, twist)
    ]


def _size(parts: list[np.ndarray]) -> float:
    """Root mean square over all logs, above zero."""
    return max(float(np.sqrt(np.mean(np.concatenate(parts) ** 2))), 1e-9)


def _changes(lin: Linearization, term: Term, held: Term, options: list[dict]) -> np.ndarray:
    """Weighted torque (m, T', n) of options less that of the transmission that is there."""
    terms, pis = lin.found.model.terms, lin.pi[None]
    parts = []
    for motion, own in zip(lin.found.motions, lin.sensed(term.index), strict=True):
        one = gears(term.law_of(TransmissionLaw), options, own, lin.pi)
        two = gears(held.law_of(TransmissionLaw), [held.values], own, lin.pi)
        k, d, gap, hard = (np.concatenate(pair) for pair in zip(one, two, strict=True))
        parts.append(lag_torque(motion, own, pis, k, d, gap, hard, terms=terms))
    curves = np.concatenate(parts, axis=1)
    return (curves[:-1] - curves[-1]) * lin.crossfit.weight
