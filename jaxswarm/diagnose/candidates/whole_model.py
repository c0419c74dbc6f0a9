"""Candidates that change the whole model: its scale, its clock, its gravity, what it carries or touches."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.effects.term import Term, warped
from jaxswarm.identify.forward.columns import rigid_columns

# Lengths of the windows tried for a touch: from this many rows to a third of the log.
_SHORTEST, _LENGTHS = 3, 32


def warped_candidate(stand: Linearization, term: Term) -> Candidate | None:
    """The candidate of a drive gain, delay, tilt, payload or touch; None where there is nothing to say."""
    kind = term.law.warp
    if kind == "window":
        return _touch(stand, term)
    if kind == "gain":
        columns = stand.on_joint(
            stand.low(lambda k: stand.outputs[k][:, term.joint, None]), term.joint
        )
        start = {"gain": 1.0}
    elif kind == "delay":
        rates = [m.rate for m in stand.found.motions]
        columns = stand.stack(
            lambda k: -np.gradient(stand.outputs[k], 1.0 / rates[k], axis=0)[:, :, None]
        )
        start = {"seconds": 0.0}
    elif kind == "gravity":
        columns = stand.background.weigh(_tilt(stand))
        start = {"gx": 0.0, "gy": 0.0}
    else:
        last = slice(-10, None)
        columns = stand.stack(lambda k: stand.reported(k, stand.carried(k)[:, :, last]))
        start = term.values
    return Candidate(replace(term, values=start), (columns,) * 3, columns.shape[2])


def _tilt(stand: Linearization) -> np.ndarray:
    """Decimated torque of a unit of gravity along base x and y, (T', n, 2 and more).

    Gravity aside also loads masses that the level arm never felt, such as that of a first link
    about its vertical axis: their torques follow as further columns with free coefficients.
    """
    unknown = np.setdiff1d(np.arange(len(stand.pi)), stand.found.fit.base.kept)
    *aside, level = _by_gravity(stand)
    known = np.stack([rows @ stand.pi for rows in aside], axis=2)
    free = np.concatenate([rows[:, :, unknown] for rows in aside], axis=2)
    # What the level arm's own columns cannot say already, as few columns as span it.
    own = level.reshape(-1, len(stand.pi))
    basis, size, _ = np.linalg.svd(own, full_matrices=False)
    inside = basis[:, size > 1e-9 * size[0]]
    flat = free.reshape(len(own), -1)
    u, size, _ = np.linalg.svd(flat - inside @ (inside.T @ flat), full_matrices=False)
    fresh = u[:, size > 1e-6 * max(np.linalg.norm(flat, axis=0).max(), 1e-300)]
    return np.concatenate([known, fresh.reshape(*known.shape[:2], -1)], axis=2)


def _by_gravity(stand: Linearization) -> list[np.ndarray]:
    """Decimated rigid columns at rest for gravity along base x, base y and as it is, (T', n, 10 n) each.

    They follow from the links' positions alone, so that the next round need not build them again.
    """
    terms = stand.found.model.terms
    chain = [tuple(t.values.items()) for w in ("gain", "delay") for t in warped(terms, w)]
    places = (*(id(q) for q, _, _ in stand.moved), *chain)
    memory = stand.memory
    if places in memory.gravity:
        return memory.gravity[places][1]

    def columns(gravity):
        arm = stand.arm.replace(gravity=jnp.asarray(gravity))

        def rows(k):
            q, zero = stand.moved[k][0], np.zeros_like(stand.moved[k][1])
            return stand.reported(k, rigid_columns(arm, q, zero, zero))

        return stand.low(rows)

    found = [columns(g) for g in (*np.eye(3)[:2], stand.arm.gravity)]
    # The positions are kept with them: their identity is the key.
    memory.gravity = {places: ([q for q, _, _ in stand.moved], found)}
    return found


def _touch(stand: Linearization, term: Term) -> Candidate | None:
    """The window whose constant torques explain most, found on running sums of the residual."""
    regression, residual = stand.found.regression, stand.background.whole.residual
    total = np.concatenate([np.zeros((1, residual.shape[1])), np.cumsum(residual, axis=0)])
    best, pick = 0.0, None
    for length in np.unique(np.geomspace(_SHORTEST, len(residual) // 3, _LENGTHS).astype(int)):
        change = total[length:] - total[:-length]
        gain = (change**2).sum(axis=1) / length
        if gain.max() > best:
            first = int(np.argmax(gain))
            if regression.log[first] == regression.log[first + length - 1]:
                best, pick = gain.max(), (first, first + length - 1)
    if pick is None:
        return None
    start, end = regression.t[pick[0]], regression.t[pick[1]]
    log = regression.log[pick[0]]

    def build(k):
        motion = stand.found.motions[k]
        inside = (motion.t >= start) & (motion.t <= end) & (k == log)
        return stand.reported(k, inside[:, None, None] * np.eye(residual.shape[1]))

    columns = stand.stack(build)
    values = {"start": float(start), "end": float(end), "log": float(log)}
    return Candidate(replace(term, values=values), (columns,) * 3, 2 + residual.shape[1])
