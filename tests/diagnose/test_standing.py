"""Joints that dry friction holds at rest: at torques that no law tells, which nothing is fitted to."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from planted import BAND, NOISE, RATE, blank, log_with, small_arm

from jaxswarm.diagnose import diagnose
from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.decision.evaluate import score_on
from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.unexplained import Unexplained
from jaxswarm.diagnose.folds.noise import event_doubt, noise_of, with_motion_noise
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.selection import stepwise
from jaxswarm.diagnose.selection import with_rest as with_rest_module
from jaxswarm.diagnose.selection.budget import Budget
from jaxswarm.diagnose.selection.changes import compare
from jaxswarm.diagnose.selection.elsewhere import event_windows, residuals_on
from jaxswarm.diagnose.selection.pair import _predicts_better
from jaxswarm.diagnose.selection.refit import refit
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.sticking import _may_be_friction, is_held
from jaxswarm.diagnose.selection.tenable import can_be_resolved, is_itself
from jaxswarm.diagnose.selection.with_rest import with_rest
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate, model_torque
from jaxswarm.identify.estimation import held_rest, rest_foretold
from jaxswarm.identify.estimation.gauss_newton import newton
from jaxswarm.identify.estimation.standing import (
    hardly_moving,
    held_lines,
    held_shares,
    leave_out,
    mixed_with,
    standing,
)
from jaxswarm.identify.estimation.standing import held as held_at_rest
from jaxswarm.identify.forward.metrics import moves_at
from jaxswarm.identify.report.console import rest_lines
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import prepare
from jaxswarm.logs.runs import runs

# Time [s] of a move, and of the rest after it.
MOVE, REST, MOVES = 0.9, 0.6, 12
# Dry friction of the planted arm [N m].
FRICTION = np.array([3.0, 1.5])


@cache
def truth():
    """A model of the arm with its declared friction."""
    return estimate(small_arm(), blank(), [prepare(log_with(), BAND)]).model


def stopping(level: float, seed: int = 0, *hidden: Term, creep: float = 0.0) -> Log:
    """A log of moves with rests, in each of which either joint is held up to a torque off the model's [N m].

    ``creep``: how fast the joints still go then, one way and then the other, over the width of their sign.
    """
    model = replace(truth(), terms=(*truth().terms, *hidden))
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, MOVES * (MOVE + REST), 1.0 / RATE)
    number, phase = np.divmod(t, MOVE + REST)
    s = np.clip(phase / MOVE, 0.0, 1.0)[:, None]
    points = rng.uniform(-1.2, 1.2, (MOVES + 1, 2))
    begin, end = points[number.astype(int)], points[number.astype(int) + 1]
    q = begin + (end - begin) * (10 * s**3 - 15 * s**4 + 6 * s**5)
    way = np.maximum(phase - MOVE, 0.0) - 2.0 * np.maximum(phase - MOVE - 0.5 * REST, 0.0)
    q = q + creep * np.asarray(truth().width) * way[:, None]
    bare = Log(f"stops {seed}", small_arm().joints, t, q, tau=np.zeros_like(q), channels={})
    motion = prepare(bare, BAND)
    tau = np.stack([np.interp(t, motion.t, x) for x in model_torque(model, motion).T], axis=1)
    off = rng.uniform(-level, level, (MOVES, 2))[number.astype(int)]
    tau = tau + np.where(phase[:, None] > MOVE, off, 0.0)
    return replace(bare, tau=tau + NOISE.torque * rng.normal(size=tau.shape))


def sticking(seed: int = 0, level: float = 2.0, *hidden: Term) -> Log:
    """A log whose joints, where they hardly move, are held within so many times their friction."""
    log = log_with(*hidden, seed=seed + 1)
    rng = np.random.default_rng(seed)
    motion = prepare(log, BAND)
    held = np.zeros_like(motion.dq)
    for j, flags in enumerate(moves_at(motion.dq, np.abs(motion.dq).max(axis=0)).T):
        for begin, end in zip(*runs(~flags), strict=True):
            sign = np.tanh(motion.dq[begin:end, j] / truth().width[j])
            held[begin:end, j] = FRICTION[j] * (level * rng.uniform(-1.0, 1.0) - sign)
    held = np.stack([np.interp(log.t, motion.t, x) for x in held.T], axis=1)
    return replace(log, tau=log.tau + held)


def fitted(log: Log, held: bool = True):
    motion = prepare(log, BAND)
    motion = motion if held else leave_out([motion], standing([motion]), np.zeros(2, bool))[0]
    return estimate(small_arm(), blank(), [motion])


def test_rest_is_left_out_where_friction_holds_it_at_any_torque():
    found = fitted(stopping(2.5))
    rest = standing(found.motions)[0]
    assert 0.3 < rest.mean() < 0.5
    assert not found.regression.used_rows[rest].any()
    assert found.regression.used_rows[~rest].mean() > 0.7
    shares = held_shares(found.motions)
    assert set(shares) == {"joint1", "joint2"}
    (line,) = held_lines(shares)
    assert "joint2" in line
    # What is left is the noise's: with rest fitted it is several times as much.
    assert (found.fit.sigma < 0.4 * fitted(stopping(2.5), held=False).fit.sigma).all()


@pytest.mark.parametrize(
    ("levels", "told"),
    [((9.0, 1.0), True), ((9.0, 0.2, 0.2), False)],
    ids=["friction", "a push in one rest of three"],
)
def test_a_short_rest_counts_as_much_as_a_long_one(levels, told):
    """A joint held at 960 N m before its first move was held for longer at 20 N m after its last one."""
    motion = np.tile([1.0, -1.0], 50)
    parts = [np.concatenate([np.full(20 + 40 * k, x), motion]) for k, x in enumerate(levels)]
    left = np.concatenate(parts)[:, None]
    rest = np.abs(left) != 1.0
    rest[120:180] = True  # the second rest, whatever its level
    assert held_at_rest(left, [rest], [rest]).tolist() == [told]


def test_what_friction_holds_does_not_move_the_parameters():
    true = {t.identity: t.values for t in truth().terms}
    worst = {}
    for held in (True, False):
        terms = fitted(stopping(2.5), held).model.terms
        worst[held] = max(
            abs(t.values[p.name] / true[t.identity][p.name] - 1.0)
            for t in terms
            for p in t.law.linear
        )
    assert worst[True] < 0.3 * worst[False]


@pytest.mark.parametrize("seed", range(3))
def test_rest_that_the_model_tells_is_fitted(seed):
    found = fitted(stopping(0.0, seed))
    assert held_shares(found.motions) == {}
    assert found.regression.share is None


def test_rest_that_another_width_of_the_sign_tells_is_fitted():
    """Beside laws that other joints lacked a width a tenth too sharp left a joint's rest to friction."""
    log = stopping(0.0, creep=0.6)
    wide = tuple(2.0 * w for w in truth().width)
    found = estimate(small_arm(), blank(), [prepare(log, BAND)], width=wide, refine_width=True)
    assert held_shares(found.motions) == {}
    np.testing.assert_allclose(found.model.width, truth().width, rtol=0.2)


