"""Where the model stands when the candidates are proposed."""

from collections.abc import Collection
from copy import copy
from functools import cached_property
from threading import Lock

import jax
import numpy as np

from jaxswarm.decomposition import lstsq
from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.folds.noise import usual_size
from jaxswarm.diagnose.folds.partial_out import CrossFit
from jaxswarm.effects.kinds import MeasurementLaw, TorqueLaw
from jaxswarm.effects.sample import Sample
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.forward.body import Body, arm_of, body_along
from jaxswarm.identify.forward.columns import columns_along, is_kept
from jaxswarm.identify.forward.joint_series import joint_series, partner_series
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.model import Model, linear_values, with_linear_values
from jaxswarm.identify.forward.sensitivity import Sensitivity, sensitivity_of
from jaxswarm.identify.forward.torque_along import torque_along
from jaxswarm.identify.forward.written_down import report, report_own
from jaxswarm.robot.logged import rigid_columns

# Rows beyond this multiple of the noise are left out of a steady fit, and its turns.
_REACH, _TURNS = 3.0, 9
# Directions of the scaled rows weaker than this are rounding: the root of the precision, generously.
_RANK = 3e-7
# Joints, with their partners, of which the series that laws see are kept, and the most numbers that they may
# hold: a law is tried many times in a row. Twelve of a log of a million samples are 1.2 GB; those of a joint
# and of one pair have to do.
_SERIES, _NUMBERS, _LEAST = 12, 2**24, 2


