"""Candidates that change the whole model: its gravity, what it carries, how its torque is written down."""

from dataclasses import replace

import jax
import numpy as np

from jaxswarm.decomposition import thin_svd
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.compliant_base import compliant_base
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.own_motion import own_slopes
from jaxswarm.diagnose.candidates.window import windowed_candidate
from jaxswarm.effects.distortion import distortion_columns
from jaxswarm.effects.kinds import BodyChange, MeasurementLaw
from jaxswarm.effects.misreading import misreading_slopes
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.forward.body import body_basis
from jaxswarm.identify.forward.columns import is_kept, low_columns
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.link_lag import read_motion
from jaxswarm.identify.forward.placement import placement_columns
from jaxswarm.identify.forward.written_down import report_own
from jaxswarm.programs import program
from jaxswarm.robot.logged import rigid_columns


def measurement_candidate(lin: Linearization, term: Term) -> Candidate:
    """How the model's torque would change in what the drives write down, to first order."""
    law, neutral = term.law_of(MeasurementLaw), term.law.neutral()
    if law.excess is not None:
        columns = lin.stack(lambda k: lin.reported(k, _turned(lin, term, k)))
        return Candidate(replace(term, values=neutral), lin.on_all(columns), columns.shape[2])
    if law.distortion is not None:
        columns = lin.on_joint(lin.low(lambda k: _distorted(lin, term, k)), term.index)
        return Candidate(term, lin.on_all(columns), columns.shape[2])

    def slopes(k):
        motion = lin.found.motions[k]
        output, step = motion.tau if law.slow else lin.outputs[k], 1.0 / motion.rate
        if term.joint is not None:
            output = output[:, [term.joint, term.other] if law.crosses else term.joint]
        # Continued straight by a sample: what a delay brings in at the ends is not known.
        ends = 2 * output[[0, -1]] - output[[1, -2]]
        longer = filled(np.concatenate([ends[:1], output, ends[1:]]))
        slope, own = _report_slopes(law, _numbers(neutral), longer, step), slice(1, 1 + len(output))
        return np.stack([np.asarray(slope[p.name])[own] for p in law.parameters], axis=-1)

    low = lin.low(slopes)
    if term.joint is None:
        columns = lin.crossfit.weigh(low)
    else:
        columns = lin.on_joint(low, term.joint)
    return Candidate(replace(term, values=neutral), lin.on_all(columns), columns.shape[2])


# Whole programs: each operation by itself would be traced, lowered and loaded on its own.
@program("law")
def _report_slopes(law: MeasurementLaw, values: dict, x: jax.Array, step: float) -> dict:
    """How a torque is written down by each parameter: a derivative, or a difference to its probe."""

    def slope(name):
        to = law.probe.get(name)
        if to is None:
            return jax.jacfwd(lambda one: law.report({**values, name: one}, x, step))(values[name])
        return (law.report({**values, name: to}, x, step) - x) / (to - values[name])

    return {p.name: slope(p.name) for p in law.parameters}


@program("law")
def _gravity_slopes(law: BodyChange, values: dict, gravity: jax.Array) -> dict:
    turned = law.gravity
    assert turned is not None
    return jax.jacfwd(lambda p: turned(p, gravity))(values)


def _numbers(values: dict[str, float]) -> dict[str, np.float64]:
    """Values that are data of a program, and no constants of it."""
    return {name: np.float64(value) for name, value in values.items()}


def _distorted(lin: Linearization, term: Term, k: int) -> np.ndarray:
    """What a joint's drive would write down of a log beside the model's torque, (T, p)."""
    torque = lin.output_of(k, term.index)
    own = distortion_columns(term.law_of(MeasurementLaw), term.values, filled(torque))[
        : len(torque)
    ]
    terms = lin.found.model.terms
    return report_own(terms, lin.found.motions[k], own, term.index)


def _turned(lin: Linearization, term: Term, k: int) -> np.ndarray:
    """Torque of a log, its own laws included, by each parameter of an encoder's error, (T, n, p)."""
    slopes, j = _misread(lin, term, k), term.index
    by = [x.copy() for x in lin.turned(k, j)]
    for x, slope in zip(by, own_slopes(lin, j, k), strict=True):
        x[:, j] += slope
    columns = [
        -sum(x * e[p.name][:, None] for x, e in zip(by, slopes, strict=True))
        for p in term.law.parameters
    ]
    return np.stack(columns, axis=2)