@pytest.mark.parametrize(("paid", "out"), [(1.0, [False, False]), (2.0, [True, True])])
def test_rest_that_bends_what_tells_motion_is_left_to_friction(monkeypatch, paid, out):
    """A model bent to the rest of joints that moved one by one left 29 times the noise on another log."""
    log = stopping(0.0, creep=0.6)
    wide = tuple(2.0 * w for w in truth().width)

    def told(problem, moving, here):
        found = newton(problem, moving, here)
        resting = np.concatenate(mixed_with(problem.motions, standing(problem.motions)))
        return replace(found, residual=np.where(resting, 1.0, paid) * found.residual)

    monkeypatch.setattr(held_rest, "newton", told)
    found = estimate(small_arm(), blank(), [prepare(log, BAND)], width=wide, refine_width=True)
    assert found.motions[0].held.any(axis=0).tolist() == out


@pytest.mark.parametrize(("there", "told"), [(0.02, True), (2.0, False)])
def test_rest_that_motion_does_not_foretell_is_not_judged_by_it(there, told):
    """Without it a model of five joints, each of which moved a few times alone, was off a thousandfold."""
    rng = np.random.default_rng(0)
    resting = np.arange(200)[:, None] % 4 == 0
    second = np.where(resting, there, 0.02 * rng.normal(size=(200, 1)))
    columns = np.stack([np.ones_like(second), second], axis=2)
    assert rest_foretold.is_foretold(columns, rng.normal(size=(200, 1)), resting).tolist() == [told]


