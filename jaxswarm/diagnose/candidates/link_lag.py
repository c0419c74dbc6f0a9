"""The torque that a link behind its motor changes, for many values of its parameters at once."""

from dataclasses import replace

import jax
import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.folds.partial_out import Fold
from jaxswarm.effects.deflection import deflection
from jaxswarm.effects.kinds import TransmissionLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.link_lag import calm_start
from jaxswarm.identify.forward.measuring_chain import report, report_own
from jaxswarm.identify.forward.sensitivity import Sensitivity
from jaxswarm.logs.motion import Motion
from jaxswarm.programs import program

# Shares of a joint's inertia that its rotor may hold.
ROTOR_SHARES = np.linspace(0.0, 0.9, 7)
_MOST_LAG = 1.0
# Options are filled up to the first, where each feels something of its own, or to multiples of the second, so
# that few programs serve all lattices: an option more costs a tenth of a millisecond, a program a tenth of a
# second.
_FEW, _MANY = 24, 72
# Numbers that a torque of all options may hold: of a long log some options pass at a time. A link's swing and
# its derivatives are as many as the torques of so many joints.
MOST_NUMBERS, _SWINGS = 2**24, 4


# Stiffness, damping, dead zone and hardening of options, each (m,).
Gears = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def lag_torque(
    motion: Motion,
    sensed: Sensitivity,
    pis: np.ndarray,
    k: np.ndarray,
    d: np.ndarray,
    gap: np.ndarray,
    hard: np.ndarray,
    substeps: int = 2,
    terms: tuple[Term, ...] = (),
    own: bool = False,
) -> np.ndarray:
    """Decimated torque (m, T', n) that a lagging link changes, for m options with their parameters.

    Args:
        motion: The log.
        sensed: What the rigid torque does when the joint moves otherwise.
        pis: Rigid parameters, (m, 10 n); one row serves all options.
        k, d, gap, hard: Stiffness, damping, dead zone and hardening, each (m,).
        substeps: Integration steps per sample.
        terms: The model's, whose drives report the torque.
        own: Whether the torque of the joint itself is enough: (m, T', 1).
    """
    count, joints = motion.q.shape
    at_once = max(1, MOST_NUMBERS // (count * max(_SWINGS, 1 if own else joints)))
    found = np.empty(0)
    for start in range(0, len(k), at_once):
        some = slice(start, start + at_once)
        felt = sensed.at(pis if len(pis) == 1 else pis[some], _acted_on(sensed, own))
        gear = (k[some], d[some], gap[some], hard[some])
        part = _changed(motion, sensed.joint, felt, gear, substeps, terms, own, at_once)
        if len(part) == len(k):
            return part
        if not start:
            found = np.empty((len(k), *part.shape[1:]))
        found[some] = part
    return found


def joined(parts: list[np.ndarray], axis: int) -> np.ndarray:
    """Torques (m, T', n) of groups of options (axis 0) or of logs (1) as one; a single one is not copied."""
    return parts[0] if len(parts) == 1 else np.concatenate(parts, axis=axis)


def _acted_on(sensed: Sensitivity, own: bool) -> slice:
    """The joints whose torque is asked for."""
    return slice(sensed.joint, sensed.joint + 1) if own else slice(None)


def _changed(
    motion: Motion,
    moving: int,
    sensed: tuple[np.ndarray, ...],
    gear: tuple[np.ndarray, ...],
    substeps: int,
    terms: tuple[Term, ...],
    own: bool,
    most: int,
) -> np.ndarray:
    """The torque of :func:`lag_torque` for options that stand in memory together, (m, T', n or 1)."""
    torque, by_q, by_dq, by_ddq = sensed
    joint, count = 0 if own else moving, len(gear[0])
    felt, gear = _held(tuple(x[:, joint] for x in (torque, by_q, by_dq, by_ddq)), gear, most)
    swings = _lags(*felt, *gear, 1.0 / motion.rate, calm_start(motion), substeps)
    e, v, a = (np.asarray(x)[: len(motion.t), :count] for x in swings)
    # A model whose inertia is not positive somewhere lets the lag run away: no candidate.
    alive = np.isfinite(a).all(axis=0) & (np.abs(e).max(axis=0) < _MOST_LAG)
    lags = np.stack([np.where(alive, x, 0.0) for x in (e, v, a)], axis=1)
    if by_q.shape[2] == 1:
        # One small product a sample: the numbers pass through memory once, not five times.
        change = np.concatenate(sensed[1:], axis=2) @ lags
    else:
        change = lags[:, :1] * by_q
        change += lags[:, 1:2] * by_dq
        change += lags[:, 2:] * by_ddq
    told = report_own(terms, motion, change[:, 0], moving) if own else change
    told = told[:, None] if own else report(terms, motion, told)
    return -np.moveaxis(motion.decimator.apply(told), 2, 0)


def _held(felt: tuple[np.ndarray, ...], gear: tuple[np.ndarray, ...], most: int) -> tuple:
    """What the joint feels (T, 1 or m) and gears (m,) with samples and options filled up by the last.

    Options are not filled up to more than the ``most`` that a long log takes at a time.
    """
    count, own = len(gear[0]), felt[0].shape[1] > 1
    more = -count % min(_FEW if own and count <= _FEW else _MANY, most)
    felt = filled(felt)
    if own:
        felt = tuple(np.pad(x, ((0, 0), (0, more)), mode="edge") for x in felt)
    return felt, tuple(np.pad(x, (0, more), mode="edge") for x in gear)


@program("substeps")
def _lags(torque, by_q, by_dq, by_ddq, k, d, gap, hard, step, calm, substeps):
    """Lags (T, m) and their derivatives of m options; see :func:`deflection`.

    What all options feel alike, (T, 1), stays one signal: written out for each it is most of the work.
    """

    def lag(tau, s, c, m, *gear):
        return deflection(m, c, s, tau, *gear, step, calm, substeps)

    alike = torque.shape[1] == 1
    felt = (x[:, 0] if alike else x for x in (torque, by_q, by_dq, by_ddq))
    axes = (*(None if alike else 1,) * 4, *(0,) * 4)
    return jax.vmap(lag, in_axes=axes, out_axes=1)(*felt, k, d, gap, hard)


def gears(law: TransmissionLaw, options: list[dict], sensed: Sensitivity, pi: np.ndarray) -> Gears:
    """What makes gears of options (m,) with the link's inertia on a log, as the fit has them."""
    # A gear is as stiff as the median inertia asks for: taken once, not for every option.
    inertia = np.median(np.abs(sensed.inertia(pi)), keepdims=True)
    found = [law.gear(option, inertia) for option in options]
    k, d, gap, hard = (np.array([float(x) for x in own]) for own in zip(*found, strict=True))
    return k, d, gap, hard


def best_option(probe: Candidate, fold: Fold, curves: np.ndarray) -> int:
    """The option whose torque, with a positive coefficient, explains most of a fold's rows.

    ``curves`` are the weighted torques (m, T', n) of all options.
    """
    # All options at once, one column each.
    free = fold.free_part(np.moveaxis(curves, 0, 2))
    free = probe.view(free)[fold.train].reshape(-1, len(curves))
    residual = probe.view(fold.residual)[fold.train].ravel()
    size, inner = (free**2).sum(axis=0), free.T @ residual
    gains = np.where((size > 0) & (inner > 0), inner**2 / np.maximum(size, 1e-300), 0.0)
    return int(np.argmax(gains))


def placed(term: Term, option: dict[str, float]) -> Term:
    """The term with an option's values of its parameters."""
    return replace(term, values={p.name: option[p.name] for p in term.law.parameters})
