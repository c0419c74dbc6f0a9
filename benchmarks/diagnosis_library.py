"""The rival of discovery: columns of the worlds' library chosen by BIC on one joint's residual."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np

from benchmarks.worlds.choosers import CHOOSERS, blocks
from benchmarks.worlds.library import joint_library
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.identify import model_torque
from jaxswarm.identify.forward.measuring_chain import assemble

RIVAL = "stepwise, BIC"


def rival(declared, motion, clean, joint: int) -> dict:
    """Columns of the library chosen by BIC on the joint's residual, refitted, scored on the other motion."""
    model, base = declared.model, declared.fit.base
    pi = np.asarray(model.robot.parameters).ravel()
    crossfit = cross_fit(declared)
    train = declared.motions[0]
    labels, columns = _library(declared, train, joint)
    weighted = crossfit.weigh(_on_joint(train.decimator.apply(columns), joint))
    free = crossfit.whole.free_part(weighted)[:, joint]
    norms = np.linalg.norm(free, axis=0)
    whole = np.linalg.norm(weighted[:, joint], axis=0)
    usable = np.flatnonzero(norms > 1e-3 * np.maximum(whole, 1e-12))
    y = crossfit.whole.residual[:, joint]
    kept = usable[CHOOSERS[RIVAL](free[:, usable] / norms[usable], y, blocks(len(y)))]
    rows = [crossfit.weigh(declared.regression.columns[:, :, base.kept]), weighted[:, :, kept]]
    matrix = np.concatenate(rows, axis=2).reshape(-1, len(base.kept) + len(kept))
    target = (declared.regression.target * crossfit.weight).ravel()
    scale = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
    values = np.linalg.lstsq(matrix / scale, target, rcond=1e-10)[0] / scale
    own = assemble(model.robot, model.terms, motion, model.width, pi, decimate=True)[
        :, :, base.kept
    ]
    there = _on_joint(motion.decimator.apply(_library(declared, motion, joint)[1]), joint)
    told = np.concatenate([own, there[:, :, kept]], axis=2) @ values
    left = motion.decimator.apply(clean.tau) - told
    return {
        "named": sorted({labels[k] for k in kept}),
        "error": float(np.sqrt((left[:, joint] ** 2).mean())),
    }


def _on_joint(own: np.ndarray, joint: int) -> np.ndarray:
    block = np.zeros((len(own), 3, own.shape[1]))
    block[:, joint] = own
    return block


def _library(declared, motion, joint: int) -> tuple[list[str], np.ndarray]:
    """Labels and columns (T, L) of the library on one joint along a motion."""
    model = declared.model
    alone = replace(model, terms=(), smooth=())
    load = model_torque(alone, motion)
    arm = SimpleNamespace(size=3, sliding=(False,) * 3, width=np.asarray(model.width))
    still = np.zeros_like(load)
    sign = np.tanh(motion.dq / arm.width)
    labels, columns = zip(
        *joint_library(arm, motion, sign, load, [still, still], joint), strict=True
    )
    return list(labels), np.stack(columns, axis=1)