@pytest.mark.parametrize(("rows", "told"), [(40, False), (60, True)])
def test_little_motion_of_a_long_log_tells_what_rest_is_held_against(rows, told):
    """Of seven joints that move one by one each does so for less than a tenth of the time."""
    left = np.full((1000, 1), 9.0)
    left[:rows] = np.resize([1.0, -1.0], (rows, 1))
    rest = np.abs(left) > 1.0
    assert held_at_rest(left, [rest], [rest]).tolist() == [told]


@pytest.mark.parametrize("declared", [(), (Term("coulomb_friction", 1),)])
def test_a_joint_without_declared_friction_is_held_without_a_width_to_ask(monkeypatch, declared):
    """A clean log of six joints of which no friction was declared ended in a traceback."""
    monkeypatch.setattr(held_rest, "held", lambda left, rest, mixed: np.ones(2, bool))
    found = estimate(small_arm(), declared, [prepare(stopping(2.0), BAND)], bounded=False)
    assert found.motions[0].held.any(axis=0).all()


def test_nothing_is_added_for_what_friction_holds():
    found = diagnose(small_arm(), blank(), [prepare(stopping(2.5), BAND)])
    assert not found.kept


@pytest.mark.parametrize("level", [0.0, 3.0], ids=["by its law", "by friction"])
def test_rest_that_a_missing_law_tells_is_fitted_once_it_is_found(monkeypatch, level):
    """A wrong reading of one joint was told as two others, as rest had been taken for friction's at first."""
    hidden = Term("joint_spring", 1, values={"k": 8.0, "tau0": 2.0})
    monkeypatch.setattr(held_rest, "held", lambda left, rest, mixed: np.ones(2, bool))
    motions = [prepare(stopping(level, 0, hidden), BAND)]
    found = diagnose(small_arm(), blank(), motions)
    assert [(s.added.effect, s.added.joint) for s in found.kept] == [("joint_spring", 1)]
    rest = standing(motions)[0]
    assert found.final.regression.used_rows[rest].any() == (level == 0.0)
    assert bool(held_shares(found.final.motions)) == (level > 0.0)


@pytest.mark.parametrize("near", [True, False])
def test_rest_may_be_all_that_was_missing(monkeypatch, near):
    """A slide that creeps at rest tells the width of its sign there: else 3.4 times the noise was left."""

    def searched(held):
        found = with_motion_noise(fitted(stopping(0.0), held))
        search = Search(found, found, Rules(), 0, Memory(), (), lambda text: None, Budget())
        search.crossfit = cross_fit(found)
        return search

    motion = fitted(stopping(0.0)).motions[0]
    out = leave_out([motion], standing([motion]), np.ones(2, bool))
    first, second = searched(True), searched(False)
    first.current = replace(first.current, motions=tuple(out))
    size = {id(first.current): 3.4, id(second.current): 0.3 if near else 3.4}
    monkeypatch.setattr(with_rest_module, "over_noise", lambda found: np.array([size[id(found)]]))
    told = with_rest(first, [motion], lambda *of: second)
    assert told is (second if near else first)


