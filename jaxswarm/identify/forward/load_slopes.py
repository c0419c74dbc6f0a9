r"""What the torque owes to the linear parameters by way of the load that a law goes by.

The load :math:`L = W_j\pi` of a law :math:`f(L)` follows from the parameters :math:`\pi` that are fitted beside
it. With the load as a given number a fit goes from one load to the next; for a law as large as the load itself,
or a power of it, those steps lead astray: of :math:`a q^2 \tanh(L/s) L_0` the model that was told the true form
ended at 2.9 times the noise. The missing part of the derivative is

.. math:: \frac{\partial f}{\partial L} W_j + \frac{\partial f}{\partial L_0} W_{0j},

with the columns :math:`W_j` of the rigid torque and :math:`W_{0j}` of the same without acceleration. A drive
that distorts a torque goes by all that it is made of, a base that gives way by what it carries: for both the
same holds.
"""

from collections.abc import Sequence

import numpy as np

from jaxswarm.effects.distortion import distortion_slope
from jaxswarm.effects.kinds import BodyChange, MeasurementLaw, TorqueLaw
from jaxswarm.effects.term import Term, of_kind
from jaxswarm.identify.forward.body import Body, body_along
from jaxswarm.identify.forward.columns import Rigid, is_kept, term_columns
from jaxswarm.identify.forward.compliance import compliance_slopes
from jaxswarm.identify.forward.joint_series import Load
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.measuring_chain import distorted, reported_load
from jaxswarm.identify.forward.own_columns import placed
from jaxswarm.identify.forward.written_down import report
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot

# Step of the differences by the load, of its largest value; and samples whose columns are made at a time.
_STEP, _BLOCK = 1e-6, 16_384
# Rows of them that stay in the processor's cache, where two products are added up.
_ROWS = 512


def loaded(term: Term) -> bool:
    """Whether a term follows the load sample by sample, and whether its linear values are known yet."""
    law = term.law
    if isinstance(law, TorqueLaw):
        follows = law.uses_load and law.rate is None
    elif isinstance(law, BodyChange):
        follows = law.compliance is not None
    else:
        follows = distorted((term,))
    return follows and all(p.name in term.values for p in law.linear)


def load_slopes(
    robot: Robot,
    terms: tuple[Term, ...],
    motion: Motion,
    width: Sequence[float],
    pi: np.ndarray,
    rigid: Rigid | None = None,
    log: int | None = None,
) -> np.ndarray:
    """Derivative of the torque by the linear parameters that runs through loads, decimated, (T', n, p).

    Args:
        robot: Kinematics and nominal gravity.
        terms: With all values.
        motion: The log.
        width: Width of every joint's smooth sign, (n,).
        pi: Rigid parameters of the loads, (10 n,).
        rigid: Rigid columns of the plain motion in nominal gravity, where known.
        log: Number of the log; None: all terms act in it.
    """
    body = body_along(robot, terms, motion, pi, rigid)
    acting = [t for t in terms if loaded(t) and t.acts_in(log)]
    load = reported_load(terms, body, width, motion.joints)
    by = [(t, *_by_load(t, body.motion, width, load)) for t in acting if t.joint is not None]
    by = [_of_what_it_bends(one, by) for one in by]
    low, joints = motion.decimator, motion.q.shape[1]

    def seen(own: np.ndarray, joint: int) -> np.ndarray:
        # What the drives of an arm write down may mix its joints.
        if of_kind(terms, MeasurementLaw):
            return low.apply(report(terms, motion, placed(own, joint, joints)))
        return placed(low.apply(own), joint, joints)

    ends = len(pi) + np.cumsum([0, *(len(t.columns(robot.joints)) for t in terms)])
    total, row = np.zeros((len(low.kept(len(motion.t))), joints, ends[-1])), 0
    for part in low.blocks(len(motion.t), _BLOCK) if by else ():
        full, still = _columns(body, part)
        rows = slice(row, row + len(low.kept(len(full))))
        for t, by_full, by_still in by:
            first = 10 * t.index  # a joint feels no link before it
            loads = full[:, t.index, first:], still[:, t.index, first:]
            own = _by_columns((by_full[part], by_still[part]), loads)
            total[rows, :, first : len(pi)] += seen(own, t.index)
        row = rows.stop
    for t, start, end in zip(terms, ends[:-1], ends[1:], strict=True):
        if t.joint is None and t in acting:
            by_body, bends = compliance_slopes(t, body)
            total[:, :, : len(pi)] += low.apply(report(terms, motion, by_body))
            if bends is not None:
                total[:, :, start:end] += low.apply(report(terms, motion, bends))
    for t, slope in ((t, _bent(t, load)) for t in acting if distorted((t,))):
        for u, start, end in zip(terms, ends[:-1], ends[1:], strict=True):
            if isinstance(u.law, TorqueLaw) and u.joint == t.joint and u.acts_in(log):
                own = slope[:, None] * term_columns(u, body.motion, width, load)
                total[:, :, start:end] += seen(own, t.index)
    return total


def _by_columns(slopes: tuple[np.ndarray, ...], loads: tuple[np.ndarray, ...]) -> np.ndarray:
    """Slopes (T,) by loads times the loads' columns (T, k), summed, (T, k); some rows at a time."""
    found = np.zeros(loads[0].shape)
    told = [both for both in zip(slopes, loads, strict=True) if both[0].any()]
    for start in range(0, len(found), _ROWS):
        part = slice(start, start + _ROWS)
        for slope, columns in told:
            found[part] += slope[part, None] * columns[part]
    return found


def _of_what_it_bends(one: tuple, every: Sequence[tuple]) -> tuple:
    """A term with its slopes, those of a distortion by all that the loads of its joint do to the torque."""
    term, slope, still = one
    if not distorted((term,)):
        return one
    beside = [o for o in every if o[0].joint == term.joint and not distorted((o[0],))]
    return term, slope * (1.0 + sum(o[1] for o in beside)), slope * sum(o[2] for o in beside)


def _bent(term: Term, load: Load) -> np.ndarray:
    """Slope of what a drive writes down beside the torque of its joint by that torque, (T,)."""
    assert load.whole is not None  # it is known where a term distorts it
    whole = load.whole[:, term.index]
    return distortion_slope(term.law_of(MeasurementLaw), term.values, filled(whole))[: len(whole)]


def _by_load(
    term: Term, motion: Motion, width: Sequence[float], load: Load
) -> tuple[np.ndarray, np.ndarray]:
    """Slope of a law's torque by the load and by the static load, (T,) each."""
    if isinstance(term.law, MeasurementLaw):
        return _bent(term, load), np.zeros(len(load.full))
    values = np.array([term.values[p.name] for p in term.law.linear])

    def slope(name: str) -> np.ndarray:
        there = getattr(load, name)
        step = _STEP * float(np.abs(there[:, term.index]).max())
        if step == 0.0:
            return np.zeros(len(there))
        ahead, behind = (
            term_columns(term, motion, width, load._replace(**{name: there + way * step})) @ values
            for way in (1.0, -1.0)
        )
        return (ahead - behind) / (2.0 * step)

    return slope("full"), slope("static")


def _columns(body: Body, part: slice) -> tuple[np.ndarray, np.ndarray]:
    """Rigid columns of a stretch of a log, and the same without acceleration, (T, n, 10 n) each."""
    if body.rigid is not None and is_kept(body.motion):
        return body.rigid.full[part], body.rigid.still[part]
    q, dq, ddq = (x[part] for x in body.moved)
    rest = np.zeros_like(ddq)
    return rigid_columns(body.arm, q, dq, ddq), rigid_columns(body.arm, q, dq, rest)
