"""One joint as a search for formulas sees it: its variables, what is left of its torque, what may be taken."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.folds.partial_out import CrossFit, Fold
from jaxswarm.effects.dimensions import Unit, field_units
from jaxswarm.effects.postfix import Program, evaluate
from jaxswarm.identify.forward.joint_series import joint_series
from jaxswarm.robot.logged import rigid_columns

# Rows that are searched on; a longer log is thinned evenly, for programs are smooth against the rows' clock.
_ROWS = 800
# Variables that the parameters of the arm move, rows of which columns are made at a time, and folds whose part
# in them is kept.
LOADS, _BLOCK, _FOLDS = ("load", "static_load"), 4096, 16
# A load that varies by less than this part of itself is a constant: a factor of it says nothing that could be
# told, unless the law is a thousand times the noise.
_STILL_LOAD = 1e-3
# A column whose free part is below this share of its square is one that the model holds already.
OWN = 1e-3


class SearchRows(NamedTuple):
    """The rows of one joint for the compiled search.

    Attributes:
        variables: (V, R), of single precision: a gain of a thousandth is what is told apart.
        weight: What every row is multiplied by, (R,).
        basis: What the model spans on the joint's rows, orthonormal over all joints, (R, b).
        residual: Weighted, (R,).
    """

    variables: jax.Array | np.ndarray
    weight: jax.Array | np.ndarray
    basis: jax.Array | np.ndarray
    residual: jax.Array | np.ndarray


@dataclass(frozen=True)
class Joint:
    """A joint whose residual is searched.

    Attributes:
        joint, other: Index of the joint, and of the partner whose motion may enter; None: none.
        data: Field to its values on the rows of the decimated clock, (T,).
        units: Unit of every field.
        lin: The model, linearized.
        rows: Those of them that the search uses, (T,).
        both: The folds with the partner's rows, where those are left out of ``lin`` because the partner lacks
            something too; None: it does not.
        seen: What :meth:`moving` told of a fold, with it, by its identity.
    """

    joint: int
    other: int | None
    data: Mapping[str, np.ndarray]
    units: Mapping[str, Unit]
    lin: Linearization
    rows: np.ndarray
    both: CrossFit | None = None
    seen: dict = field(default_factory=dict, repr=False, compare=False)

    @cached_property
    def by_load(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Loads among the variables to what they are in the model (T,), and by its base parameters (T, b')."""
        told = {}
        for name in LOADS:
            if name in self.data:
                columns = np.concatenate(list(self._load_columns(name == "load")))
                base = np.zeros((len(columns), len(self.lin.found.fit.base.kept)))
                rigid = [k for k in self.lin.found.fit.base.kept if k < columns.shape[1]]
                base[:, : len(rigid)] = columns[:, rigid]
                told[name] = columns @ self.lin.pi, base
        return told

    def _load_columns(self, moving: bool) -> Iterator[np.ndarray]:
        """A load by the rigid parameters, (T', 10 n) of one log after the other."""
        lin = self.lin
        for motion, (q, dq, ddq) in zip(lin.found.motions, lin.moved, strict=True):
            kept = motion.decimator.kept(len(motion.t))
            for rows in np.array_split(kept, -(-len(kept) // _BLOCK)):
                far = ddq[rows] if moving else np.zeros_like(ddq[rows])
                yield rigid_columns(lin.arm, q[rows], dq[rows], far)[:, self.joint]

    def moving(self, fold: Fold) -> tuple[dict[str, tuple[np.ndarray, np.ndarray]], np.ndarray]:
        """Loads by the coordinates in a fold's basis, and what the other joints' rows say of these.

        Returns:
            Field to what it is in the fold's model (T,), and its slopes (T, b); and the triangular factor of
            the others' training rows with their residual, (b + 1, b + 1).
        """
        if id(fold) not in self.seen:
            others = np.arange(fold.project.shape[1]) != self.joint
            rows = fold.project[fold.train][:, others].reshape(-1, fold.project.shape[2])
            rest = fold.residual[fold.train][:, others].reshape(-1, 1)
            triangle = np.linalg.qr(np.concatenate([rows, rest], axis=1), mode="r")
            # That of a region left out may be far from the model: with a large law in what is left, by as
            # much as the law is large.
            moved = fold.values - self.lin.crossfit.whole.values
            loads = {
                n: (own + by @ moved, by @ fold.solve) for n, (own, by) in self.by_load.items()
            }
            while len(self.seen) >= _FOLDS:
                self.seen.pop(next(iter(self.seen)))
            self.seen[id(fold)] = fold, loads, np.asarray(triangle)
        return self.seen[id(fold)][1:]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the variables, in the order of the searched rows."""
        return tuple(self.data)

    @property
    def angles(self) -> bool:
        """Whether the positions are angles."""
        places = [j for j in (self.joint, self.other) if j is not None]
        return all(self.lin.found.model.robot.kinds[j] == "revolute" for j in places)

    def rows_of(self, fold: Fold) -> SearchRows:
        """The rows that are searched, with a model fitted to them alone."""
        own = fold.trained_on(self.rows)
        kind = np.float32
        return SearchRows(
            np.stack([x[self.rows] for x in self.data.values()]).astype(kind),
            self.lin.crossfit.weight[self.rows, self.joint].astype(kind),
            own.basis[self.rows, self.joint].astype(kind),
            own.residual[self.rows, self.joint].astype(kind),
        )

    def columns(self, programs: Sequence[Program], values: Mapping[str, float]) -> np.ndarray:
        """Weighted columns (T, n, k) of programs on the decimated clock, on the joint alone."""
        known = {**self.data, **values}
        size = len(self.rows)
        own = np.stack([np.broadcast_to(evaluate(p, known, np), size) for p in programs], axis=1)
        return self.lin.on_joint(own, self.joint)


def joint_problem(
    lin: Linearization, joint: int, other: int | None, wanted: Sequence[str] = ()
) -> Joint:
    """The variables of a joint: its own motion and load, a partner's motion, and what else is wanted.

    Args:
        lin: The model, linearized.
        joint, other: See :class:`Joint`.
        wanted: Further fields, such as the time, that may enter.
    """
    fields = ["q", "dq", "ddq", "direction", "load", "static_load", *wanted]
    if other is not None:
        fields += ["q_other", "dq_other", "ddq_other"]
    width = lin.found.model.width
    parts = []
    for motion, load in zip(lin.found.motions, lin.loads, strict=True):
        kept = motion.decimator.kept(len(motion.t))
        series = joint_series(motion, width, load, joint, other)._asdict()
        own = {name: np.asarray(series[name])[kept] for name in fields}
        # All but the sign is smooth against the rows' clock. At a reversal a position stands still, so that
        # what a sign is multiplied by hardly changes while the torque's low-pass goes over its jump: the true
        # sin(q) max(sin(q - c), 0) sign(dq) left 0.38 of the squared error by the sign of single samples, and
        # leaves 0.015 by this one.
        own["direction"] = motion.decimator.apply(series["direction"])
        parts.append(own)
    data = {name: np.concatenate([part[name] for part in parts]) for name in fields}
    data = {name: x for name, x in data.items() if np.isfinite(x).all() and _varies(name, x)}
    used = np.flatnonzero(lin.crossfit.weight.any(axis=1))
    rows = np.zeros(len(lin.crossfit.weight), bool)
    rows[used[:: max(1, -(-len(used) // _ROWS))]] = True
    kinds = lin.found.model.robot.kinds
    units = field_units(kinds[joint], None if other is None else kinds[other])
    return Joint(joint, other, data, units, lin, rows)


def _varies(name: str, x: np.ndarray) -> bool:
    """Whether a variable is none that stands still; of a load, but for the digits of the arm's description.

    The weight on the slide of an arm whose axis was turned by 3.14159265 varied by 4e-9 of itself, and a drag
    by the square of the speed was told as one times that weight, the same to 1e-9 of the noise.
    """
    still = _STILL_LOAD * np.abs(x).max() if name in LOADS else 0.0
    return float(np.ptp(x)) > max(1e-9, still)


def share_of(column: jax.Array, searched: SearchRows) -> jax.Array:
    """Share of the residual's square that a column (R,) takes off, its constant eliminated."""
    weighted = column * searched.weight
    size = weighted @ weighted
    inner = weighted @ searched.basis
    left = size - inner @ inner
    own = (left > OWN * size) & jnp.isfinite(size) & (size > 0.0)
    gain = (weighted @ searched.residual) ** 2 / jnp.where(own, left, 1.0)
    return jnp.where(own, gain, 0.0) / (searched.residual @ searched.residual)
