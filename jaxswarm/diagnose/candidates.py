r"""The columns a suspect would add to the model, for the whole log and for each half.

A law's torque is linear in its linear parameters, so its columns are exact. An effect that moves the
links, the clock or the scale is taken to first order about the current model: the difference it makes to
the model's torque, or the derivative of that by its parameter. Once added, it is refitted exactly.
"""

from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np
from scipy import ndimage

from jaxswarm.diagnose.background import Background
from jaxswarm.diagnose.search import Stage, search_law
from jaxswarm.effects.warps import contact_stiffness, deflection
from jaxswarm.identify.assemble import assemble, link_motion, sensitivity_columns, tilted, warped
from jaxswarm.identify.columns import Load, rigid_columns, term_columns
from jaxswarm.identify.estimate import Estimate
from jaxswarm.identify.model import linear_values
from jaxswarm.identify.terms import Term

_SOFT = [(k, d) for k in np.geomspace(30.0, 3e5, 17) for d in (0.003, 0.01, 0.03, 0.1)]
_GAPS = np.geomspace(2e-4, 0.06, 44)
_SETTLE = 3
# Time [s] over which the torque of a loose joint is averaged before it is judged.
_BLUR = 0.12


@dataclass(frozen=True)
class Candidate:
    """A suspect with what it would add.

    Attributes:
        term: With the nonlinear parameters found on all rows.
        columns: Weighted columns (T, n, k) for the whole log, the first half, the second half, each
            with the nonlinear parameters found on its own rows.
        size: Parameters it spends, linear and nonlinear.
        blur: Rows over which it is averaged before it is judged. When a loose gear strikes is decided
            by torques below the noise; how the load shifts around the strike is not.
        signed: Whether the coefficient is a change of something known, of either sign.
    """

    term: Term
    columns: tuple[np.ndarray, np.ndarray, np.ndarray]
    size: int
    blur: int = 1
    signed: bool = False

    def view(self, x: np.ndarray) -> np.ndarray:
        """Average (T, ...) over ``blur`` rows."""
        if self.blur == 1:
            return x
        return ndimage.uniform_filter1d(x, self.blur, axis=0, mode="nearest")

    @property
    def positive(self) -> bool:
        """Whether physics wants its single coefficient positive."""
        law = self.term.law
        if self.signed:
            return False
        if law.warp in ("elastic", "play"):
            return True
        return len(law.linear) == 1 and law.linear[0].lower >= 0