@pytest.mark.parametrize(("other", "told"), [(0.5, True), (1.0, False), (None, False)])
def test_a_law_of_more_numbers_explains_rest_where_another_log_says_so(monkeypatch, other, told):
    """Bristles whose friction falls with speed were told as plain ones while their rest was left out."""
    found = with_motion_noise(fitted(stopping(0.0)))
    motion = found.motions[0]
    out = leave_out([motion], standing([motion]), np.ones(2, bool))

    def searched(*logs):
        ended = Search(found, found, Rules(), 0, Memory(), logs, lambda text: None, Budget())
        ended.steps = [SimpleNamespace(added=Term("joint_spring", 0))]
        return ended

    first, second = (searched(*([motion] * (other is not None))) for _ in range(2))
    first.current = replace(found, motions=tuple(out))
    size, one = np.array([0.3, 0.3]), np.ones(2)
    compared = [(one, other, np.array([True, False]), np.array([False, other == 1.0]), "")]
    monkeypatch.setattr(with_rest_module, "over_noise", lambda found: size)
    monkeypatch.setattr(with_rest_module, "_numbers", lambda search: 4 if search is second else 2)
    monkeypatch.setattr(with_rest_module, "errors_elsewhere", lambda *of: compared * len(of[2]))
    ended = with_rest(first, [motion], lambda *of: second)
    assert (ended is second) == told


@pytest.mark.parametrize(
    ("sticks", "more", "again"), [(True, False, 0), (True, True, 1), (False, False, 1)]
)
def test_where_friction_holds_joints_for_moments_rest_has_to_ask_for_a_law(
    monkeypatch, sticks, more, again
):
    """On a measured arm of six joints the second search found the eight laws of the first again."""
    hidden = Term("joint_spring", 0, values={"k": 8.0, "tau0": 2.0})
    other = replace(hidden, joint=1)
    motions = [prepare(stopping(0.0, 0, hidden, *([other] * more)), BAND)]
    out = leave_out(motions, standing(motions), np.ones(2, bool))
    law = replace(hidden, values={})
    found = with_motion_noise(estimate(small_arm(), (*blank(), law), out))
    first = Search(found, found, Rules(), 0, Memory(), (), lambda text: None, Budget())
    first.steps, first.sticking = [SimpleNamespace(removed=(), added=law)], {0} if sticks else set()
    searched = []
    monkeypatch.setattr(with_rest_module, "over_noise", lambda found: np.ones(2))
    monkeypatch.setattr(with_rest_module, "_numbers", lambda search: 2)
    with_rest(first, motions, lambda *of: searched.append(of) or first)
    assert len(searched) == again


@pytest.mark.parametrize(
    ("loud", "more", "again"), [(1, False, 0), (1, True, 1), (0, False, 1)], ids=str
)
def test_rest_of_joints_near_their_noise_has_to_ask_for_a_law(monkeypatch, loud, more, again):
    """On a measured arm one joint of which all rest was fitted was left at 2.01 times its noise."""
    hidden = [Term("joint_spring", 0, values={"k": 8.0, "tau0": 2.0})] if more else []
    motions = [prepare(stopping(0.0, 0, *hidden), BAND)]
    out = leave_out(motions, standing(motions), np.array([True, False]))
    found = with_motion_noise(estimate(small_arm(), blank(), out))
    first = Search(found, found, Rules(), 0, Memory(), (), lambda text: None, Budget())
    searched = []
    monkeypatch.setattr(with_rest_module, "over_noise", lambda found: np.eye(2)[loud] * 2.0 + 1.0)
    with_rest(first, motions, lambda *of: searched.append(of) or first)
    assert len(searched) == again


