"""Logs of another simulator (``cases/``): a clean one, one with an effect, one with a late clock."""

import json

import numpy as np
import pytest

from jaxswarm.diagnose import diagnose
from jaxswarm.effects.term import Term
from jaxswarm.logs import read_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import rx60


@pytest.mark.parametrize("name", ["p01", "p05", "p13"])
def test_truth_is_named_and_nothing_else(data_root, name):
    folder = data_root / "cases" / name
    if not folder.is_dir():
        pytest.skip(f"no practice case at {folder}")
    told = json.loads((folder / "truth.json").read_text())
    declared = tuple(Term(d["effect"], d["joint"] - 1) for d in told["declared"])
    motion = prepare(read_log(folder / "train.npz", rx60().joints))
    found = diagnose(rx60(), declared, [motion])
    truth = [(e["effect"], e["joint"] - 1 if "joint" in e else None) for e in told["effects"]]
    assert [(s.added.effect, s.added.joint) for s in found.steps] == truth
    if name == "p13":
        total = found.steps[0].added.values["seconds"] + found.final.motions[0].skew
        # The torque is sampled and held, late by half of the 4 ms besides.
        assert total == pytest.approx(told["effects"][0]["params"]["seconds"], abs=2.5e-3)
    noise = np.array(told["noise"]["tau"])
    assert (found.final.fit.sigma < noise).all()
