"""Where the fit of a drive that distorts its torque begins: from the torque that was measured.

A dead band goes by the sign of the true torque, a bent sensor by its powers, and the true torque by all that is
fitted beside them. The derivative of a sign is nothing, so that no step leads from one crossing of zero to
another: a fit from a model that lacked a dead band of 2.4 N m ended at 0.15 N m and 7.5 times the noise. Of the
measured torque the crossings are known. They tell where to begin; what is fitted goes by the model's torque.
"""

from dataclasses import replace

import numpy as np

from jaxswarm.effects.distortion import distortion_columns
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.free_parameters import Place
from jaxswarm.identify.estimation.problem import Problem
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.identify.forward.measuring_chain import distorts
from jaxswarm.identify.forward.written_down import report_own
from jaxswarm.logs.motion import Motion


def measured_start(problem: Problem, place: Place, pi: np.ndarray) -> np.ndarray | None:
    """Linear parameters (p,) with the columns of distortions by the measured torque.

    None where nothing is distorted.

    Args:
        problem: Robot and logs, with torque.
        place: Terms and widths.
        pi: Rigid parameters of all other loads, (10 n,).
    """
    if not any(map(distorts, place.terms)):
        return None
    # Without their values nothing is bent yet, and columns are no slopes.
    bare = tuple(map(_without_values, place.terms))
    rows = problem.build(Place(bare, place.width), pi)
    k = 10 * problem.robot.num_joints
    for term in place.terms:
        size = len(term.columns(problem.robot.joints))
        if distorts(term):
            own = [_by_measured(place.terms, term, motion) for motion in problem.motions]
            share = rows.shares[:, term.index, None]
            rows.columns[:, term.index, k : k + size] = share * np.concatenate(own)
        k += size
    return problem.solve(place.terms, rows).theta


def _without_values(term: Term) -> Term:
    if not distorts(term):
        return term
    linear = {p.name for p in term.law.linear}
    return replace(term, values={n: v for n, v in term.values.items() if n not in linear})


def _by_measured(terms: tuple[Term, ...], term: Term, motion: Motion) -> np.ndarray:
    """Decimated columns (T', k) of a distortion by the torque that was measured."""
    assert motion.tau is not None  # what is fitted has a torque
    torque = motion.tau[:, term.index]
    own = distortion_columns(term.law_of(MeasurementLaw), term.values, filled(torque))[
        : len(torque)
    ]
    return motion.decimator.apply(report_own(terms, motion, own, term.index))
