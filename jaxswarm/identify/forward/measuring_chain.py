r"""All columns of a model: what the rigid body really did, on which clock, on which scale.

The order in which a torque comes about fixes the order here: the links move behind their motors
(:class:`TransmissionLaw`) in a gravity (:class:`BodyChange`), motors and surroundings add their torques
(:class:`TorqueLaw`, :class:`ExternalTorque`), and the drives write them down (:class:`MeasurementLaw`).
"""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from jaxswarm.effects.kinds import BodyChange, MeasurementLaw, TorqueLaw
from jaxswarm.effects.term import Term, of_kind, valued
from jaxswarm.identify.forward.body import Body, body_along, body_basis, carried
from jaxswarm.identify.forward.columns import Rigid, early_columns, term_columns
from jaxswarm.identify.forward.compliance import compliance_columns
from jaxswarm.identify.forward.joint_series import Load
from jaxswarm.identify.forward.latest import last_of
from jaxswarm.identify.forward.link_lag import as_read
from jaxswarm.identify.forward.own_columns import own_columns, placed
from jaxswarm.identify.forward.written_down import in_order, mixed, on_joint, report, report_own
from jaxswarm.logs.filtering import Decimator
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot


def uses_load(terms: tuple[Term, ...]) -> bool:
    """Whether a term's columns depend on the rigid torque."""
    return any(t.law.uses_load for t in terms)


def assemble(
    robot: Robot,
    terms: tuple[Term, ...],
    motion: Motion,
    width: Sequence[float],
    pi: np.ndarray,
    rigid: Rigid | None = None,
    decimate: bool = False,
    log: int | None = None,
) -> np.ndarray:
    """Columns of a log for given nonlinear and rigid parameters, shape (T, n, p).

    Args:
        robot: Kinematics and nominal gravity.
        terms: With values of their nonlinear parameters.
        motion: The log.
        width: Width of the smooth sign.
        pi: Rigid parameters (10 n,) that load-dependent terms and transmissions go by.
        rigid: Rigid columns of the plain motion in nominal gravity, where known.
        decimate: Whether to return the columns through the decimator, (T', n, p).
        log: Number of the log: columns of what happened in another one are zero; None: all happened here.

    Returns:
        Standard parameters first, then the linear parameters of the terms in their order.
    """
    low = motion.decimator.apply if decimate else np.asarray
    body = body_along(robot, terms, motion, pi, rigid)
    whole = _low(terms, body) if decimate else report(terms, motion, body.columns)
    if motion.weight_skew:
        whole = whole + _early(robot, motion, rigid, decimate)
    return np.concatenate([whole, *_blocks(terms, body, width, low, log)], axis=2)


def _low(terms: tuple[Term, ...], body: Body) -> np.ndarray:
    """Rigid columns as reported, through the decimator, (T', n, 10 n)."""
    if not of_kind(terms, MeasurementLaw):
        return body.low

    def make() -> np.ndarray:
        return body.motion.decimator.apply(report(terms, body.motion, body.columns))

    if body.rigid is None:
        return make()
    # A fit moves the width of a sign more often than a filter.
    return last_of(body.rigid.reported, valued(in_order(terms)), make)


def _early(robot: Robot, motion: Motion, rigid: Rigid | None, decimate: bool) -> np.ndarray:
    """What the clock of the weight adds to rigid columns, as drives report it whatever else they do."""
    if rigid is not None and decimate:
        return rigid.early
    return early_columns(robot, motion, motion.decimator if decimate else Decimator(np.ones(1), 1))


def _blocks(
    terms: tuple[Term, ...],
    body: Body,
    width: Sequence[float],
    low: Callable[[np.ndarray], np.ndarray],
    log: int | None,
) -> Iterator[np.ndarray]:
    """Columns (T', n, k) of all terms that have some, as reported, through ``low``; see :func:`assemble`."""
    joints = body.motion.joints
    load = reported_load(terms, body, width, joints) if uses_load(terms) else None
    for term in terms:
        if term.columns(joints):
            block = _block(terms, term, body, width, load, low)
            yield block if term.acts_in(log) else np.zeros_like(block)


