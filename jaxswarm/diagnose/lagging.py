"""A soft or a loose joint as a candidate: the best of a lattice of stiffness and damping, or of gaps."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.diagnose.candidates import Candidate
from jaxswarm.diagnose.stand import Memory, Stand
from jaxswarm.effects.warps import contact_stiffness, deflection
from jaxswarm.identify.terms import Term

_SOFT = [(k, d) for k in np.geomspace(30.0, 3e5, 17) for d in (0.003, 0.01, 0.03, 0.1)]
_GAPS = np.geomspace(2e-4, 0.06, 44)
# Times a loose joint's parameters are settled, and time [s] over which its torque is averaged.
_SETTLE, _BLUR = 3, 0.12


def lagging_candidate(stand: Stand, term: Term, memory: Memory) -> Candidate | None:
    """A link that lags behind its motor; None where the joint moves no inertia.

    When the link crosses the play depends on small torques, and the parameters were fitted without
    the play: they are settled with every gap, to first order, before it is judged.
    """
    soft, j = term.law.warp == "elastic", term.joint
    background, motions = stand.background, stand.found.motions
    sensed = stand.sensed(j)
    inertia = sensed[0][3][:, j] @ stand.pi
    if np.median(np.abs(inertia)) < 1e-6:
        return None
    known = memory.recall(term, stand.residuals(j))
    options = _options(term, inertia) if known is None else known
    stiff, damped = (float(x) for x in contact_stiffness(jnp.asarray(inertia)))
    k = np.array([o.get("k", stiff) for o in options])
    d = np.array([o.get("d", damped) for o in options])
    gap = np.array([o.get("gap", 0.0) for o in options])
    pis = stand.pi[None]
    for _ in range(1 if soft else _SETTLE):
        curves = np.concatenate(
            [
                _lag_torque(m, columns, j, pis, k, d, gap)
                for m, columns in zip(motions, sensed, strict=True)
            ],
            axis=1,
        )
        curves = curves * background.weight
        pis = stand.pi - np.stack([_absorbed(stand, c) for c in curves])
    blur = 1 if soft else max(1, round(_BLUR / stand.found.regression.step[0]))
    judge = Candidate(term, (), 2 if soft else 1, blur)
    if known is None:
        picks = [_best(judge, fold, curves) for fold in background.folds]
        memory.keep(term, stand.residuals(j), [options[p] for p in picks])
    else:
        picks = list(range(len(options)))
    columns = tuple(curves[p][:, :, None] for p in picks)
    return replace(judge, term=replace(term, values=options[picks[0]]), columns=columns)


def _options(term: Term, inertia: np.ndarray) -> list[dict[str, float]]:
    """The lattice within the law's bounds; damping is a ratio of what the joint's inertia needs."""
    if term.law.warp == "elastic":
        unit = 20.0 * np.sqrt(float(np.median(np.abs(inertia))))
        options = [{"k": k, "d": r * np.sqrt(k) * unit} for k, r in _SOFT]
    else:
        options = [{"gap": g} for g in _GAPS]
    limits = {p.name: (p.lower, p.upper) for p in term.law.parameters}
    return [{n: float(np.clip(v, *limits[n])) for n, v in o.items()} for o in options]


def _best(judge: Candidate, fold, curves: np.ndarray) -> int:
    """The option whose torque, with a positive coefficient, explains most of a fold's rows."""
    # All options at once, one column each.
    free = fold.free_part(np.moveaxis(curves, 0, 2))
    free = judge.view(free)[fold.train].reshape(-1, len(curves))
    residual = judge.view(fold.residual)[fold.train].ravel()
    size, inner = (free**2).sum(axis=0), free.T @ residual
    gains = np.where((size > 0) & (inner > 0), inner**2 / np.maximum(size, 1e-300), 0.0)
    return int(np.argmax(gains))


def _absorbed(stand: Stand, torque: np.ndarray) -> np.ndarray:
    """Change of the rigid parameters (10 n,) by which the model takes up a weighted torque."""
    base = stand.found.fit.base
    full = np.zeros(len(base.names))
    change = stand.background.whole.absorbed(torque)
    full[base.kept[: len(change)]] = change
    return full[: len(stand.pi)]


def _lag_torque(motion, columns, joint, pis, k, d, gap) -> np.ndarray:
    """Decimated torque (m, T', n) that a lagging link changes, for m options with their parameters.

    One row of ``pis`` serves all options.
    """
    torque, by_q, by_dq, by_ddq = (np.moveaxis(c @ pis.T, 2, 0) for c in columns)

    def lag(tau, s, c, m, k, d, gap):
        return deflection(m, c, s, tau, k, d, gap, 1.0 / motion.rate, 2)

    shape = (len(k), len(motion.t))
    own = [np.broadcast_to(x[:, :, joint], shape) for x in (torque, by_q, by_dq, by_ddq)]
    e, v, a = (np.asarray(x) for x in jax.vmap(lag)(*own, k, d, gap))
    # A model whose inertia is not positive somewhere lets the lag run away: no candidate.
    alive = np.isfinite(a).all(axis=1) & (np.abs(e).max(axis=1) < 1.0)
    e, v, a = (np.where(alive[:, None], x, 0.0)[:, :, None] for x in (e, v, a))
    change = -(e * by_q + v * by_dq + a * by_ddq)
    return np.moveaxis(motion.decimator.apply(np.moveaxis(change, 0, 2)), 2, 0)
