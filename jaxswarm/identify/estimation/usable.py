"""What logs need before anything is fitted to them; each lack is refused by name, with a remedy."""

from collections.abc import Sequence

import jax
import numpy as np

from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.logs.motion import Motion


def check_usable(terms: Sequence[Term], motions: Sequence[Motion]) -> None:
    """Refuse logs that a model with these terms cannot be fitted to.

    Raises:
        InputError: If double precision is off, a torque is missing or dead, nothing moves, or a channel
            that a law needs is missing.
    """
    check_precision()
    torques = []
    for motion in motions:
        if motion.tau is None:
            raise InputError(
                f"{motion.source}: has no torque to identify from; add tau_<joint> or current_<joint>"
            )
        if not motion.dq.any():
            raise InputError(
                f"{motion.source}: every velocity is zero, so nothing but gravity could be identified; "
                "pass a log of a moving arm, or leave its dq_<joint> columns out if they are empty"
            )
        _check_channels(terms, motion)
        torques.append(motion.tau)
    for j, joint in enumerate(motions[0].joints):
        values = {float(x) for tau in torques for x in (tau[:, j].min(), tau[:, j].max())}
        if len(values) == 1:
            raise InputError(
                f"{motions[0].source}: the torque of {joint} is {values.pop():g} in every sample: the "
                f"channel is dead, and a fit would trust it beyond all others; repair tau_{joint}"
            )


def check_precision() -> None:
    """Refuse to fit in single precision, in which dependent columns look independent.

    Raises:
        InputError: If JAX works in 32 bits.
    """
    if not jax.config.jax_enable_x64:  # type: ignore[attr-defined]
        raise InputError(
            "JAX works in single precision, in which base parameters cannot be told apart; call "
            'jax.config.update("jax_enable_x64", True) at the start of the program, or run the fit '
            "within `with jax.enable_x64(True):`"
        )


def _check_channels(terms: Sequence[Term], motion: Motion) -> None:
    for term in terms:
        for name in term.law.requires:
            channel = motion.channels.get(name)
            if channel is None or not np.isfinite(channel[:, term.index]).all():
                raise InputError(
                    f"{motion.source}: {term.label(motion.joints)} needs the channel "
                    f"{name}_{motion.joints[term.index]}; log it, or leave {term.effect} out"
                )
