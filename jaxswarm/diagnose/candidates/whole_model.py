"""Candidates that change the whole model: its gravity, what it carries, how its torque is written down."""

from dataclasses import replace
from functools import partial

import jax
import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.effects.kinds import BodyChange, MeasurementLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.forward.columns import rigid_columns


def measurement_candidate(stand: Linearization, term: Term) -> Candidate:
    """How the model's torque would change in what the drives write down, to first order."""
    law, neutral = term.law, term.law.neutral()
    if law.excess is not None:
        columns = stand.stack(lambda k: stand.reported(k, _turned(stand, term, k)))
        return Candidate(replace(term, values=neutral), (columns,) * 3, columns.shape[2])

    def slopes(k):
        output, step = stand.outputs[k], 1.0 / stand.found.motions[k].rate
        if term.joint is not None:
            output = output[:, term.joint]
        # Continued straight by a sample: what a delay brings in at the ends is not known.
        ends = 2 * output[[0, -1]] - output[[1, -2]]
        longer = np.concatenate([ends[:1], output, ends[1:]])
        jacobian = _report_slopes(law, _numbers(neutral), longer, step)
        return np.stack([np.asarray(jacobian[p.name])[1:-1] for p in law.parameters], axis=-1)

    low = stand.low(slopes)
    if term.joint is None:
        columns = stand.background.weigh(low)
    else:
        columns = stand.on_joint(low, term.joint)
    return Candidate(replace(term, values=neutral), (columns,) * 3, columns.shape[2])


# Whole programs: each operation by itself would be traced, lowered and loaded on its own.
@partial(jax.jit, static_argnames="law")
def _report_slopes(law: MeasurementLaw, values: dict, x: jax.Array, step: float) -> dict:
    return jax.jacfwd(lambda p: law.report(p, x, step))(values)


@partial(jax.jit, static_argnames="law")
def _excess_slopes(law: MeasurementLaw, values: dict) -> dict:
    return jax.jacfwd(law.excess)(values)


@partial(jax.jit, static_argnames="law")
def _gravity_slopes(law: BodyChange, values: dict, gravity: jax.Array) -> dict:
    return jax.jacfwd(lambda p: law.gravity(p, gravity))(values)


@partial(jax.jit, static_argnames="law")
def _body(law: BodyChange, values: dict) -> jax.Array:
    return law.body(values)


def _numbers(values: dict[str, float]) -> dict[str, np.float64]:
    """Values that are data of a program, and no constants of it."""
    return {name: np.float64(value) for name, value in values.items()}


def _turned(stand: Linearization, term: Term, k: int) -> np.ndarray:
    """Rigid torque of a log by each parameter of an encoder's error, (T, n, p)."""
    law = term.law
    slopes = _excess_slopes(law, _numbers(law.neutral()))
    by_position = stand.sensed(term.joint)[k].at(stand.pi)[1]
    return np.stack([-by_position * float(slopes[p.name]) for p in law.parameters], axis=2)


def body_candidate(stand: Linearization, term: Term) -> Candidate:
    """Another gravity or a body on the last link, to first order."""
    law, neutral = term.law, term.law.neutral()
    if law.gravity is not None:
        columns = stand.background.weigh(_gravity_columns(stand, term))
    else:
        names = [p.name for p in law.parameters]
        unit = [{name: float(name == one) for name in names} for one in names]
        bodies = np.stack([np.asarray(_body(law, p)) for p in unit], axis=1)
        last = slice(-10, None)
        columns = stand.stack(lambda k: stand.reported(k, stand.carried(k)[:, :, last] @ bodies))
    return Candidate(replace(term, values=neutral), (columns,) * 3, columns.shape[2])


def _directions(stand: Linearization, term: Term) -> np.ndarray:
    """Change of gravity by each parameter, (p, 3)."""
    gravity = np.asarray(stand.arm.gravity, float)
    slopes = _gravity_slopes(term.law, _numbers(term.law.neutral()), gravity)
    return np.stack([np.asarray(slopes[p.name]) for p in term.law.parameters])


def _gravity_columns(stand: Linearization, term: Term) -> np.ndarray:
    """Decimated torque by each parameter of a gravity, (T', n, p and more).

    Gravity aside also loads masses that the level arm never felt, such as that of a first link
    about its vertical axis: their torques follow as further columns with free coefficients.
    """
    unknown = np.setdiff1d(np.arange(len(stand.pi)), stand.found.fit.base.kept)
    *aside, level = _by_gravity(stand, _directions(stand, term))
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


def _by_gravity(stand: Linearization, directions: np.ndarray) -> list[np.ndarray]:
    """Decimated rigid columns at rest for gravity along the directions and as it is, (T', n, 10 n) each.

    They follow from the links' positions alone, so that the next round need not build them again.
    """
    measured = of_kind(stand.found.model.terms, MeasurementLaw)
    chain = [(t.place, *t.values.items()) for t in measured]
    places = (directions.tobytes(), *(id(q) for q, _, _ in stand.moved), *chain)
    memory = stand.memory
    if places in memory.gravity:
        return memory.gravity[places][1]

    def columns(gravity):
        arm = stand.arm.replace(gravity=np.asarray(gravity))

        def rows(k):
            q, zero = stand.moved[k][0], np.zeros_like(stand.moved[k][1])
            return stand.reported(k, rigid_columns(arm, q, zero, zero))

        return stand.low(rows)

    found = [columns(g) for g in (*directions, stand.arm.gravity)]
    # The positions are kept with them: their identity is the key.
    memory.gravity = {places: ([q for q, _, _ in stand.moved], found)}
    return found