@pytest.mark.parametrize(("law", "goes_on"), [("joint_spring", True), ("viscous_friction", False)])
def test_rest_is_searched_on_only_for_what_acts_there(monkeypatch, law, goes_on):
    """Friction that motion had told was told again beside rest, for half of the time of four joints."""
    hidden = Term("joint_spring", 0, values={"k": 8.0, "tau0": 2.0})
    motion = prepare(stopping(1.0, 0, *([hidden] * goes_on)), BAND)
    rest = standing([motion])
    dry = tuple(t for t in blank() if t.effect == "coulomb_friction")
    found = estimate(small_arm(), dry, [replace(motion, held=np.zeros_like(rest[0]))])
    found = with_motion_noise(found)
    search = Search(found, found, Rules(), 0, Memory(), (), lambda text: None, Budget())
    search.crossfit = cross_fit(found)
    passed = score_on(found, [Term(law, 0)], 0)
    monkeypatch.setattr(with_rest_module, "held", lambda left, rest, mixed: np.ones(2, bool))
    asked = rest, mixed_with([motion], rest), search
    assert with_rest_module._may_explain(*asked, passed) == goes_on
    assert with_rest_module._may_explain(*asked, [])


@pytest.mark.parametrize(("left", "goes_on"), [(0.131, False), (0.05, True)])
def test_rest_asks_for_what_takes_more_off_it_than_laws_without_torque_there(
    monkeypatch, left, goes_on
):
    """Seven joints that moved one by one: viscous friction left 0.153 of rest, an asymmetric one 0.131."""
    told = {"viscous": (1.0, 0.153, 0.0), "other": (1.0, left, 0.5)}
    rest = [np.ones((4, 1), bool)]
    search = SimpleNamespace(
        current=SimpleNamespace(fit=SimpleNamespace(residual=np.ones((4, 1)))),
        folds=None,
        rules=Rules(),
    )
    monkeypatch.setattr(with_rest_module, "held", lambda left, rest, mixed: np.ones(1, bool))
    monkeypatch.setattr(with_rest_module, "_too_many", lambda search, passed: False)
    monkeypatch.setattr(
        with_rest_module, "_left_at_rest", lambda one, folds, rows: np.array([told[one]]).T
    )
    assert with_rest_module._may_explain(rest, rest, search, ["other"])
    assert not with_rest_module._may_explain(rest, rest, search, ["viscous"])
    assert with_rest_module._may_explain(rest, rest, search, ["viscous", "other"]) == goes_on


@pytest.mark.parametrize(
    ("way", "error", "told"),
    [(1e-4, 0.0, False), (3e-4, 1e-5, False), (1e-3, 1e-4, True), (1e-3, 6e-4, False)],
)
def test_a_bristle_winds_up_by_more_than_positions_tell(way, error, told):
    """Half a count of a coarse encoder was told as hysteresis of a joint that dry friction holds at rest."""
    motion = replace(fitted(stopping(0.0)).motions[0], position_noise=np.array([2e-4, 2e-4]))
    found = replace(fitted(stopping(0.0)), motions=(motion,))
    bristle = Term("hysteresis", 1, values={"fc": 1.0, "x0": way})
    assert can_be_resolved(found, bristle, {"fc": 0.01, "x0": error}) is told
    assert can_be_resolved(found, Term("coulomb_friction", 1, values={"fc": 1.0}), {"fc": 0.01})


@pytest.mark.parametrize(
    ("names", "elsewhere", "told"),
    [
        (("dq_joint2",), 0.5, True),
        (("q_joint1", "q_joint2"), None, True),
        (("dq_joint2",), -0.2, False),
        (("ddq_joint1",), 0.5, False),
    ],
)
def test_structure_of_friction_follows_its_own_joint_and_holds_elsewhere(names, elsewhere, told):
    """A joint that sticks at four points in turn seemed to follow the acceleration of another one."""
    rows = np.zeros(1)
    item = Unexplained(1, names, 0.9, 1e-9, rows, rows, None, rows, elsewhere)
    assert _may_be_friction(item, fitted(stopping(0.0))) is told


def friction_of(found) -> np.ndarray:
    return np.array([t.values["fc"] for t in found.model.terms if t.effect == "coulomb_friction"])


