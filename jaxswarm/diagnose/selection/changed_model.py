"""An earlier model with one change in it."""

from collections.abc import Sequence
from dataclasses import replace
from functools import singledispatch

import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.base import Effect
from jaxswarm.effects.kinds import (
    BodyChange,
    ExternalTorque,
    MeasurementLaw,
    TorqueLaw,
    TransmissionLaw,
)
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.columns import rigid_columns
from jaxswarm.identify.forward.measuring_chain import tilted
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Motion


@singledispatch
def apply_change(
    law: Effect, model: Model, term: Term, motions: Sequence[Motion], further: np.ndarray
) -> Model:
    """The model with one change in it.

    Args:
        law: The term's, for the dispatch.
        model: The model so far.
        term: With the values of the change.
        motions: The logs.
        further: Torque (T', n) of what a candidate's further columns added.
    """
    raise NotImplementedError(f"no changes of kind {type(law).__name__}")


@apply_change.register(TransmissionLaw)
@apply_change.register(ExternalTorque)
@apply_change.register(MeasurementLaw)
def _(law, model, term, motions, further):
    return replace(model, terms=(*model.terms, term))


@apply_change.register
def _(law: TorqueLaw, model, term, motions, further):
    if all(t.place != term.place for t in model.terms):
        return replace(model, terms=(*model.terms, term))
    names = {p.name for p in law.linear}
    terms = []
    for old in model.terms:
        if old.place == term.place:
            added = {n: term.values.get(n, 0.0) for n in names}
            old = replace(old, values={n: v + added.get(n, 0.0) for n, v in old.values.items()})
        terms.append(old)
    return replace(model, terms=tuple(terms))


@apply_change.register
def _(law: BodyChange, model, term, motions, further):
    if law.gravity is not None:
        return _with_masses(replace(model, terms=(*model.terms, term)), motions, further)
    parameters = jnp.asarray(model.robot.parameters).at[-1].add(law.body(term.values))
    return replace(model, robot=model.robot.replace(parameters=parameters))


def _with_masses(model: Model, motions: Sequence[Motion], torque: np.ndarray) -> Model:
    """The tilted model with the masses that the level arm never felt, from their torque (T', n).

    They lie in the directions of the parameters that leave the level arm's torque as it is.
    """

    def rows(arm):
        parts = [m.decimator.apply(rigid_columns(arm, m.q, m.dq, m.ddq)) for m in motions]
        return np.concatenate(parts).reshape(torque.size, -1)

    level = rows(model.robot)
    _, size, directions = np.linalg.svd(level, full_matrices=False)
    unfelt = directions[size <= 1e-9 * size[0]].T
    felt = rows(tilted(model.robot, model.terms)) @ unfelt
    change = unfelt @ np.linalg.lstsq(felt, torque.ravel(), rcond=1e-6)[0]
    parameters = model.robot.parameters + jnp.asarray(change.reshape(-1, 10))
    return replace(model, robot=model.robot.replace(parameters=parameters))
