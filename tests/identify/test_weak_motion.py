"""Motion that tells too little is refused with what it lacks, and fitted all the same where a user insists."""

import numpy as np
import pytest
from slide import EFFECTS, assert_refused, identify, run, slide_log

import jaxswarm
from jaxswarm.errors import InputError


def written(path, length, resting=False):
    lines = slide_log(length)
    if resting:
        rows = (line.split(",") for line in lines[1:])
        lines[1:] = [f"{t},{0.1 + 1e-7 * k},{force}" for k, (t, _, force) in enumerate(rows)]
    path.write_text("\n".join(lines) + "\n")
    return path


def test_a_short_log_is_refused_by_name_unless_accepted(tmp_path):
    log = written(tmp_path / "short.csv", 60)
    told = identify(log, tmp_path / "out")
    assert_refused(told, "short.csv", "weak_motion", "log at least", "--accept weak_motion")
    assert not (tmp_path / "out").exists()
    code, _, err = identify(log, tmp_path / "out", "--accept", "weak_motion")
    assert code == 0, err


def test_against_a_model_too(tmp_path):
    whole = written(tmp_path / "whole.csv", 600)
    assert identify(whole, tmp_path / "model")[0] == 0
    short = written(tmp_path / "short.csv", 60)
    given = "diagnose", short, "--robot", "emps", "--model", tmp_path / "model" / "model.json"
    assert_refused(run(*given, "--out", tmp_path / "out"), "weak_motion", "log at least")
    assert not (tmp_path / "out").exists()


def test_a_standing_slide_is_refused(tmp_path):
    log = written(tmp_path / "log.csv", 600, resting=True)
    assert_refused(identify(log, tmp_path / "out"), "never moves")


def slide(seed=0):
    t, q, tau = np.array([line.split(",") for line in slide_log(600, seed)[1:]], float).T
    return jaxswarm.log_from_arrays(t, q, tau, joints=("slide",))


def test_what_is_fitted_proves_nothing():
    for ask in (jaxswarm.identify, jaxswarm.diagnose):
        with pytest.raises(InputError, match="holds the motion that is fitted"):
            ask(slide(), "emps", EFFECTS, validation=slide(seed=1))