@pytest.mark.parametrize("seed", range(2))
def test_a_joint_that_sticks_for_moments_is_fitted_where_it_moves(seed):
    """As on clean arms with true stiction: their friction was 6 % off, and what was left "unexplained"."""
    log = sticking(seed)
    found = diagnose(small_arm(), blank(), [prepare(log, BAND)])
    assert not found.kept
    assert "joint2" in held_shares(found.final.motions)
    assert remainders(with_motion_noise(fitted(log)))[1].over_noise > 2.0
    assert all(r.over_noise < 1.3 for r in remainders(found.final))
    whole = fitted(log)
    off, before = (np.abs(friction_of(f) / FRICTION - 1.0) for f in (found.final, whole))
    assert (off < 0.01).all() and off[1] < 0.5 * before[1]
    # Of rows that are not fitted the sign says what it said before.
    assert np.isclose(found.final.model.width[1], whole.model.width[1])


@pytest.mark.parametrize("beside", [True, False])
def test_a_joint_that_sticks_for_moments_and_lacks_a_law_is_told_both(monkeypatch, beside):
    """Neither is told without the other: ten times the noise was "unexplained", or nothing was missing."""
    if not beside:
        monkeypatch.setattr(stepwise, "leave_out_beside_laws", lambda search: False)
    spring = Term("joint_spring", 0, values={"k": 8.0, "tau0": 4.0})
    found = diagnose(small_arm(), blank(), [prepare(sticking(0, 2.0, spring), BAND)])
    assert [(s.added.effect, s.added.joint) for s in found.kept] == [("joint_spring", 0)] * beside
    loud = remainders(found.final)[0].over_noise
    assert loud < 1.0 if beside else loud > 1.7
    if beside:
        assert found.kept[0].added.values["k"] == pytest.approx(8.0, rel=0.05)
        assert "joint1" in held_shares(found.final.motions)


def in_turn(two: float) -> tuple:
    """Fits to all rows and to what moves, where the model does ``two`` times as much at rest of a joint."""
    log = sticking()
    motion = prepare(log, BAND)
    every = with_motion_noise(estimate(small_arm(), blank(), [motion]))
    (rows,) = hardly_moving([motion])
    alone = leave_out([motion], [rows], np.ones(2, bool))
    after = with_motion_noise(refit(replace(every, motions=tuple(alone)), every.model.terms))
    out = every.regression.used_rows & ~after.regression.used_rows
    columns = every.regression.columns.copy()
    columns[out[:, 1], 1] *= two
    return replace(every, regression=replace(every.regression, columns=columns)), after


@pytest.mark.parametrize(("two", "held"), [(1.0, True), (100.0, False)])
def test_what_motion_does_not_tell_is_not_left_out_as_what_friction_holds(two, held):
    """Of seven joints that moved one by one the errors on another log rose up to four times."""
    assert is_held(*in_turn(two))[1] == held


def test_a_law_predicts_better_where_friction_holds_joints_in_some_rows():
    """Rows without a weight made the error no number, and no pair of laws was told on such logs."""
    old = fitted(stopping(2.5, 0, Term("joint_spring", 0, values={"k": 8.0, "tau0": 2.0})))
    assert held_shares(old.motions)
    new = refit(old, (*old.model.terms, Term("joint_spring", 0)))
    assert _predicts_better(new, old, 0, 1, Rules())
    assert not _predicts_better(old, new, 0, 1, Rules())


def test_what_holds_a_joint_is_no_more_than_its_friction():
    found = diagnose(small_arm(), blank(), [prepare(sticking(level=15.0), BAND)])
    assert held_shares(found.final.motions) == {}


def test_rest_is_asked_again_once_a_change_is_found():
    """What friction held at rest of a wrist was told as a spring with a dead zone: a load hid it."""
    hidden = Term("joint_spring", 1, values={"k": 20.0, "tau0": 5.0})
    found = compare(truth(), [prepare(stopping(4.0, 0, hidden), BAND)])
    assert [(c.term.effect, c.term.joint) for c in found.changes] == [("joint_spring", 1)]
    assert set(held_shares(found.after.motions)) == {"joint1", "joint2"}
    assert abs(found.changes[0].term.values["k"] - 20.0) < 0.2


