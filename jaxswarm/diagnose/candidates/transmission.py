"""A link behind its motor as a candidate: the best of the lattice that its transmission is tried on."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np

from jaxswarm.diagnose.candidates.backlash import sharp_candidate
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.link_lag import ROTOR_SHARES, gears, lag_torque
from jaxswarm.diagnose.candidates.options import best_option, chosen, placed, share_of
from jaxswarm.diagnose.candidates.thinned import usual_inertia
from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.link_lag import unseen_rows
from jaxswarm.memory import joined

# Times the rigid parameters are settled with a dead zone, and every how many-th gap that is done for:
# the torque is averaged over the moments of the impacts, so that close gaps look alike.
_SETTLE, _THINNED = 3, 2
# Share of the squared error from which on stiffnesses between those of the lattice are tried too, and which.
# Of a link at 6.7 Hz with a damping ratio of 0.05 the lattice took 0.3 off (p = 0.03), these 0.68 (p = 2e-9).
_WORTH_MORE = 0.1
_TIMES_AS_SOFT = np.geomspace(1.0 / 1.5, 1.5, 9)


def lagging_candidate(lin: Linearization, term: Term) -> Candidate | None:
    """A link that lags behind its motor; None where the joint moves no inertia.

    Where a rotor is declared, divisions of the joint's inertia between it and the link are tried with
    every stiffness: a stiff joint does not tell them apart.
    """
    law, j = term.law_of(TransmissionLaw), term.index
    crossing = law.gap is not None
    inertia = usual_inertia(lin.sensed(j)[0], lin.pi)
    if inertia < 1e-6:
        return None
    memory, residuals = lin.memory, lin.residuals(j)
    known = memory.recall(term, residuals)
    if crossing and (known is None or not any(v["blur"] for v in known)):
        sharp = sharp_candidate(lin, term)
        if sharp is not None:
            memory.keep(term, residuals, [sharp.term.values] * len(sharp.columns))
            return sharp
        known = None
    rotor = np.zeros_like(lin.pi) if crossing else lin.rotor(j)
    options = known or _options(term, inertia, ROTOR_SHARES if rotor.any() else (0.0,))
    blur = max(1, round(law.nominal().get("blur", 0.0) / lin.found.regression.step[0]))
    probe = Candidate(term, (), len(law.free(law.nominal())), blur)
    build = _settled_curves if crossing else _curves
    curves = build(lin, term, options, rotor)
    if not crossing:
        probe = replace(probe, apart=_not_asked(lin))
    picks: Sequence[int] = range(len(options))
    if known is None:
        picks = [best_option(probe, fold, curves) for fold in lin.crossfit.folds]
        worth = share_of(probe, lin.crossfit.whole, curves[picks[0]]) > _WORTH_MORE
        if worth and law.softer is not None:
            options = _between(law.softer, term, [options[p] for p in dict.fromkeys(picks)])
            del curves
            curves = _curves(lin, term, options, rotor)
            picks = [best_option(probe, fold, curves) for fold in lin.crossfit.folds]
        memory.keep(term, residuals, [options[p] for p in picks])
    best = options[picks[0]]
    return replace(
        probe,
        term=placed(term, best),
        columns=chosen(curves, picks),
        start=lin.pi - best["share"] * rotor,
    )


def _options(term: Term, inertia: float, shares) -> list[dict[str, float]]:
    """The lattice within the law's bounds.

    Beside the law's parameters every option has the rotor's ``share`` of the joint's inertia.
    """
    law = term.law_of(TransmissionLaw)
    assert law.lattice is not None  # what extends no other law has it
    options = law.lattice(inertia)
    if law.gap is not None:
        options = options[::_THINNED]
    inside = [_within_bounds(term, option) for option in options]
    return [{**o, "share": float(s)} for s in shares for o in inside]


def _between(
    softer: Callable[[Mapping, float], dict[str, float]],
    term: Term,
    options: list[dict[str, float]],
) -> list[dict[str, float]]:
    """Stiffnesses between some of the lattice and those next to them, with the same damping ratio.

    A link that swings freely while its motor stands goes out of step with any other frequency. Sorted by the
    rotor's share, by which they are tried together.
    """
    inside = [
        {**option, **_within_bounds(term, softer(option, times))}
        for option in options
        for times in _TIMES_AS_SOFT
    ]
    return sorted(inside, key=lambda o: o["share"])


def _within_bounds(term: Term, values: Mapping[str, float]) -> dict[str, float]:
    """Values of parameters of a term's law, each within its bounds."""
    limits = {p.name: (p.lower, p.upper) for p in term.law.parameters}
    return {name: float(np.clip(value, *limits[name])) for name, value in values.items()}


def _curves(lin: Linearization, term: Term, options: list[dict], rotor: np.ndarray) -> np.ndarray:
    """Weighted torque (m, T', n) that a flexible joint changes."""
    parts = []
    for share, group in groupby(options, lambda o: o["share"]):
        parts.append(_weighted(lin, term, list(group), (lin.pi - share * rotor)[None]))
    curves = joined(parts, axis=0)
    curves[:, _not_asked(lin)] = 0.0
    return curves


def _not_asked(lin: Linearization) -> np.ndarray:
    """Rows of all logs (T',) in which the fit does not ask a spring; nor does the score."""
    return np.concatenate([unseen_rows(m) for m in lin.found.motions])


def _settled_curves(
    lin: Linearization, term: Term, options: list[dict], rotor: np.ndarray
) -> np.ndarray:
    """Weighted torque (m, T', n) that a dead zone changes.

    When the link crosses it depends on small torques, and the parameters were fitted without the dead
    zone: they are settled with every gap, to first order, before it is scored.
    """
    curves = _weighted(lin, term, options, lin.pi[None])
    for _ in range(_SETTLE - 1):
        pis = lin.pi - np.stack([_absorbed(lin, c) for c in curves])
        del curves  # of a long log they are large: none stands beside those that follow
        curves = _weighted(lin, term, options, pis)
    return curves


def _weighted(lin: Linearization, term: Term, options: list[dict], pis) -> np.ndarray:
    """Weighted torque (m, T', n) of options with their rigid parameters."""
    terms, law = lin.found.model.terms, term.law_of(TransmissionLaw)
    parts = [
        lag_torque(m, own, pis, *gears(law, options, own, lin.pi), terms=terms)
        for m, own in zip(lin.found.motions, lin.sensed(term.index), strict=True)
    ]
    curves = joined(parts, axis=1)
    curves *= lin.crossfit.weight
    return curves


def _absorbed(lin: Linearization, torque: np.ndarray) -> np.ndarray:
    """Change of the rigid parameters (10 n,) by which the model takes up a weighted torque."""
    base = lin.found.fit.base
    full = np.zeros(len(base.names))
    change = lin.crossfit.whole.absorbed(torque)
    full[base.kept[: len(change)]] = change
    return full[: len(lin.pi)]
