"""An earlier model with one change in it."""

from collections.abc import Sequence
from dataclasses import replace
from functools import singledispatch

import jax.numpy as jnp
import numpy as np

from jaxswarm.decomposition import lstsq, thin_svd
from jaxswarm.effects.base import Effect
from jaxswarm.effects.kinds import (
    BodyChange,
    ExternalTorque,
    MeasurementLaw,
    TorqueLaw,
    TransmissionLaw,
)
from jaxswarm.identify.forward.body import arm_of
from jaxswarm.identify.forward.columns import low_columns
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Motion


@singledispatch
def apply_change(law: Effect, model: Model, change, motions: Sequence[Motion]) -> Model:
    """The model with one change in it.

    Args:
        law: The changed term's, for the dispatch.
        model: The model so far.
        change: A :class:`~jaxswarm.diagnose.selection.change_apply.Change`.
        motions: The logs.
    """
    raise NotImplementedError(f"no changes of kind {type(law).__name__}")


@apply_change.register(TorqueLaw)
@apply_change.register(TransmissionLaw)
@apply_change.register(ExternalTorque)
@apply_change.register(MeasurementLaw)
def _(law, model, change, motions):
    if not change.known:
        return replace(model, terms=(*model.terms, change.term))
    terms = tuple(
        replace(t, values=change.now) if t.identity == change.term.identity else t
        for t in model.terms
    )
    return replace(model, terms=terms)


@apply_change.register
def _(law: BodyChange, model, change, motions):
    if law.body is not None and not law.window:
        added = jnp.asarray(model.robot.parameters).at[-1].add(law.body(change.term.values))
        return replace(model, robot=model.robot.replace(parameters=added))
    model = replace(model, terms=(*model.terms, change.term))
    return model if change.further is None else _with_masses(model, motions, change.further)


def _with_masses(model: Model, motions: Sequence[Motion], torque: np.ndarray) -> Model:
    """The tilted model with the masses that the level arm never felt, from their torque (T', n).

    They lie in the directions of the parameters that leave the level arm's torque as it is.
    """

    def rows(arm):
        parts = [low_columns(arm, (m.q, m.dq, m.ddq), m.decimator) for m in motions]
        return np.concatenate(parts).reshape(torque.size, -1)

    level = rows(model.robot)
    _, size, directions = thin_svd(level)
    unfelt = directions[size <= 1e-9 * size[0]].T
    felt = rows(arm_of(model.robot, model.terms)) @ unfelt
    change = unfelt @ lstsq(felt, torque.ravel(), rcond=1e-6)
    parameters = model.robot.parameters + jnp.asarray(change.reshape(-1, 10))
    return replace(model, robot=model.robot.replace(parameters=parameters))
