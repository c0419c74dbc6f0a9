"""With several logs all of them are told and drawn, and an event in the one in which it happened."""

import json
from dataclasses import replace

import numpy as np
import pytest
from planted import BAND, blank, log_with, small_arm
from slide import EFFECTS, run, slide_log

import jaxswarm
from jaxswarm.diagnose.folds.partial_out import cross_fit
from jaxswarm.diagnose.report.orders import remaining, where_seen
from jaxswarm.diagnose.selection.diagnosis import Diagnosis
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.effects.term import Term
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare


@pytest.fixture
def files(tmp_path):
    paths = [tmp_path / name for name in ("monday.csv", "friday.csv")]
    for seed, path in enumerate(paths):
        path.write_text("\n".join(slide_log(500 + 100 * seed, seed)) + "\n")
    return paths


def test_every_fitted_log_has_its_row(files, tmp_path):
    out = tmp_path / "out"
    code, text, _ = run("identify", *files, "--robot", "emps", "--effects", EFFECTS, "--out", out)
    assert code == 0
    assert "fitted: monday.csv" in text and "fitted: friday.csv" in text
    train = json.loads((out / "identification.json").read_text())["error"]["train"]
    rms = [f"{errors['rms'][0]:.4g}" for errors in train]
    assert len(set(rms)) == 2 and all(number in text for number in rms)
    told = str(jaxswarm.identify(files, "emps", EFFECTS))
    assert "fitted: monday.csv" in told and "fitted: friday.csv" in told


def test_the_residual_is_drawn_of_all_fitted_logs():
    logs = [log_with(motion_seed=7), log_with(motion_seed=8, duration=9.0)]
    found = estimate(small_arm(), blank(), [prepare(log, BAND) for log in logs], bounded=False)
    whole = Diagnosis(found, found, (), (), cross_fit(found), 0)
    residual, variables, *_, title = remaining(whole, "left")
    assert len(residual) == len(found.regression.torque) and "2 fitted logs" in title
    assert all(len(values) == len(residual) for values in variables.values())
    second = found.regression.log == 1
    np.testing.assert_allclose(variables["time [s]"][second], found.regression.t[second])


def test_an_event_is_drawn_in_its_own_log():
    logs = [prepare(log_with(motion_seed=seed), BAND) for seed in (7, 8)]
    found = estimate(small_arm(), blank(), logs, bounded=False)
    values = {"log": 1.0, "start": 2.0, "end": 2.5, "tau_joint1": 3.0, "tau_joint2": 0.0}
    event = Term("contact", values=values)
    model = replace(found.model, terms=(*found.model.terms, event))
    final = replace(found, model=model)
    for term, log, seen in ((event, 1, True), (found.model.terms[0], 0, False)):
        step = Step(term, None, (), (), found, final, ())
        told, motion = where_seen(step, final)
        assert motion is final.motions[log] and (event in told.terms) == seen
