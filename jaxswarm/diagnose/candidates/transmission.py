"""A link behind its motor as a candidate: the best of the lattice that its transmission is tried on."""

from dataclasses import replace
from itertools import groupby

import numpy as np

from jaxswarm.diagnose.candidates.backlash import sharp_candidate
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.link_lag import (
    ROTOR_SHARES,
    best_option,
    gears,
    lag_torque,
    placed,
)
from jaxswarm.effects.term import Term

# Times the rigid parameters are settled with a dead zone, and every how many-th gap that is done for:
# the torque is averaged over the moments of the strikes, so that close gaps look alike.
_SETTLE, _THINNED = 3, 2


def lagging_candidate(stand: Linearization, term: Term) -> Candidate | None:
    """A link that lags behind its motor; None where the joint moves no inertia.

    Where a rotor is declared, divisions of the joint's inertia between it and the link are tried with
    every stiffness: a stiff joint does not tell them apart.
    """
    law, j = term.law, term.joint
    crossing = law.gap is not None
    inertia = stand.sensed(j)[0].inertia(stand.pi)
    if np.median(np.abs(inertia)) < 1e-6:
        return None
    memory, residuals = stand.memory, stand.residuals(j)
    known = memory.recall(term, residuals)
    if crossing and (known is None or not any(v["blur"] for v in known)):
        sharp = sharp_candidate(stand, term)
        if sharp is not None:
            memory.keep(term, residuals, [sharp.term.values] * len(sharp.columns))
            return sharp
        known = None
    rotor = np.zeros_like(stand.pi) if crossing else stand.rotor(j)
    options = known or _options(term, inertia, ROTOR_SHARES if rotor.any() else (0.0,))
    blur = max(1, round(law.nominal().get("blur", 0.0) / stand.found.regression.step[0]))
    probe = Candidate(term, (), len(law.free(law.nominal())), blur)
    build = _settled_curves if crossing else _curves
    curves = build(stand, term, options, rotor)
    picks = range(len(options))
    if known is None:
        picks = [best_option(probe, fold, curves) for fold in stand.background.folds]
        memory.keep(term, residuals, [options[p] for p in picks])
    best = options[picks[0]]
    return replace(
        probe,
        term=placed(term, best),
        columns=tuple(curves[p][:, :, None] for p in picks),
        start=stand.pi - best["share"] * rotor,
    )


def _options(term: Term, inertia: np.ndarray, shares) -> list[dict[str, float]]:
    """The lattice within the law's bounds.

    Beside the law's parameters every option has the rotor's ``share`` of the joint's inertia.
    """
    options = term.law.lattice(float(np.median(np.abs(inertia))))
    if term.law.gap is not None:
        options = options[::_THINNED]
    limits = {p.name: (p.lower, p.upper) for p in term.law.parameters}
    inside = [{n: float(np.clip(v, *limits[n])) for n, v in o.items()} for o in options]
    return [{**o, "share": float(s)} for s in shares for o in inside]


def _curves(stand: Linearization, term: Term, options: list[dict], rotor: np.ndarray) -> np.ndarray:
    """Weighted torque (m, T', n) that a flexible joint changes."""
    parts = []
    for share, group in groupby(options, lambda o: o["share"]):
        parts.append(_weighted(stand, term, list(group), (stand.pi - share * rotor)[None]))
    return np.concatenate(parts)


def _settled_curves(
    stand: Linearization, term: Term, options: list[dict], rotor: np.ndarray
) -> np.ndarray:
    """Weighted torque (m, T', n) that a dead zone changes.

    When the link crosses it depends on small torques, and the parameters were fitted without the dead
    zone: they are settled with every gap, to first order, before it is scored.
    """
    pis = stand.pi[None]
    for _ in range(_SETTLE):
        curves = _weighted(stand, term, options, pis)
        pis = stand.pi - np.stack([_absorbed(stand, c) for c in curves])
    return curves


def _weighted(stand: Linearization, term: Term, options: list[dict], pis) -> np.ndarray:
    """Weighted torque (m, T', n) of options with their rigid parameters."""
    terms = stand.found.model.terms
    parts = [
        lag_torque(m, own, pis, *gears(term.law, options, own, stand.pi), terms=terms)
        for m, own in zip(stand.found.motions, stand.sensed(term.joint), strict=True)
    ]
    return np.concatenate(parts, axis=1) * stand.background.weight


def _absorbed(stand: Linearization, torque: np.ndarray) -> np.ndarray:
    """Change of the rigid parameters (10 n,) by which the model takes up a weighted torque."""
    base = stand.found.fit.base
    full = np.zeros(len(base.names))
    change = stand.background.whole.absorbed(torque)
    full[base.kept[: len(change)]] = change
    return full[: len(stand.pi)]
