"""Structure without a law is told with what of it holds on motion it was not fitted to."""

from dataclasses import replace

import pytest
from planted import declared_fit, log_with
from test_unexplained import LAWS, with_extra

from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.diagnose.decision.unexplained import find_unexplained
from jaxswarm.diagnose.report.remains import look_at, remaining
from jaxswarm.diagnose.report.text import evidence_sentence
from jaxswarm.diagnose.selection.survives import proven
from jaxswarm.logs.motion import prepare

LAW = LAWS[1][1]


@pytest.fixture(scope="module")
def structured():
    found, background = declared_fit(with_extra(LAW))
    (item,) = [u for u in find_unexplained(found, background) if u.joint == 1]
    return found, item


def test_regions_that_were_not_fitted_say_less_than_time_that_was_not(structured):
    _, item = structured
    assert 0.1 < item.elsewhere < item.share


def test_other_motion_of_the_same_arm_is_told_and_the_term_kept(structured):
    found, item = structured
    other = prepare(with_extra(LAW, motion_seed=8), found.model.filtering)
    (told,) = proven(found, [item], [other])
    assert told.term is not None
    assert 0.1 < told.elsewhere < 1.0


def test_what_does_not_hold_on_other_motion_is_told_and_kept_out_of_the_model(structured):
    found, item = structured
    clean = prepare(log_with(motion_seed=8), found.model.filtering)
    (told,) = proven(found, [item], [clean])
    assert told.term is None
    assert told.elsewhere < 0.0


def test_what_no_other_log_has_on_a_joint_near_its_noise_is_no_structure(structured):
    found, item = structured
    clean = prepare(log_with(motion_seed=8), found.model.filtering)
    noisy = [replace(m, bounded_noise=20.0 * m.sensor_noise) for m in found.motions]
    loud = replace(found, motions=tuple(noisy))
    assert all(r.near for r in remainders(loud))
    assert proven(loud, [item], [clean]) == []
    same = prepare(with_extra(LAW, motion_seed=8), found.model.filtering)
    assert len(proven(loud, [item], [same])) == len(proven(loud, [item], [clean, same])) == 1
    assert len(proven(loud, [item], [])) == 1


def test_the_sentence_says_how_much_of_it_holds_elsewhere():
    entry = {
        **{"joint": "joint2", "share": 0.4, "over_noise": 3.0, "depends_on": ["q_joint1"]},
        **{"band_hz": [0.2, 3.0], "windows": [{"log": 0, "start": 1.0, "end": 2.5}]},
    }
    where = "(3.0 times the noise at 0.2 to 3 Hz, mostly at 1-2.5 s)"
    start = f"40 % of the remaining error of joint2 {where} follows q_joint1"
    assert remaining({**entry, "share_on_other_motion": None}) == start
    assert remaining({**entry, "share_on_other_motion": 0.25}) == start + ", on other motion 25 %"
    assert remaining({**entry, "share_on_other_motion": -2.0}).endswith(
        "on other motion none of it"
    )


def test_states_that_one_log_does_not_tell_from_time_are_told_with_what_would():
    entry = {
        **{"joint": "joint1", "share": 0.85, "over_noise": 9.0, "depends_on": ["q_joint1", "t"]},
        **{"band_hz": [0.2, 3.0], "windows": [], "share_on_other_motion": None},
    }
    both = {**entry, "or_states": {"depends_on": ["q_joint2", "q_joint1"], "share": 0.75}}
    assert remaining({**entry, "or_states": None}).endswith("follows q_joint1 and t")
    told = "follows q_joint1 and t, or nearly as well q_joint2 and q_joint1 (75 %)"
    assert remaining(both).endswith(told)
    more = [step for step in look_at(both) if step not in look_at(entry)]
    assert [step.split(":")[0] for step in more] == ["Record another motion and pass both logs"]


def test_the_sentence_names_the_joints_and_times_that_matter_most():
    """All of them stand in the list below it."""
    windows = [{"log": 0, "start": float(k), "end": k + 0.5 + 0.1 * k} for k in range(4)]
    entry = {"share": 0.4, "depends_on": [], "band_hz": [0.2, 3.0], "windows": windows}
    left = [
        {**entry, "joint": f"joint{k}", "over_noise": x} for k, x in enumerate((9.0, 3.0, 8.0, 5.0))
    ]
    errors = {"relative_global": 0.1, "on": "other motion"}
    result = {
        **{"error": {"before": errors, "after": errors}, "verdict": "unexplained", "proof": "none"},
        **{"effects": [], "changed": [], "discovered": [], "unexplained": left, "joints": []},
        **{"residual_over_noise": [], "undecided": []},
    }
    told = evidence_sentence(result)
    assert all(f"joint{k} is left with" in told for k in (0, 2, 3)) and "joint1" not in told
    assert told.count("mostly at 2-2.7 s, 3-3.8 s, other times") == 3
    assert "; and less on 1 more joint (error" in told
    assert "1-1.6 s" in remaining(left[0]) and "other times" not in remaining(left[0])