def low_torque_along(
    robot: Robot,
    terms: tuple[Term, ...],
    motion: Motion,
    width: Sequence[float],
    pi: np.ndarray,
    theta: np.ndarray,
    rigid: Rigid | None = None,
    log: int | None = None,
) -> np.ndarray:
    """Decimated torque (T', n) of a model: ``assemble(..., decimate=True) @ theta``.

    Columns of links that lag serve one place alone, and take most of its time: none is made here.

    Args:
        robot, terms, motion, width, pi, rigid, log: As for :func:`assemble`.
        theta: Linear parameters, the rigid ones first, (p,).
    """
    k, low = len(pi), motion.decimator.apply
    body = body_along(robot, terms, motion, pi, rigid)
    if body.rigid is not None and not of_kind(terms, MeasurementLaw):
        whole = body.low @ theta[:k]
    else:
        whole = low(report(terms, motion, body.torque(theta[:k])))
    if motion.weight_skew:
        whole = whole + _early(robot, motion, rigid, True) @ theta[:k]
    for block in _blocks(terms, body, width, low, log):
        whole += block @ theta[k : k + block.shape[2]]
        k += block.shape[2]
    return whole


def reported_load(
    terms: tuple[Term, ...], body: Body, width: Sequence[float], joints: tuple[str, ...]
) -> Load:
    """The load along a log, with the torque that drives report where a term distorts it.

    Where none does, that of joints whose laws go by it alone.
    """
    if not distorted(terms):
        return body.load({t.index for t in terms if t.law.uses_load and t.joint is not None})
    load = body.load()
    values = [np.array([t.values.get(n, 0.0) for n in t.linear_names(joints)]) for t in terms]
    return load._replace(whole=true_torque(terms, values, body, width, load))


def distorted(terms: tuple[Term, ...]) -> bool:
    """Whether drives write down something that follows from the true torque, and is not linear in it."""
    return any(map(distorts, terms))


def distorts(term: Term) -> bool:
    """Whether a term is such a drive."""
    return isinstance(term.law, MeasurementLaw) and term.law.distortion is not None


def true_torque(
    terms: tuple[Term, ...],
    values: Sequence[np.ndarray],
    body: Body,
    width: Sequence[float],
    load: Load | None,
) -> np.ndarray:
    """Torque (T, n) that drives report: of the rigid body and of all terms but those that distort it.

    Args:
        terms: The model's.
        values: Of each term's linear parameters, (k,).
        body: The rigid body.
        width: Width of the smooth sign.
        load: Its load torque, where a term asks for it.
    """
    whole = body.torque(body.pi) if load is None else load.full.copy()
    for term, own in zip(terms, values, strict=True):
        if not len(own) or distorts(term):
            continue
        if isinstance(term.law, TorqueLaw):
            whole[:, term.joint] += term_columns(term, body.motion, width, load) @ own
        elif isinstance(term.law, BodyChange) and term.law.window:
            # The torque of a body, so that the columns of a long log need not stand in memory.
            pi = np.zeros(len(body.pi))
            pi[-10:] = body_basis(term.law) @ own
            whole += carried(term, body.motion)[:, None] * body.torque(pi)
        else:
            # How far a base turns decides how it swings.
            told = term.with_linear(own, body.motion.joints)
            whole += _supplied(told, body, width, load) @ own
    return whole


def _block(
    terms: tuple[Term, ...],
    term: Term,
    body: Body,
    width: Sequence[float],
    load: Load | None,
    low: Callable[[np.ndarray], np.ndarray],
) -> np.ndarray:
    """Columns of a term of a model as reported, through ``low``: (T', n, k)."""
    motion = body.motion
    if mixed(terms) or not isinstance(term.law, TorqueLaw):
        return low(report(terms, motion, _supplied(term, body, width, load)))

    def own() -> np.ndarray:
        return low(report_own(terms, motion, term_columns(term, motion, width, load), term.index))

    if low is np.asarray or body.laws is None:
        made = own()
    else:
        made = body.laws.law(term, width, own, valued(on_joint(terms, term.index)))
    return placed(made, term.index, motion.q.shape[1])


def _supplied(term: Term, body: Body, width: Sequence[float], load: Load | None) -> np.ndarray:
    """Columns (T, n, k) of a term on the working clock, with those that follow from the rigid body."""
    law = term.law
    if isinstance(law, BodyChange) and law.compliance is not None:
        return compliance_columns(term, body)
    if isinstance(law, BodyChange) and law.window:
        return carried(term, body.motion)[:, None, None] * (body.last @ body_basis(law))
    return own_columns(term, body.motion, width, load)


def term_block(
    robot: Robot,
    terms: tuple[Term, ...],
    term: Term,
    motion: Motion,
    width: Sequence[float],
    pi: np.ndarray,
    rigid: Rigid,
) -> np.ndarray:
    """Decimated columns of one term of a model, (T', n, k); links are taken as stiff for its load."""
    true, known = as_read(terms, motion, rigid)
    body = Body(robot, (true.q, true.dq, true.ddq), true, pi, known, known)
    load = body.load({term.index}) if term.law.uses_load else None
    return _block(terms, term, body, width, load, motion.decimator.apply)
