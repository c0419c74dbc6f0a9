"""Functions and commands of one name say the same of the same logs."""

import json
import math

import numpy as np
import pytest
from test_surface import slide_arrays

import jaxswarm
from jaxswarm.diagnose.run import diagnose_files
from jaxswarm.diagnose.selection.what_moves import fit_of_what_moves
from jaxswarm.identify.options import Options
from jaxswarm.identify.run import identify_files
from jaxswarm.outputs import to_json

# Where logs came from is a matter of files.
OF_FILES = ("provenance", "source", "log", "on", "validation_log")


@pytest.fixture
def logs(tmp_path):
    """A log to fit and one to score on, of a slide with friction, as files."""
    paths = []
    for number, scale in enumerate((1.0, 0.7)):
        t, q, tau = slide_arrays(seed=number)
        dry = 5.0 * np.tanh(np.gradient(q, t) / 0.01)  # does not shrink with the motion
        q, tau = scale * q, scale * (tau - dry) + dry
        paths.append(tmp_path / f"log{number}.npz")
        np.savez(paths[-1], t=t, q=q[:, None], tau=tau[:, None])
    return paths


def differences(one, two, where: str = "") -> list[str]:
    """Places at which two results differ, files aside."""
    if isinstance(one, dict) and isinstance(two, dict):
        keys = sorted({*one, *two} - {*OF_FILES})
        apart = [f"{where}/{key}" for key in keys if (key in one) != (key in two)]
        both = [key for key in keys if key in one and key in two]
        return apart + [
            x for key in both for x in differences(one[key], two[key], f"{where}/{key}")
        ]
    if isinstance(one, list) and isinstance(two, list) and len(one) == len(two):
        pairs = enumerate(zip(one, two, strict=True))
        return [x for k, (a, b) in pairs for x in differences(a, b, f"{where}/{k}")]
    if isinstance(one, float) and isinstance(two, float):
        return [] if math.isclose(one, two, rel_tol=1e-6, abs_tol=1e-9) else [where]
    return [] if one == two else [where]


def plain(result) -> dict:
    return json.loads(to_json(dict(result)))


@pytest.mark.parametrize("estimator", ["least_squares", "output_error"])
def test_identify(logs, tmp_path, estimator):
    terms, (log, other) = "viscous_friction,coulomb_friction", logs
    asked = Options(estimator=estimator, physical=True)
    written = identify_files(
        [log], "emps", terms, tmp_path / "out", other, asked, settled=fit_of_what_moves
    )
    given = jaxswarm.identify(
        log, "emps", terms, validation=other, estimator=estimator, physical=True
    )
    assert differences(plain(written), plain(given)) == []
    shown = " ".join(repr(given).split())
    assert "3 of 3 base parameters determined" in shown and "coulomb_friction" in shown


def test_diagnose(logs, tmp_path):
    log, other = logs
    written = diagnose_files([log], "emps", "viscous_friction", tmp_path / "out", [other])
    given = jaxswarm.diagnose(log, "emps", "viscous_friction", validation=other)
    assert [effect["effect"] for effect in given["effects"]] == ["coulomb_friction"]
    assert differences(plain(written), plain(given)) == []


def test_an_estimator_that_does_not_exist_is_refused(logs):
    with pytest.raises(jaxswarm.errors.InputError, match="unknown estimator 'ridge'"):
        jaxswarm.identify(logs[0], "emps", estimator="ridge")