def _misread(lin: Linearization, term: Term, k: int) -> list[dict[str, np.ndarray]]:
    """What an encoder's error on a log and its two derivatives gain by each parameter, (T,) each."""
    motion, known = lin.found.motions[k], lin.memory.misread
    if (term.place, k) in known:  # they follow from what the encoders say
        return known[term.place, k]
    along, own = filled(read_motion(term, motion)), slice(len(motion.t))
    slopes = misreading_slopes(term.law, term.law.neutral(), along)
    found = [{name: np.asarray(x)[own] for name, x in one.items()} for one in slopes]
    if is_kept(motion):
        known[term.place, k] = found
    return found


def body_candidate(lin: Linearization, term: Term) -> Candidate | None:
    """Another gravity or a body on the last link, to first order; None where no window is found."""
    law, neutral = term.law_of(BodyChange), term.law.neutral()
    if law.placement is not None:

        def moved(k):
            at = lin.arm, lin.moved[k], lin.pi
            return lin.reported(k, placement_columns(law, term.index, *at))

        columns = lin.stack(moved)
        return Candidate(replace(term, values=neutral), lin.on_all(columns), columns.shape[2])
    if law.compliance is not None:
        return compliant_base(lin, term)
    if law.gravity is not None:
        columns = lin.crossfit.weigh(_gravity_columns(lin, term))
    else:
        bodies = body_basis(law)
        columns = lin.stack(lambda k: lin.reported(k, lin.carried(k) @ bodies))
        if law.window:
            return windowed_candidate(lin, term, columns)
    return Candidate(replace(term, values=neutral), lin.on_all(columns), columns.shape[2])


def _directions(lin: Linearization, term: Term) -> np.ndarray:
    """Change of gravity by each parameter, (p, 3)."""
    gravity = np.asarray(lin.arm.gravity, float)
    slopes = _gravity_slopes(term.law, _numbers(term.law.neutral()), gravity)
    return np.stack([np.asarray(slopes[p.name]) for p in term.law.parameters])


def _gravity_columns(lin: Linearization, term: Term) -> np.ndarray:
    """Decimated torque by each parameter of a gravity, (T', n, p and more).

    Gravity aside also loads masses that the level arm never felt, such as that of a first link
    about its vertical axis: their torques follow as further columns with free coefficients, by the directions
    in which the level arm's torque stays as it is. What merges into another link's does so in any gravity: it
    made sixteen columns of none on an arm of seven joints, with which a tilt predicted nothing.
    """
    unfelt = lin.found.fit.base.unfelt[: len(lin.pi)]
    *aside, level = _by_gravity(lin, _directions(lin, term))
    known = np.stack([rows @ lin.pi for rows in aside], axis=2)
    free = np.concatenate([rows @ unfelt for rows in aside], axis=2)
    largest = max(np.linalg.norm(rows, axis=(0, 1)).max() for rows in aside)
    # What the level arm's own columns cannot say already, as few columns as span it.
    own = level.reshape(-1, len(lin.pi))
    basis, size, _ = thin_svd(own)
    inside = basis[:, size > 1e-9 * size[0]]
    flat = free.reshape(len(own), -1)
    u, size, _ = thin_svd(flat - inside @ (inside.T @ flat))
    fresh = u[:, size > 1e-6 * largest]
    return np.concatenate([known, fresh.reshape(*known.shape[:2], -1)], axis=2)


def _by_gravity(lin: Linearization, directions: np.ndarray) -> list[np.ndarray]:
    """Decimated rigid columns at rest for gravity along the directions and as it is, (T', n, 10 n) each.

    They follow from the links' positions alone, so that the next round need not build them again.
    """
    measured = of_kind(lin.found.model.terms, MeasurementLaw)
    chain = [(t.place, *t.values.items()) for t in measured]
    arm = np.asarray(lin.arm.translation).tobytes(), np.asarray(lin.arm.rotation).tobytes()
    places = (directions.tobytes(), *arm, *(id(q) for q, _, _ in lin.moved), *chain)
    memory = lin.memory
    if places in memory.gravity:
        return memory.gravity[places][1]

    def columns(gravity):
        arm = lin.arm.replace(gravity=np.asarray(gravity))

        def rows(k):
            q = lin.moved[k][0]
            decimator, zero = lin.found.motions[k].decimator, np.zeros_like(q)
            if not measured:  # of a long log some at a time: all of them are a gigabyte
                return low_columns(arm, (q, zero, zero), decimator)
            return decimator.apply(lin.reported(k, rigid_columns(arm, q, zero, zero)))

        return np.concatenate([rows(k) for k in range(len(lin.moved))])

    found = [columns(g) for g in (*directions, lin.arm.gravity)]
    # The positions are kept with them: their identity is the key.
    memory.gravity = {places: ([q for q, _, _ in lin.moved], found)}
    return found
