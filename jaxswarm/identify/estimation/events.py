"""Torques of events in a log, such as contacts, from what the model leaves while they last, and their times."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.covariance import correlation_length
from jaxswarm.identify.estimation.least_squares import Fit
from jaxswarm.identify.forward.columns import Rigid
from jaxswarm.identify.forward.measuring_chain import assemble
from jaxswarm.identify.forward.model import Model, linear_values
from jaxswarm.identify.forward.own_columns import own_columns
from jaxswarm.identify.forward.regression import Regression
from jaxswarm.identify.forward.written_down import report
from jaxswarm.logs.motion import Motion

# Rows, over S, within which 95 % of estimated places of a step are; and the same of a normal distribution.
_WITHIN, _NORMAL = 11.0, 1.96


def with_event_torques(
    model: Model,
    solution: Fit,
    regression: Regression,
    motions: Sequence[Motion],
    rigids: Sequence[Rigid],
    errors: list[dict[str, float]],
) -> tuple[Model, list[dict[str, float]]]:
    """The model with the torque of every event on every joint, and the standard errors of its terms.

    An event's samples were left out of the fit, so that its torque is the mean of what the fit leaves
    there, through the same low-pass; it is as uncertain as that, as the model, and as begin and end.
    """
    names, terms, told = regression.names, [], []
    covariance = np.zeros((len(names), len(names)))
    covariance[np.ix_(solution.base.kept, solution.base.kept)] = solution.covariance
    memory = correlation_length(solution.residual / solution.sigma, regression.log)
    for term, own in zip(model.terms, errors, strict=True):
        if term.law.recurring:
            number = int(term.values.get("log", 0))
            motion = motions[number]
            # What else acts in that log, a body carried for a while with it, but no event.
            here = model.during(number)
            here = replace(here, terms=tuple(t for t in here.terms if not t.law.recurring))
            columns = assemble(
                model.robot,
                here.terms,
                motion,
                model.width,
                np.asarray(model.robot.parameters).ravel(),
                rigids[number],
                decimate=True,
            )
            left = motion.low_torque - columns @ linear_values(here)
            pushes = report(here.terms, motion, own_columns(term, motion, model.width, None))
            window = np.einsum("tjj->tj", motion.decimator.apply(pushes))
            held = _columns_of(model, here.terms)
            doubt = covariance[np.ix_(held, held)]
            values, spread = _mean(window, left, columns, doubt, solution.sigma, memory)
            joints = term.linear_names(model.robot.joints)
            term = replace(term, values={**term.values, **dict(zip(joints, values, strict=True))})
            edge, relative = edges(term, values, solution.sigma, memory, regression.step[number])
            spread = np.hypot(spread, relative * np.asarray(values)).tolist()
            own = {**own, "start": edge, "end": edge, **dict(zip(joints, spread, strict=True))}
        terms.append(term)
        told.append(own)
    return replace(model, terms=tuple(terms)), told


def edges(
    term: Term, torque: Sequence[float], sigma: np.ndarray, memory: float, step: float
) -> tuple[float, float]:
    """Standard error [s] of an event's begin and end, and what it does to its torque, as a part of that.

    Begin and end lie anywhere within a step besides; a window too short holds too large a torque.

    Args:
        term: The event, with its begin and end.
        torque, sigma, memory: As for :func:`edge_error`.
        step: Time [s] from row to row.
    """
    within = step / np.sqrt(12.0)
    length = max(term.values["end"] - term.values["start"], step)
    found = edge_error(np.asarray(torque), sigma, memory) * step
    return float(np.hypot(within, found)), float(np.sqrt(2.0) * within / length)


def edge_error(torque: np.ndarray, sigma: np.ndarray, memory: float) -> float:
    r"""Standard error, in rows, of where a step of torque begins or ends that was found by least squares.

    A misplaced row costs :math:`S = \sum_j (\tau_j / \sigma_j)^2` over the residual's memory, and the place is
    within 11 / S rows in 95 % of cases (J. Bai, Rev. Economics and Statistics 79 (1997), section III).

    Args:
        torque: The step on every joint, (n,) [N m or N].
        sigma: Standard deviation of the residual, (n,).
        memory: Rows that one independent residual counts for.

    >>> round(edge_error(np.array([2.0]), np.array([1.0]), 1.0), 2)
    1.4
    """
    return float(_WITHIN * memory / max(((torque / sigma) ** 2).sum(), 1e-12) / _NORMAL)


def window_errors(
    term: Term,
    model: Model,
    solution: Fit,
    regression: Regression,
    motions: Sequence[Motion],
    rigids: Sequence[Rigid],
) -> dict[str, float]:
    """Standard errors [s] of a body's pick-up and put-down, as :func:`edge_error`; none for other laws.

    That torque goes by the motion: a misplaced begin costs what the body would need on the rows between. The
    slope of the fit holds within the few hundredths of a second that a pick-up takes, and tells of no further
    ones: one of three times the noise was 23 ms off, where the slope told 21 at 95 %.

    Args:
        term: One of the model, with its values.
        model, solution, regression: The fit.
        motions, rigids: The logs.
    """
    if not (isinstance(term.law, BodyChange) and term.law.window):
        return {}
    number = int(term.values.get("log", 0))
    bounds = {p.name: (p.lower, p.upper) for p in term.law.nonlinear}
    always = {"start": bounds["start"][0], "end": bounds["end"][1]}
    columns = assemble(
        model.robot,
        (replace(term, values={**term.values, **always}),),
        motions[number],
        model.width,
        np.asarray(model.robot.parameters).ravel(),
        rigids[number],
        decimate=True,
    )
    names = term.linear_names(model.robot.joints)
    torque = columns[:, :, -len(names) :] @ [term.values[n] for n in names]
    cost = ((torque / solution.sigma) ** 2).sum(axis=1)
    memory = correlation_length(solution.residual / solution.sigma, regression.log)
    t, step = regression.t[regression.log == number], regression.step[number]
    errors: dict[str, float] = {}
    for edge in ("start", "end"):
        place = int(np.searchsorted(t, term.values[edge]))
        if 0 < place < len(t):
            sides = cost[:place][::-1], cost[place:]
            rows = sum(_reach(x, _WITHIN * memory) for x in sides) / 2.0
            errors[edge] = step / _NORMAL * rows
    return errors


def _reach(cost: np.ndarray, enough: float) -> float:
    """Rows after which their costs (T,), the first row's first, come to so much; all of them if they do not.

    >>> _reach(np.array([2.0, 2.0, 4.0]), 6.0), _reach(np.array([2.0, 2.0]), 6.0)
    (2.5, 2.0)
    """
    return float(np.interp(enough, np.append(0.0, np.cumsum(cost)), np.arange(len(cost) + 1.0)))


def _columns_of(model: Model, held: Sequence[Term]) -> np.ndarray:
    """Numbers of the columns of the rigid body and of some of a model's terms, in the model's order."""
    joints = model.robot.joints
    flags = [np.full(10 * model.robot.num_joints, True)]
    flags += [np.full(len(t.columns(joints)), any(t is h for h in held)) for t in model.terms]
    return np.flatnonzero(np.concatenate(flags))


def _mean(window, left, columns, doubt, sigma, memory) -> tuple[list[float], list[float]]:
    """Torque per joint of its window (T', n) from what is left (T', n), and standard errors."""
    power = np.maximum((window**2).sum(axis=0), 1e-300)
    values = (window * left).sum(axis=0) / power
    carried = np.einsum("tj,tjp->jp", window, columns) / power[:, None]
    model = np.einsum("jp,pr,jr->j", carried, doubt, carried)
    own = sigma**2 * memory / power
    return [float(x) for x in values], [float(x) for x in np.sqrt(own + np.maximum(model, 0.0))]
