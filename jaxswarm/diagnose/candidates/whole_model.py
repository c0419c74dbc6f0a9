"""Candidates that change the whole model: its gravity, what it carries, how its torque is written down."""

from dataclasses import replace
from functools import partial

import jax
import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.window import windowed_candidate
from jaxswarm.effects.distortion import distortion_columns
from jaxswarm.effects.kinds import BodyChange, MeasurementLaw
from jaxswarm.effects.misreading import misreading_slopes
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.forward.body import body_basis
from jaxswarm.identify.forward.columns import rigid_columns
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.link_lag import read_motion
from jaxswarm.identify.forward.measuring_chain import report_own
from jaxswarm.identify.forward.placement import placement_columns


def measurement_candidate(stand: Linearization, term: Term) -> Candidate:
    """How the model's torque would change in what the drives write down, to first order."""
    law, neutral = term.law, term.law.neutral()
    if law.excess is not None:
        columns = stand.stack(lambda k: stand.reported(k, _turned(stand, term, k)))
        return Candidate(replace(term, values=neutral), stand.on_all(columns), columns.shape[2])
    if law.distortion is not None:
        columns = stand.on_joint(stand.low(lambda k: _distorted(stand, term, k)), term.joint)
        return Candidate(term, stand.on_all(columns), columns.shape[2])

    def slopes(k):
        output, step = stand.outputs[k], 1.0 / stand.found.motions[k].rate
        if term.joint is not None:
            output = output[:, term.joint]
        # Continued straight by a sample: what a delay brings in at the ends is not known.
        ends = 2 * output[[0, -1]] - output[[1, -2]]
        longer = filled(np.concatenate([ends[:1], output, ends[1:]]))
        slope, own = _report_slopes(law, _numbers(neutral), longer, step), slice(1, 1 + len(output))
        return np.stack([np.asarray(slope[p.name])[own] for p in law.parameters], axis=-1)

    low = stand.low(slopes)
    if term.joint is None:
        columns = stand.background.weigh(low)
    else:
        columns = stand.on_joint(low, term.joint)
    return Candidate(replace(term, values=neutral), stand.on_all(columns), columns.shape[2])


# Whole programs: each operation by itself would be traced, lowered and loaded on its own.
@partial(jax.jit, static_argnames="law")
def _report_slopes(law: MeasurementLaw, values: dict, x: jax.Array, step: float) -> dict:
    """How a torque is written down by each parameter: a derivative, or a difference to its probe."""

    def slope(name):
        to = law.probe.get(name)
        if to is None:
            return jax.jacfwd(lambda one: law.report({**values, name: one}, x, step))(values[name])
        return (law.report({**values, name: to}, x, step) - x) / (to - values[name])

    return {p.name: slope(p.name) for p in law.parameters}


@partial(jax.jit, static_argnames="law")
def _gravity_slopes(law: BodyChange, values: dict, gravity: jax.Array) -> dict:
    return jax.jacfwd(lambda p: law.gravity(p, gravity))(values)


def _numbers(values: dict[str, float]) -> dict[str, np.float64]:
    """Values that are data of a program, and no constants of it."""
    return {name: np.float64(value) for name, value in values.items()}


def _distorted(stand: Linearization, term: Term, k: int) -> np.ndarray:
    """What a joint's drive would write down of a log beside the model's torque, (T, p)."""
    torque = stand.outputs[k][:, term.joint]
    own = distortion_columns(term.law, filled(torque))[: len(torque)]
    terms = stand.found.model.terms
    return report_own(terms, stand.found.motions[k], own, term.joint)


def _turned(stand: Linearization, term: Term, k: int) -> np.ndarray:
    """Rigid torque of a log by each parameter of an encoder's error, (T, n, p)."""
    motion = stand.found.motions[k]
    along, own = filled(read_motion(term, motion)), slice(len(motion.t))
    slopes = misreading_slopes(term.law, term.law.neutral(), along)
    by = stand.sensed(term.joint)[k].at(stand.pi)[1:]
    columns = [
        -sum(x * np.asarray(e[p.name])[own, None] for x, e in zip(by, slopes, strict=True))
        for p in term.law.parameters
    ]
    return np.stack(columns, axis=2)


def body_candidate(stand: Linearization, term: Term) -> Candidate:
    """Another gravity or a body on the last link, to first order."""
    law, neutral = term.law, term.law.neutral()
    if law.placement is not None:

        def moved(k):
            at = stand.arm, stand.moved[k], stand.pi
            return stand.reported(k, placement_columns(law, term.joint, *at))

        columns = stand.stack(moved)
        return Candidate(term, stand.on_all(columns), columns.shape[2])
    if law.gravity is not None:
        columns = stand.background.weigh(_gravity_columns(stand, term))
    else:
        bodies = body_basis(law)
        last = slice(-10, None)
        columns = stand.stack(lambda k: stand.reported(k, stand.carried(k)[:, :, last] @ bodies))
        if law.window:
            return windowed_candidate(stand, term, columns)
    return Candidate(replace(term, values=neutral), stand.on_all(columns), columns.shape[2])


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