@pytest.mark.parametrize(("part", "told"), [(3.0, True), (0.7, False)])
def test_a_push_at_one_rest_is_told_by_more_than_friction_holds(part, told):
    """A push of 8.5 N m on 1.8 N m of friction, at rest, was left out with the rest of all joints."""
    log = stopping(0.0, 2)
    begin = 5 * (MOVE + REST) + MOVE + 0.1
    during = (log.t > begin) & (log.t < begin + 0.4)
    push = np.where(during, part, 0.0)[:, None] * FRICTION * [0.25, 1.0]
    found = compare(truth(), [prepare(replace(log, tau=log.tau + push), BAND)])
    assert [c.term.effect for c in found.changes] == ["contact"] * told
    assert bool(held_shares(found.after.motions)) != told


def test_rest_of_another_log_decides_nothing():
    """Where it is held, neither of two models is compared; it is no event either."""
    one, two = (fitted(log_with(motion_seed=k)) for k in (7, 8))
    other = prepare(stopping(2.5, 3), BAND)
    before, after, moving = residuals_on(one, two, other)
    assert event_windows(one, two, other) == ()
    assert len(before) == len(moving) and not moving.all()
    assert np.sqrt((before**2).mean()) < 0.5
    assert np.sqrt((after**2).mean()) < 0.5


def test_an_error_that_is_that_of_rest_is_told_so():
    """As on a measured arm: 1.47 N m, of which motion has 0.15."""
    of = {"rms": [2.3, 1.47], "rms_moving": [1.7, 0.15], "rms_standing": [None, 1.9]}
    (line,) = rest_lines({"test.npz": of}, ("joint1", "joint6"), ("N m", "N m"))
    assert line.startswith("test.npz: ") and "joint6 (1.9 N m at rest, 0.15 in motion)" in line
    assert "joint1" not in line
    alike = {"rms": [0.15], "rms_moving": [0.15], "rms_standing": [0.16]}
    assert rest_lines({"test.npz": alike}, ("joint6",), ("N m",)) == []


def test_a_joint_that_hardly_moves_is_held_by_any_torque_within_its_friction():
    """No event is told by less than what holds it; where it moves, by no more than before."""
    found = with_motion_noise(fitted(log_with()))
    motion = found.motions[0]
    doubt = event_doubt(found)[:, 1]
    speed = np.abs(motion.dq[motion.decimator.kept(len(motion.t)), 1])
    fc = next(t.values["fc"] for t in found.model.terms if t.place[:2] == ("coulomb_friction", 1))
    slow, fast = doubt[speed < found.model.width[1]], doubt[speed > 0.3 * speed.max()]
    assert slow.max() > 0.15 * fc > 0.0 and slow.mean() > 3.0 * np.median(fast)
    assert np.median(fast) < 0.05 * fc


def test_a_joint_that_stands_is_held_by_its_friction_though_others_move_it():
    """By five widths of its sign, at which the sign is whole: a rest was told as a push."""
    found, width = fitted(stopping(0.0, creep=0.3), held=False), np.full(2, 6e-4)
    model = replace(found.model, width=tuple(width))
    found = with_motion_noise(replace(found, model=model))
    (motion,) = found.motions
    (rest,) = standing([motion])
    speed = np.abs(motion.dq[motion.decimator.kept(len(motion.t))])
    doubt, noise = event_doubt(found), noise_of(found)
    for j, fc in enumerate(FRICTION):
        crept = rest[:, j] & (speed[:, j] > 3.0 * width[j])
        moves = speed[:, j] > 0.3 * speed[:, j].max()
        assert crept.sum() > 20
        assert np.median(doubt[crept, j]) > 0.3 * fc > 3.0 * noise[j]
        assert np.median(doubt[moves, j]) < 0.05 * fc