class Columns:
    """Builds the columns of suspects against one estimate; logs are prepared once."""

    def __init__(self, found: Estimate, background: Background, key: jax.Array):
        self.found, self.background, self.key = found, background, key
        model = found.model
        self.pi = np.asarray(model.robot.parameters).ravel()
        theta = linear_values(model)
        arm = tilted(model.robot, model.terms)
        self.loads, self.outputs, self.moved = [], [], []
        plain = not any(warped(model.terms, w) for w in ("elastic", "play", "gravity"))
        for motion, rigid in zip(found.motions, found.rigids, strict=True):
            if plain:
                moved, full, static = (motion.q, motion.dq, motion.ddq), rigid.full, rigid.static
            else:
                moved = link_motion(arm, model.terms, motion, self.pi)
                full = rigid_columns(arm, *moved)
                static = rigid_columns(arm, moved[0], moved[1], np.zeros_like(moved[2]))
            self.loads.append(Load(full @ self.pi, static @ self.pi))
            self.outputs.append(
                assemble(model.robot, model.terms, motion, model.width, self.pi, rigid) @ theta
            )
            self.moved.append(moved)
        self.arm = arm

    def stack(self, build) -> np.ndarray:
        """Decimate and weigh what ``build(log index)`` gives as (T, n, k), all logs."""
        parts = [
            self.found.motions[k].decimator.apply(build(k)) for k in range(len(self.found.motions))
        ]
        return self.background.weigh(np.concatenate(parts))

    def place(self, own: np.ndarray, joint: int) -> np.ndarray:
        """Columns (T, k) of one joint as (T, n, k)."""
        block = np.zeros((len(own), self.found.model.robot.num_joints, own.shape[1]))
        block[:, joint] = own
        return block

    def law(self, term: Term) -> np.ndarray:
        """Columns of a law with its nonlinear parameters in place."""
        width = self.found.model.width
        return self.stack(
            lambda k: self.place(
                term_columns(term, self.found.motions[k], width, self.loads[k]), term.joint
            )
        )

    def gather(self, suspects: tuple[Term, ...]) -> list[Candidate]:
        """All suspects as candidates; nonlinear laws are searched, law by law."""
        done: list[Candidate] = []
        by_law: dict[str, list[Term]] = {}
        for term in suspects:
            by_law.setdefault(term.effect, []).append(term)
        for terms in by_law.values():
            law = terms[0].law
            if law.torque is None:
                done.extend(self._warp(term) for term in terms)
            elif law.nonlinear:
                done.extend(self._searched(terms))
            else:
                for term in terms:
                    columns = self.law(term)
                    done.append(Candidate(term, (columns,) * 3, len(law.linear)))
        return [c for c in done if c is not None]

    def _searched(self, terms: list[Term]) -> list[Candidate]:
        law = terms[0].law
        longest = int(np.argmax([len(m.t) for m in self.found.motions]))
        rows = self.found.regression.log == longest
        stages = []
        for j in range(self.found.model.robot.num_joints):
            folds = [
                Stage(
                    _padded(f.basis[rows, j]),
                    jnp.asarray(np.where(f.train[rows], f.residual[rows, j], 0.0)),
                    jnp.asarray(f.train[rows], float),
                )
                for f in self.background.folds
            ]
            stages.append(jax.tree.map(lambda *x: jnp.stack(x), *folds))
        stages = jax.tree.map(lambda *x: jnp.stack(x), *stages)
        values = search_law(
            law,
            self.found.motions[longest],
            self.found.model.width,
            self.loads[longest],
            stages,
            [(t.joint, t.other) for t in terms],
            self.key,
        )
        done = []
        for term, per_fold in zip(terms, values, strict=True):
            placed = [replace(term, values=v) for v in per_fold]
            columns = tuple(self.law(t) for t in placed)
            done.append(Candidate(placed[0], columns, len(law.parameters)))
        return done

    def _warp(self, term: Term) -> Candidate | None:
        kind = term.law.warp
        if kind == "gain":
            columns = self.stack(
                lambda k: self.place(self.outputs[k][:, term.joint, None], term.joint)
            )
            return Candidate(replace(term, values={"gain": 1.0}), (columns,) * 3, 1)
        if kind == "delay":
            columns = self.stack(
                lambda k: (
                    -np.gradient(self.outputs[k], 1.0 / self.found.motions[k].rate, axis=0)[
                        :, :, None
                    ]
                )
            )
            return Candidate(replace(term, values={"seconds": 0.0}), (columns,) * 3, 1)
        if kind == "gravity":
            columns = self.stack(self._tilt)
            return Candidate(
                replace(term, values={"gx": 0.0, "gy": 0.0}), (columns,) * 3, columns.shape[2]
            )
        if kind == "payload":
            last = slice(-10, None)
            columns = self.stack(lambda k: self.found.rigids[k].full[:, :, last])
            return Candidate(term, (columns,) * 3, 10)
        if kind == "window":
            return self._touch(term)
        return self._lagging(term)

    def _tilt(self, k: int) -> np.ndarray:
        """Torque of a unit of gravity along base x and y, (T, n, 2 and more).

        Gravity aside also loads masses that the level arm never felt, such as that of a first link
        about its vertical axis: their torques follow as further columns with free coefficients.
        """
        zero = np.zeros_like(self.moved[k][1])
        unknown = np.setdiff1d(np.arange(len(self.pi)), self.found.fit.base.kept)
        known, free = [], []
        for axis in np.eye(3)[:2]:
            arm = self.arm.replace(gravity=jnp.asarray(axis))
            rows = rigid_columns(arm, self.moved[k][0], zero, zero)
            known.append(rows @ self.pi)
            free.append(rows[:, :, unknown])
        known, free = np.stack(known, axis=2), np.concatenate(free, axis=2)
        # What the level arm's own columns cannot say already, as few columns as span it.
        own = rigid_columns(self.arm, self.moved[k][0], zero, zero).reshape(-1, len(self.pi))
        basis = np.linalg.svd(own, full_matrices=False)
        inside = basis[0][:, basis[1] > 1e-9 * basis[1][0]]
        flat = free.reshape(len(own), -1)
        u, size, _ = np.linalg.svd(flat - inside @ (inside.T @ flat), full_matrices=False)
        fresh = u[:, size > 1e-6 * max(np.linalg.norm(flat, axis=0).max(), 1e-300)]
        return np.concatenate([known, fresh.reshape(*known.shape[:2], -1)], axis=2)

    def _lagging(self, term: Term) -> Candidate | None:
        """A soft or loose joint: the best of a lattice of stiffness and damping, or of gaps.

        When the link crosses the play depends on small torques, and the parameters were fitted without
        the play: they are settled with every gap, to first order, before it is judged.
        """
        soft, j = term.law.warp == "elastic", term.joint
        motions = self.found.motions
        sensed = [sensitivity_columns(self.arm, m, j) for m in motions]
        inertia = sensed[0][3][:, j] @ self.pi
        if np.median(np.abs(inertia)) < 1e-6:
            return None
        stiff, damped = (float(x) for x in contact_stiffness(jnp.asarray(inertia)))
        if soft:
            unit = 20.0 * np.sqrt(float(np.median(np.abs(inertia))))
            options = [{"k": k, "d": r * np.sqrt(k) * unit} for k, r in _SOFT]
        else:
            options = [{"gap": g} for g in _GAPS]
        limits = {p.name: (p.lower, p.upper) for p in term.law.parameters}
        options = [{n: float(np.clip(v, *limits[n])) for n, v in o.items()} for o in options]
        k = np.array([o.get("k", stiff) for o in options])
        d = np.array([o.get("d", damped) for o in options])
        gap = np.array([o.get("gap", 0.0) for o in options])
        pis = np.repeat(self.pi[None], len(options), axis=0)
        for _ in range(1 if soft else _SETTLE):
            curves = np.concatenate(
                [
                    _lag_torque(m, columns, j, pis, k, d, gap)
                    for m, columns in zip(motions, sensed, strict=True)
                ],
                axis=1,
            )
            curves = curves * self.background.weight
            pis = self.pi - np.stack([self._absorbed(c) for c in curves])
        blur = 1 if soft else max(1, round(_BLUR / self.found.regression.step[0]))
        judge = Candidate(term, (), 2 if soft else 1, blur)
        picks = []
        for fold in self.background.folds:
            residual = judge.view(fold.residual)[fold.train]
            free = (judge.view(fold.free_part(c[:, :, None])[..., 0])[fold.train] for c in curves)
            picks.append(int(np.argmax([_single_gain(c, residual) for c in free])))
        columns = tuple(curves[p][:, :, None] for p in picks)
        return replace(judge, term=replace(term, values=options[picks[0]]), columns=columns)

    def _absorbed(self, torque: np.ndarray) -> np.ndarray:
        """Change of the rigid parameters (10 n,) by which the model takes up a weighted torque."""
        base = self.found.fit.base
        full = np.zeros(len(base.names))
        change = self.background.whole.absorbed(torque)
        full[base.kept[: len(change)]] = change
        return full[: len(self.pi)]

    def _touch(self, term: Term) -> Candidate | None:
        """The window whose constant torques explain most, found on running sums of the residual."""
        regression, residual = self.found.regression, self.background.whole.residual
        total = np.concatenate([np.zeros((1, residual.shape[1])), np.cumsum(residual, axis=0)])
        best, pick = 0.0, None
        for length in np.unique(np.geomspace(8, len(residual) // 3, 24).astype(int)):
            change = total[length:] - total[:-length]
            gain = (change**2).sum(axis=1) / length
            if gain.max() > best:
                first = int(np.argmax(gain))
                if regression.log[first] == regression.log[first + length - 1]:
                    best, pick = gain.max(), (first, first + length - 1)
        if pick is None:
            return None
        start, end = regression.t[pick[0]], regression.t[pick[1]]
        log = regression.log[pick[0]]

        def build(k):
            motion = self.found.motions[k]
            inside = (motion.t >= start) & (motion.t <= end) & (k == log)
            return inside[:, None, None] * np.eye(residual.shape[1])

        columns = self.stack(build)
        values = {"start": float(start), "end": float(end)}
        return Candidate(replace(term, values=values), (columns,) * 3, 2 + residual.shape[1])


def _lag_torque(motion, columns, joint, pis, k, d, gap) -> np.ndarray:
    """Decimated torque (m, T', n) that a lagging link changes, for m options with their parameters."""
    torque, by_q, by_dq, by_ddq = (np.einsum("tnp,mp->mtn", c, pis) for c in columns)

    def lag(tau, s, c, m, k, d, gap):
        return deflection(m, c, s, tau, k, d, gap, 1.0 / motion.rate, 2)

    own = [jnp.asarray(x[:, :, joint]) for x in (torque, by_q, by_dq, by_ddq)]
    e, v, a = (np.asarray(x) for x in jax.vmap(lag)(*own, *map(jnp.asarray, (k, d, gap))))
    # A model whose inertia is not positive somewhere lets the lag run away: no candidate.
    alive = np.isfinite(a).all(axis=1) & (np.abs(e).max(axis=1) < 1.0)
    e, v, a = (np.where(alive[:, None], x, 0.0)[:, :, None] for x in (e, v, a))
    change = -(e * by_q + v * by_dq + a * by_ddq)
    return np.stack([motion.decimator.apply(c) for c in change])


def _padded(basis: np.ndarray, multiple: int = 16) -> jax.Array:
    """Basis columns filled up with zeros, so that a model that grows does not recompile the search."""
    return jnp.asarray(np.pad(basis, ((0, 0), (0, -basis.shape[1] % multiple))))


def _single_gain(column: np.ndarray, residual: np.ndarray) -> float:
    """Sum of squares that one column (T, n) with a positive coefficient explains."""
    size, inner = float((column**2).sum()), float((column * residual).sum())
    return inner**2 / size if size > 0 and inner > 0 else 0.0
