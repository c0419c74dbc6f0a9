"""One joint's residual as rivals of discovery see it: a library of columns, freed of the declared model.

What a rival chose is refitted together with the declared model and scored on the other motion.
"""

from dataclasses import replace
from functools import cached_property
from types import SimpleNamespace

import numpy as np

from benchmarks.worlds.choosers import CHOOSERS, blocks
from benchmarks.worlds.library import joint_library
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.identify import model_torque
from jaxswarm.identify.forward.measuring_chain import assemble

RIVAL = "stepwise, BIC"
# Share of a column's norm that has to be left once the declared model is taken out of it.
_FREE = 1e-3


class Residual:
    """The residual of a declared model on a joint, with another motion to be scored on.

    Args:
        declared: The fitted declared model.
        motion, clean: The other motion, as measured and without the noise of the torque.
        joint: Index.
    """

    def __init__(self, declared, motion, clean, joint: int):
        self.declared, self.motion, self.clean, self.joint = declared, motion, clean, joint
        self.crossfit = cross_fit(declared)
        self.train = declared.motions[0]

    @property
    def target(self) -> np.ndarray:
        """The joint's weighted residual, (T,)."""
        return self.crossfit.whole.residual[:, self.joint]

    @cached_property
    def library(self) -> tuple[list[str], np.ndarray]:
        """Labels and columns (T', L) of the library on the rows of the fit."""
        labels, columns = self._library(self.train)
        return labels, self.train.decimator.apply(columns)

    @cached_property
    def free(self) -> tuple[np.ndarray, np.ndarray]:
        """Which columns of the library the model does not hold, and these freed of it, of unit norm (T', m)."""
        weighted = self._weighted(self.library[1])
        free = self.crossfit.whole.free_part(weighted)[:, self.joint]
        norms = np.linalg.norm(free, axis=0)
        whole = np.linalg.norm(weighted[:, self.joint], axis=0)
        usable = np.flatnonzero(norms > _FREE * np.maximum(whole, 1e-12))
        return usable, free[:, usable] / norms[usable]

    def chosen(self, kept: np.ndarray) -> dict:
        """The labels and the error of columns of the library, refitted with the declared model."""
        labels, here = self.library
        there = self.motion.decimator.apply(self._library(self.motion)[1])
        named = sorted({labels[k] for k in kept})
        return {"named": named, "error": self.error(here[:, kept], there[:, kept])}

    def error(self, here: np.ndarray, there: np.ndarray) -> float:
        """RMS error on the other motion of columns (T', k) on both, refitted with the declared model."""
        base = self.declared.fit.base
        rows = [
            self.crossfit.weigh(self.declared.regression.columns[:, :, base.kept]),
            self._weighted(here),
        ]
        matrix = np.concatenate(rows, axis=2)
        matrix = matrix.reshape(-1, matrix.shape[2])
        target = (self.declared.regression.target * self.crossfit.weight).ravel()
        scale = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
        values = np.linalg.lstsq(matrix / scale, target, rcond=1e-10)[0] / scale
        model, motion = self.declared.model, self.motion
        pi = np.asarray(model.robot.parameters).ravel()
        own = assemble(model.robot, model.terms, motion, model.width, pi, decimate=True)
        told = np.concatenate([own[:, :, base.kept], self._on_joint(there)], axis=2) @ values
        left = motion.decimator.apply(self.clean.tau) - told
        return float(np.sqrt((left[:, self.joint] ** 2).mean()))

    def fields(self, motion) -> np.ndarray:
        """Position, velocity, acceleration, sign and load of all joints along a motion, (T', 15)."""
        load, sign = self._load(motion), np.tanh(motion.dq / np.asarray(self.declared.model.width))
        kept = motion.decimator.kept(len(motion.t))
        parts = (motion.q, motion.dq, motion.ddq, sign, load)
        return np.concatenate([part[kept] for part in parts], axis=1)

    def _weighted(self, own: np.ndarray) -> np.ndarray:
        return self.crossfit.weigh(self._on_joint(own))

    def _on_joint(self, own: np.ndarray) -> np.ndarray:
        block = np.zeros((len(own), self.declared.model.robot.num_joints, own.shape[1]))
        block[:, self.joint] = own
        return block

    def _load(self, motion) -> np.ndarray:
        """Torque of the rigid bodies alone, (T, n)."""
        return model_torque(replace(self.declared.model, terms=(), smooth=()), motion)

    def _library(self, motion) -> tuple[list[str], np.ndarray]:
        """Labels and columns (T, L) of the library on the joint along a motion."""
        load = self._load(motion)
        size = load.shape[1]
        width = np.asarray(self.declared.model.width)
        arm = SimpleNamespace(size=size, sliding=(False,) * size, width=width)
        still = np.zeros_like(load)
        sign = np.tanh(motion.dq / width)
        pairs = joint_library(arm, motion, sign, load, [still, still], self.joint)
        labels, columns = zip(*pairs, strict=True)
        return list(labels), np.stack(columns, axis=1)


def rival(declared, motion, clean, joint: int) -> dict:
    """Columns of the library chosen by BIC on the joint's residual, refitted, scored on the other motion."""
    residual = Residual(declared, motion, clean, joint)
    usable, x = residual.free
    y = residual.target
    return residual.chosen(usable[CHOOSERS[RIVAL](x, y, blocks(len(y)))])
