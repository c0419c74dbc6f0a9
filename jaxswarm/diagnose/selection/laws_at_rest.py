"""Laws that moments in which dry friction holds their joint tell alone.

A drive that winds up while its joint sticks goes through all torques of its friction, and the others move
meanwhile: on a cycle that repeats itself the two go along, and it sticks on the same side of the same places. A
clean slide that stuck was told as turned along by another one, which took 70 % off its squared error, 11 %
where it moved, and left 2.1 times the declared model's error on another log; a clean joint that stuck had an
asymmetric friction of 2.4 and 0.9 N m for 1.7, which took off 55 %, and 7 % where it moved.

What acts on a joint as much in motion as at rest shows in its motion, too, and what a partner does to a joint
knows nothing of its rest. That is not so of what fades with speed, as Stribeck's friction, nor of what
remembers where the joint turned.
"""

from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.decision.remainder import over_noise
from jaxswarm.diagnose.decision.rules import ACTS_MOVING, LOUD, SHOWS_MOVING
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.selection.refit import refit_once, share_left
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.diagnose.selection.sticking import (
    fit_of_rows,
    go_on_from,
    is_held,
    loud_joints,
    motion_alone,
)
from jaxswarm.diagnose.selection.without_steps import go_on_without, terms_without
from jaxswarm.effects.alike import has, without
from jaxswarm.effects.base import Effect
from jaxswarm.effects.kinds import TorqueLaw, TransmissionLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.standing import hardly_moving
from jaxswarm.identify.forward.model import model_torque


def leave_out_instead_of_laws(search: Search) -> bool:
    """Leave out where a joint hardly moves, and take back the law that explained that and nothing else.

    That is so where friction may be what holds it there, what moves is near its noise without that law, and
    the law takes a far smaller part off what moves than off all. Whether one was taken back; nothing is refused
    by that.
    """
    current = search.current
    rows = hardly_moving(current.motions)
    slow = np.concatenate(rows)
    asked = [step for step in search.steps if _is_asked(step, search, slow)]
    if not asked:
        return False

    def fitted(found: Estimate, joints: set[int]) -> Estimate:
        return fit_of_rows(search, found, motion_alone(current.motions, rows, joints))

    # What is loud in motion with the law is so without it: of seven laws on a measured arm of six joints none
    # was worth the two fits that tell.
    loud = {s.added.index for s in asked} & loud_joints(search)
    if loud:
        loud &= set(np.flatnonzero(over_noise(fitted(current, loud)) > LOUD))
    for step in (s for s in asked if s.added.index not in loud):
        joint = step.added.index
        terms = terms_without([step], current.model.terms)
        before = with_motion_noise(refit_once(current, terms), search.seed)
        after = fitted(before, {joint})
        if not is_held(before, after)[joint] or over_noise(after)[joint] > LOUD:
            continue
        beside = fitted(current, {joint})
        in_motion, of_all = (
            1.0 - share_left(*pair)[joint] for pair in ((beside, after), (current, before))
        )
        if in_motion < SHOWS_MOVING * of_all:
            search.sticking.add(joint)
            go_on_without(search, [step])
            go_on_from(search, after, {joint})
            return True
    return False


def _is_asked(step: Step, search: Search, slow: np.ndarray) -> bool:
    """Whether an addition acts in motion, too, and more is left where its joint hardly moves.

    Args:
        step: The addition.
        search: The selection.
        slow: Whether each joint hardly moves, on the rows of all logs, (T, n).
    """
    term, current = step.added, search.current
    if term.joint is None:
        return False
    joint, used = term.index, current.regression.used_rows[:, term.index]
    slow = slow[:, joint]
    known = term.joint in search.sticking or not has(term, current.model.terms)
    if known or term.law.mutual or _remembers(term.law) or not (used & slow).any():
        return False
    left, moves, rests = current.fit.residual[:, joint], used & ~slow, used & slow
    if _size(left, rests) <= _size(left, moves):
        return False
    own = _torque_of(term, current)
    acts = _size(own, moves) >= ACTS_MOVING * _size(own, rests)
    return acts or term.law.scope == "pair"


def _torque_of(term: Term, found: Estimate) -> np.ndarray:
    """Torque (T,) of a term of a model on its joint, on the rows of all logs."""
    plain = replace(found.model, terms=without(term, found.model.terms))
    return np.concatenate(
        [
            m.decimator.apply(model_torque(found.model, m) - model_torque(plain, m))[:, term.index]
            for m in found.motions
        ]
    )


def _remembers(law: Effect) -> bool:
    """Whether the torque of a law follows from where its joint turned: bristles, soft joints, play."""
    return isinstance(law, TransmissionLaw) or (isinstance(law, TorqueLaw) and law.rate is not None)


def _size(x: np.ndarray, rows: np.ndarray) -> float:
    """RMS of some rows; none have none."""
    return float(np.sqrt(np.mean(x[rows] ** 2))) if rows.any() else 0.0