class Linearization:
    """Where the model stands: its torque, motion and loads on every log, and how columns are weighed."""

    def __init__(self, found: Estimate, crossfit: CrossFit, memory: Memory | None = None):
        self.found, self.crossfit, self.memory = found, crossfit, memory or Memory()
        self.memory.look_at(found.motions, found.rigids)
        self.making = Lock()  # two threads that ask for the same fit make it once
        model = found.model
        self.pi = np.asarray(model.robot.parameters).ravel()
        self.arm = arm_of(model.robot, model.terms)
        self.own_slopes: dict[tuple[int, int], np.ndarray] = {}
        self.slopes: dict[tuple[int, int], list[np.ndarray]] = {}
        bodies = self._see(model)
        self.moved = [body.moved for body in bodies]
        self.true = [body.motion for body in bodies]

    def _see(self, model: Model, joints: Collection[int] | None = None) -> list[Body]:
        """Take the loads of a model on every log, of some joints or all; its bodies there."""
        pi = np.asarray(model.robot.parameters).ravel()
        self.seen = model
        self.series: dict[tuple, Sample] = {}
        self.loads, bodies = [], []
        for motion, rigid in zip(self.found.motions, self.found.rigids, strict=True):
            body = body_along(model.robot, model.terms, motion, pi, rigid)
            bodies.append(body)
            self.loads.append(body.load(joints))
        return bodies

    @cached_property
    def outputs(self) -> list[np.ndarray]:
        """Torque (T, n) of the model on every log; laws of the load, tried with many models, ask for none."""
        return [self._torque(k, self.seen.during(k)) for k in range(len(self.found.motions))]

    def output_of(self, k: int, joint: int) -> np.ndarray:
        """Torque (T,) of a joint on a log; that of a model which was changed asks for no other joint's laws."""
        if "outputs" in vars(self):
            return self.outputs[k][:, joint]
        return self._torque(k, self.seen.during(k).on_joint(joint))[:, joint]

    def _torque(self, k: int, own: Model) -> np.ndarray:
        motion, rigid = self.found.motions[k], self.found.rigids[k]
        return torque_along(own.robot, own.terms, motion, own.width, linear_values(own), rigid)

    def by_measured(self) -> "Linearization":
        """The same with the torque that was measured in the place of the model's."""
        other = copy(self)
        vars(other)["outputs"] = [m.tau for m in self.found.motions]
        return other

    def changed_by(self, change: np.ndarray, joint: int | None = None) -> "Linearization":
        """The same with the loads and the torque of a model with its linear parameters changed, by (p,).

        ``joint``: the one whose laws are asked with it alone, if any.
        """
        model, other = self.found.model, copy(self)
        vars(other).pop("outputs", None)
        asked = None if joint is None else {joint}
        other._see(with_linear_values(model, linear_values(model) + change), asked)
        return other

    def carried(self, k: int) -> np.ndarray:
        """Rigid columns (T, n, 10) of the last link along a log, in the model's gravity and motion."""
        return rigid_columns(self.arm, *self.moved[k], first=self.arm.num_joints - 1)

    def sensed(self, joint: int) -> list[Sensitivity]:
        """What the rigid torque of every log does when a joint moves otherwise."""
        return [
            sensitivity_of(self.arm, motion, joint, rigid)
            for motion, rigid in zip(self.found.motions, self.found.rigids, strict=True)
        ]

    @property
    def steady(self) -> tuple[np.ndarray, np.ndarray]:
        """The model fitted to the rows that are within reach of the noise.

        Huber's weights first, then none beyond :data:`_REACH` times the noise, which is the median
        absolute deviation.

        Returns:
            Rigid parameters (10 n,), and the residual of all rows over the noise (T', n).
        """
        with self.making:
            return self._steady

    @cached_property
    def _steady(self) -> tuple[np.ndarray, np.ndarray]:
        regression, solution = self.found.regression, self.found.fit
        columns = regression.columns[:, :, solution.base.kept]
        residual, values = solution.residual, solution.values
        for turn in range(_TURNS):
            noise = np.maximum(usual_size(residual * regression.whole_rows), 1e-300)
            far = np.abs(residual) / noise / _REACH
            weight = np.where(far < 1, 1.0, 0.0) if turn > 2 else np.maximum(far, 1.0) ** -0.5
            rows = (columns * (weight / noise)[:, :, None]).reshape(-1, columns.shape[2])
            target = (regression.target * weight / noise).ravel()
            scale = np.maximum(np.linalg.norm(rows, axis=0), 1e-300)
            triangle = np.asarray(np.linalg.qr(np.column_stack([rows / scale, target]), mode="r"))
            factor, reduced = triangle[:, :-1], triangle[:, -1]
            values = lstsq(factor, reduced, rcond=_RANK) / scale
            residual = regression.target - columns @ values
        return solution.base.expand(values)[: len(self.pi)], residual / noise

    def rotor(self, joint: int) -> np.ndarray:
        """What the rigid parameters (10 n,) hold if all of a joint's inertia is its rotor's.

        While a link follows its motor the two inertias are one. The change of the rigid parameters that
        does what the rotor does, as large as the least inertia of the joint; zeros where no rotor is
        declared.
        """
        full = np.zeros_like(self.pi)
        regression, solution = self.found.regression, self.found.fit
        names = [
            f"{t.law.motor_inertia}_{self.found.model.robot.joints[joint]}:{t.effect}"
            for t in of_kind(self.found.model.terms, TorqueLaw)
            if t.joint == joint and t.law.motor_inertia
        ]
        if not names:
            return full
        inertia = min(float(own.inertia(self.pi).min()) for own in self.sensed(joint))
        if inertia <= 0:
            return full
        rigid = [c for c in solution.base.kept if c < len(full)]
        rows = regression.columns / solution.sigma[:, None]
        matrix = rows[:, :, rigid].reshape(-1, len(rigid))
        target = rows[:, :, regression.names.index(names[0])].ravel()
        scale = np.linalg.norm(matrix, axis=0)
        full[rigid] = lstsq(matrix / scale, target, rcond=1e-8) / scale
        return inertia * full

    def low(self, build) -> np.ndarray:
        """Decimate what ``build(log index)`` gives along its first axis, all logs one after the other."""
        motions = self.found.motions
        return np.concatenate([m.decimator.apply(build(k)) for k, m in enumerate(motions)])

    def reported(self, k: int, block: np.ndarray) -> np.ndarray:
        """Columns (T, n, m) on a log as the drives of the model report them."""
        return report(self.found.model.terms, self.found.motions[k], block)

    def stack(self, build) -> np.ndarray:
        """Decimate and weigh what ``build(log index)`` gives as (T, n, k), all logs."""
        return self.crossfit.weigh(self.low(build))

    def on_joint(self, own: np.ndarray, joint: int) -> np.ndarray:
        """Weigh decimated columns (T', k) of one joint as (T', n, k), all logs."""
        block = np.zeros((len(own), self.found.model.robot.num_joints, own.shape[1]))
        block[:, joint] = own
        return self.crossfit.weigh(block)

    def law(self, term: Term) -> np.ndarray:
        """Columns of a law with its nonlinear parameters in place."""
        motions, width = self.found.motions, self.found.model.width
        terms = self.found.model.terms

        def build(k):
            own = columns_along(term, self._series(k, term.index, term.other))[: len(motions[k].t)]
            return report_own(terms, motions[k], term.acts_in(k) * own, term.index)

        if term.law.uses_load:
            return self.on_joint(self.low(build), term.index)
        # They follow from the motion, and many from that alone: the next round finds them ready.
        laws = self.memory.laws
        own_width = width[term.index] if term.law.uses_direction else None
        place = (term, *term.values.items(), own_width, self._reports)
        if place not in laws:
            laws[place] = self.low(build)
        return self.on_joint(laws[place], term.index)

    @cached_property
    def _reports(self) -> tuple:
        """The model's drives, by which a law's columns are known again."""
        measured = of_kind(self.found.model.terms, MeasurementLaw)
        return tuple((t.place, *t.values.items()) for t in measured)

    def _series(self, k: int, joint: int, other: int | None) -> Sample:
        """What laws on a joint, with a partner, see along a log, where programs have it at hand."""
        place = (k, joint, other)
        sample = self.series.pop(place, None)  # what was asked for last stays longest
        if sample is None:
            width = self.found.model.width
            if other is None:
                seen = joint_series(self.true[k], width, self.loads[k], joint)
                sample = jax.device_put(filled(seen))
            else:  # of a joint with a partner most is the joint's own
                partner = partner_series(self.true[k], width, joint, other)
                sample = self._series(k, joint, None)._replace(**jax.device_put(filled(partner)))
            numbers = len(Sample._fields) * len(sample.t)
            most = min(_SERIES, max(_LEAST, _NUMBERS // numbers))
            while len(self.series) >= most:
                self.series.pop(next(iter(self.series)))
        self.series[place] = sample
        return sample

    def turned(self, k: int, joint: int) -> list[np.ndarray]:
        """Derivatives (T, n) of the rigid torque of a log by q, dq, ddq of a joint.

        Those of all joints of a long log are as large as all else; of the last one they are known anyway.
        """
        if (k, joint) in self.slopes:
            return self.slopes[k, joint]
        slopes = list(self.sensed(joint)[k].at(self.pi)[1:])
        if is_kept(self.found.motions[k]):
            self.slopes[k, joint] = slopes
        return slopes

    def on_all(self, columns: np.ndarray) -> tuple[np.ndarray, ...]:
        """Columns that are the same on every fold."""
        return (columns,) * len(self.crossfit.folds)

    def residuals(self, joint: int) -> np.ndarray:
        """A joint's residual on every fold, (folds, T), zero outside the rows it was fitted to."""
        folds = self.crossfit.folds
        return np.stack([np.where(f.train, f.residual[:, joint], 0.0) for f in folds])
