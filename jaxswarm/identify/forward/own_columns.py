"""Columns that a term adds by itself, on the working clock."""

from collections.abc import Sequence
from functools import singledispatch

import numpy as np

from jaxswarm.effects.base import Effect
from jaxswarm.effects.distortion import distortion_columns
from jaxswarm.effects.kinds import (
    BodyChange,
    ExternalTorque,
    MeasurementLaw,
    TorqueLaw,
    TransmissionLaw,
)
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.columns import term_columns
from jaxswarm.identify.forward.joint_series import Load
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.logs.motion import Motion


def placed(own: np.ndarray, joint: int, joints: int) -> np.ndarray:
    """Columns (T, k) of one joint as those of all, (T, n, k)."""
    block = np.zeros((len(own), joints, own.shape[1]))
    block[:, joint] = own
    return block


def own_columns(
    term: Term, motion: Motion, width: Sequence[float], load: Load | None
) -> np.ndarray:
    """Columns of a term on the working clock, (T, n, k), zero on joints it does not act on."""
    return law_block(term.law, term, motion, width, load)


@singledispatch
def law_block(
    law: Effect, term: Term, motion: Motion, width: Sequence[float], load: Load | None
) -> np.ndarray:
    """Columns (T, n, k) that a term adds by itself."""
    raise NotImplementedError(f"no columns for effects of kind {type(law).__name__}")


@law_block.register(TransmissionLaw)
@law_block.register(BodyChange)
def _(law, term, motion, width, load):
    return np.zeros((*motion.q.shape, 0))  # they change the columns of others


@law_block.register
def _(law: MeasurementLaw, term, motion, width, load):
    block = np.zeros((*motion.q.shape, len(law.linear)))
    if law.distortion is not None:
        told = distortion_columns(law, term.values, filled(load.whole[:, term.joint]))
        block[:, term.joint] = told[: len(block)]
    return block


@law_block.register
def _(law: TorqueLaw, term, motion, width, load):
    return placed(term_columns(term, motion, width, load), term.joint, motion.q.shape[1])


@law_block.register
def _(law: ExternalTorque, term, motion, width, load):
    return law.weight(term.values, motion.t)[:, None, None] * np.eye(motion.q.shape[1])
