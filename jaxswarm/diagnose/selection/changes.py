r"""The loop against a model identified before: what changed since.

The earlier model is not refitted; it absorbs nothing. What is left, :math:`\tau - \hat\tau`, is put to
every suspect, among them now a payload and a change of what the model already holds, which may have
either sign. The changes found are fitted together, the earlier parameters held; their standard errors
respect autocorrelation as everywhere.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.eligible import list_suspects
from jaxswarm.diagnose.candidates.journal import Journal
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.decision.competing import choose
from jaxswarm.diagnose.decision.evaluate import judge
from jaxswarm.diagnose.decision.score import Rules, Score, passes
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.diagnose.selection.changed_model import apply_change
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify.estimation.base_parameters import find_base
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.least_squares import Fit, fit
from jaxswarm.identify.estimation.validate import time_blocks
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.model import Model, linear_values, smooth_torque
from jaxswarm.identify.forward.regression import Regression, build_regression
from jaxswarm.logs.motion import Motion

_MOST_STEPS = 6


@dataclass(frozen=True)
class Change:
    """One thing that changed since the model was identified.

    Attributes:
        term: Effect and joint; its values are the change.
        std_errors: Of the values; NaN where a value cannot be told from others.
        known: Whether the model held the effect already, so that the values are differences.
        score: What it was worth when it was found.
        others: Runners-up.
    """

    term: Term
    std_errors: dict[str, float]
    known: bool
    score: Score
    others: tuple[Score, ...]


@dataclass(frozen=True)
class Comparison:
    """Outcome of a comparison with an earlier model.

    Attributes:
        before, after: The earlier model on the logs, and with the changes.
        changes: In the order they were found.
        stages: The estimates after each change.
        unseen: After each change, the residual (T, n) of every second block of time with the changes
            fitted to the others.
        last: Scores of the final round.
        background: Folds of the final round.
        asked: Suspects asked in the first round.
    """

    before: Estimate
    after: Estimate
    changes: tuple[Change, ...]
    stages: tuple[Estimate, ...]
    unseen: tuple[np.ndarray, ...]
    last: tuple[Score, ...]
    background: CrossFit
    asked: int


def freeze(model: Model, motions: Sequence[Motion]) -> Estimate:
    """An earlier model on new logs, as an estimate in which nothing was fitted."""
    rigids = tuple(rigid_of(model.robot, m) for m in motions)
    pi = np.asarray(model.robot.parameters).ravel()
    terms = tuple(t for t in model.terms if not t.law.reference_only)
    model = replace(model, terms=terms)
    regression = build_regression(model.robot, terms, motions, model.width, pi, rigids)
    theta = linear_values(model)
    smooth = [m.decimator.apply(smooth_torque(model, m)) for m in motions]
    regression = replace(regression, torque=regression.torque - np.concatenate(smooth))
    residual = regression.target - regression.columns @ theta
    sigma = np.sqrt((residual**2).mean(axis=0)) + 1e-12
    flat = regression.columns.reshape(-1, regression.columns.shape[2])
    base = find_base(flat, regression.names)
    size = base.size
    frozen = Fit(
        base, base.reduce(theta), np.zeros((size, size)), sigma, np.eye(size), np.zeros(size), 0.0,
        residual, np.zeros(size, bool), float(len(residual)),
    )  # fmt: skip
    errors = tuple({p.name: 0.0 for p in t.law.parameters} for t in terms)
    return Estimate(model, frozen, regression, tuple(motions), rigids, errors)


def compare(
    model: Model,
    motions: Sequence[Motion],
    *,
    rules: Rules | None = None,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    journal: Journal | None = None,
) -> Comparison:
    """Find what changed since a model was identified.

    Args:
        model: The earlier model.
        motions: New logs of the same robot, with torque.
        rules: Thresholds of the decision.
        seed: Seed of the searches.
        progress: Called with one line per stage.
        journal: Keeps the searches on disk, so that an interrupted comparison can go on.
    """
    rules = rules or Rules()
    if any(m.tau is None for m in motions):
        raise InputError("the log has no torque to compare the model with; add tau_<joint>")
    before = current = freeze(model, motions)
    held = {t.place for t in model.terms}
    picked: list[tuple[Candidate, Score, tuple[Score, ...]]] = []
    stages: list[Estimate] = []
    unseen: list[np.ndarray] = []
    changes: tuple[Change, ...] = ()
    asked, memory = 0, Memory(journal, rules.share)
    for number in range(_MOST_STEPS + 1):
        progress(f"round {number + 1}: asking what changed")
        background = cross_fit(current, frozen=True)
        scores = _ask(current, background, held, seed, {c.term for c, _, _ in picked}, memory)
        asked = asked or len(scores)
        guilty = [s for s in scores if passes(s, len(scores), rules)]
        most = max((s.gain for s in scores), default=0.0)
        guilty = [s for s in guilty if s.candidate.term.law.lasting or s.gain >= most]
        if not guilty or number == _MOST_STEPS:
            break
        chosen, _ = choose(guilty, rules, background)
        others = tuple(s for s in sorted(scores, key=lambda s: -s.gain) if s is not chosen)[:6]
        raw = replace(
            chosen.candidate,
            columns=(chosen.candidate.columns[0] / background.weight[:, :, None],) * 3,
        )
        picked.append((raw, chosen, others))
        current, changes = _apply(before, picked, held)
        stages.append(current)
        unseen.append(_crossed(before, picked))
    return Comparison(
        before, current, changes, tuple(stages), tuple(unseen), tuple(scores), background, asked
    )


def _ask(found: Estimate, background: CrossFit, held, seed: int, done, memory) -> list[Score]:
    suspects = [t for t in list_suspects(found.model, found.motions, True) if t not in done]
    return judge(
        Linearization(found, background, memory),
        suspects,
        seed,
        signed=lambda term: term.place in held,
    )


def _rows(before: Estimate, picked) -> Regression:
    """What the earlier model leaves as a regression on the columns of the changes."""
    regression = before.regression
    columns = np.concatenate([c.columns[0] for c, _, _ in picked], axis=2)
    names = tuple(f"{k}" for k in range(columns.shape[2]))
    return replace(regression, names=names, columns=columns, torque=before.fit.residual, shift=None)


def _crossed(before: Estimate, picked) -> np.ndarray:
    """Residual of each half of the blocks with the changes fitted to the other half."""
    rows = _rows(before, picked)
    odd = time_blocks(rows.log, 20) % 2 == 1
    residual = np.empty_like(rows.torque)
    for part in (odd, ~odd):
        theta = fit(rows.rows(~part)).theta
        residual[part] = rows.torque[part] - rows.columns[part] @ theta
    return residual


def _apply(before: Estimate, picked, held) -> tuple[Estimate, tuple[Change, ...]]:
    """Fit all changes together on what the earlier model leaves, and put them into the model."""
    rows = _rows(before, picked)
    names = rows.names
    solution = fit(rows)
    values = solution.theta
    errors = np.full(len(names), np.nan)
    errors[solution.base.kept] = solution.std_error
    changes, k = [], 0
    model = before.model
    for candidate, worth, others in picked:
        size = candidate.columns[0].shape[2]
        own, doubt = values[k : k + size], errors[k : k + size]
        k += size
        term = candidate.term
        table, spread = _values(term, own, doubt, model.robot.joints)
        further = candidate.columns[0][:, :, len(spread) :] @ own[len(spread) :]
        term = replace(term, values=table)
        known = term.place in held
        changes.append(Change(term, spread, known, worth, others))
        model = apply_change(term.law, model, term, before.motions, further)
    return freeze(model, before.motions), tuple(changes)


def _values(term: Term, own, doubt, joints) -> tuple[dict, dict]:
    """Values and standard errors by name from the coefficients of a term's columns."""
    law, neutral = term.law, term.law.neutral()
    names = law.candidate_names(joints)
    start = {} if isinstance(law, TorqueLaw) else neutral
    values = {n: float(start.get(n, 0.0) + x) for n, x in zip(names, own, strict=False)}
    return {**term.values, **values}, {n: float(x) for n, x in zip(names, doubt, strict=False)}
