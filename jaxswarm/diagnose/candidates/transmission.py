"""A soft or a loose joint as a candidate: the best of a lattice of stiffness and damping, or of gaps."""

from dataclasses import replace
from itertools import groupby

import numpy as np

from jaxswarm.diagnose.candidates.backlash import sharp_candidate
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.link_lag import (
    BLUR,
    FLANK,
    GAPS,
    ROTOR_SHARES,
    best_option,
    closed_gear,
    lag_torque,
    placed,
)
from jaxswarm.effects.term import Term

_SOFT = [(k, d) for k in np.geomspace(30.0, 3e5, 17) for d in (0.003, 0.01, 0.03, 0.1)]
# Times a loose joint's parameters are settled.
_SETTLE = 3


def lagging_candidate(stand: Linearization, term: Term) -> Candidate | None:
    """A link that lags behind its motor; None where the joint moves no inertia.

    Where a rotor is declared, divisions of the joint's inertia between it and the link are tried with
    every stiffness: a stiff joint does not tell them apart.
    """
    soft, j = term.law.warp == "elastic", term.joint
    inertia = stand.sensed(j)[0].inertia(stand.pi)
    if np.median(np.abs(inertia)) < 1e-6:
        return None
    memory, residuals = stand.memory, stand.residuals(j)
    known = memory.recall(term, residuals)
    if not soft and (known is None or not any(v["blur"] for v in known)):
        sharp = sharp_candidate(stand, term)
        if sharp is not None:
            memory.keep(term, residuals, [sharp.term.values] * len(sharp.columns))
            return sharp
        known = None
    rotor = stand.rotor(j) if soft else np.zeros_like(stand.pi)
    options = known or _options(term, inertia, ROTOR_SHARES if rotor.any() else (0.0,))
    blur = 1 if soft else max(1, round(BLUR / stand.found.regression.step[0]))
    judge = Candidate(term, (), 2 if soft else 1, blur)
    curves = _curves(stand, j, options, rotor) if soft else _settled_curves(stand, j, options)
    picks = range(len(options))
    if known is None:
        picks = [best_option(judge, fold, curves) for fold in stand.background.folds]
        memory.keep(term, residuals, [options[p] for p in picks])
    best = options[picks[0]]
    return replace(
        judge,
        term=placed(term, best),
        columns=tuple(curves[p][:, :, None] for p in picks),
        start=stand.pi - best["share"] * rotor,
    )


def _options(term: Term, inertia: np.ndarray, shares) -> list[dict[str, float]]:
    """The lattice within the law's bounds; damping is a ratio of what the joint's inertia needs.

    Beside the law's parameters every option has the rotor's ``share`` of the joint's inertia.
    """
    if term.law.warp == "elastic":
        unit = 20.0 * np.sqrt(float(np.median(np.abs(inertia))))
        options = [{"k": k, "d": r * np.sqrt(k) * unit} for k, r in _SOFT]
    else:
        options = [{"gap": g, "flank": FLANK, "blur": BLUR} for g in GAPS[::2]]
    limits = {p.name: (p.lower, p.upper) for p in term.law.parameters}
    inside = [{n: float(np.clip(v, *limits[n])) for n, v in o.items()} for o in options]
    return [{**o, "share": float(s)} for s in shares for o in inside]


def _curves(stand: Linearization, joint: int, options: list[dict], rotor: np.ndarray) -> np.ndarray:
    """Weighted torque (m, T', n) that a soft joint changes."""
    parts = []
    for share, group in groupby(options, lambda o: o["share"]):
        k, d = np.array([(o["k"], o["d"]) for o in group]).T
        pi = stand.pi - share * rotor
        parts.append(
            _weighted(stand, joint, pi[None], lambda _, k=k, d=d: (k, d), np.zeros(len(k)))
        )
    return np.concatenate(parts)


def _settled_curves(stand: Linearization, joint: int, options: list[dict]) -> np.ndarray:
    """Weighted torque (m, T', n) that a loose joint changes.

    When the link crosses the play depends on small torques, and the parameters were fitted without
    the play: they are settled with every gap, to first order, before it is judged.
    """
    gap, flank = (np.array([o[name] for o in options]) for name in ("gap", "flank"))
    pis = stand.pi[None]
    for _ in range(_SETTLE):
        curves = _weighted(stand, joint, pis, lambda own: closed_gear(own, stand.pi, flank), gap)
        pis = stand.pi - np.stack([_absorbed(stand, c) for c in curves])
    return curves


def _weighted(stand: Linearization, joint: int, pis, gear, gap) -> np.ndarray:
    """Weighted torque (m, T', n); ``gear`` gives stiffness and damping (m,) for a log's sensitivity."""
    parts = [
        lag_torque(m, own, pis, *gear(own), gap, terms=stand.found.model.terms)
        for m, own in zip(stand.found.motions, stand.sensed(joint), strict=True)
    ]
    return np.concatenate(parts, axis=1) * stand.background.weight


def _absorbed(stand: Linearization, torque: np.ndarray) -> np.ndarray:
    """Change of the rigid parameters (10 n,) by which the model takes up a weighted torque."""
    base = stand.found.fit.base
    full = np.zeros(len(base.names))
    change = stand.background.whole.absorbed(torque)
    full[base.kept[: len(change)]] = change
    return full[: len(stand.pi)]