def test_a_joint_that_never_moves_says_nothing_of_what_motion_foretells():
    rng = np.random.default_rng(0)
    columns, left = rng.normal(size=(60, 2, 3)), rng.normal(size=(60, 2))
    resting = np.zeros((60, 2), bool)
    resting[30:] = True
    columns[:30, :, 2] = 0.0  # what only rest tells: motion does not foretell it
    assert not rest_foretold.is_foretold(columns, left, resting).any()
    still = np.concatenate([columns, rng.normal(size=(60, 1, 3))], axis=1)
    told = rest_foretold.is_foretold(
        still,
        np.pad(left, ((0, 0), (0, 1))),
        np.pad(resting, ((0, 0), (0, 1)), constant_values=True),
    )
    assert told.tolist() == [False, False, True]


def test_what_motion_foretells_is_found_a_joint_at_a_time(monkeypatch):
    """Copies of all columns beside them took ten million samples of seven joints from 3.4 to 4.5 GiB."""
    rng = np.random.default_rng(1)
    columns, left = rng.normal(size=(400, 3, 5)), rng.normal(size=(400, 3))
    resting = rng.random((400, 3)) < 0.3
    passed, factor = [], rest_foretold.triangular_factor

    def counted(matrix):
        passed.append(matrix.size)
        return factor(matrix)

    monkeypatch.setattr(rest_foretold, "triangular_factor", counted)
    told = rest_foretold.is_foretold(columns, left, resting)
    assert len(passed) == 3 and max(passed) <= columns[:, 0].size
    size = rest_foretold.rms_in_motion(left, resting)
    weighted = columns / size[:, None]
    weighted /= np.linalg.norm(weighted, axis=(0, 1))
    known = np.concatenate([weighted[~resting], rest_foretold._UNSEEN * np.eye(5)])
    each = np.einsum("tjp,pq,tjq->tj", weighted, np.linalg.inv(known.T @ known), weighted)
    usual = [np.median(np.sqrt(1.0 + d)[r]) for d, r in zip(each.T, resting.T, strict=True)]
    for most, expected in ((min(usual), 1), (max(usual), 3)):
        monkeypatch.setattr(rest_foretold, "_TOLD", most + 1e-9)
        assert rest_foretold.is_foretold(columns, left, resting).sum() == expected
    assert told.all()


@pytest.mark.parametrize(
    ("joints", "left", "whole_arm", "goes_on"),
    [
        ((0, 1), 1, False, True),
        ((0, 1, 2), 1, False, False),
        ((0, 0, 1), 1, False, True),
        ((0, 1, 2), 1, True, True),
    ],
)
def test_rest_is_not_searched_on_where_more_joints_lack_a_law_than_rounds_are_left(
    monkeypatch, joints, left, whole_arm, goes_on
):
    """Four joints of a measured arm had one in the last round, and all laws were asked again for nothing."""
    term = SimpleNamespace(law=SimpleNamespace(mutual=False))
    passed = [
        SimpleNamespace(joint=j, own=np.ones(1), candidate=SimpleNamespace(term=term))
        for j in joints
    ]
    if whole_arm:
        passed[0].own = None
    search = SimpleNamespace(left=left, current=SimpleNamespace(fit=SimpleNamespace(residual=None)))
    monkeypatch.setattr(with_rest_module, "held", lambda residual, rest, mixed: np.zeros(3, bool))
    assert with_rest_module._may_explain([], [], search, passed) == goes_on


@pytest.mark.parametrize(
    ("term", "itself"),
    [
        (Term("thermal_drift", 1, values={"fc": 1.0, "tc": 1.5}), True),
        (Term("thermal_drift", 1, values={"fc": 1.0, "tc": 1.0}), False),
        (Term("thermal_drift", 1, values={"fc": 1.0, "tc": 1e4}), True),
        (Term("offset_drift", 1, values={"rate": 1.0, "tc": 1.0}), False),
        (Term("cubic_spring", 1, values={"k3": 1.0, "q0": -3.1}), True),
        (Term("cubic_spring", 1, values={"k3": 1.0, "q0": 3.2}), False),
        (Term("viscous_friction", 1, values={"b": 0.0}), True),
    ],
)
def test_a_value_at_a_bound_may_be_another_law(term, itself):
    """A linear spring was told as a cubic one about a point a whole travel beyond all positions."""
    assert is_itself(term) is itself
