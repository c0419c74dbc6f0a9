"""What counts as right in the table of the worlds, and what the rivals choose."""

import numpy as np
import pytest

from benchmarks.worlds.plain import low_pass, prediction_error
from benchmarks.worlds.score import place_label
from benchmarks.worlds.table import category, outcome, wilson, worlds_table


def _row(effects=(), outside=(), added=(), undecided=(), unexplained=(), inseparable=(), **more):
    def entries(labels):
        return [
            {"label": name, "kind": name.partition("@")[0], "ratio": r, "visible": r >= 2}
            for name, r in labels
        ]

    return {
        "effects": entries(effects),
        "outside": entries(outside),
        "inseparable": entries(inseparable),
        "added": list(added),
        "undecided": [{"joint": j, "effects": e} for j, e in undecided],
        "unexplained": [{"joint": j} for j in unexplained],
        "known": ["joint_spring", "stribeck_friction", "torque_offset"],
        "common": False,
        **more,
    }


SPRING = ("joint_spring@joint1", 4.0)
FAINT = ("torque_offset@joint2", 0.5)
STRANGE = ("cubic_spring@joint2", 4.0)


@pytest.mark.parametrize(
    "row, wanted",
    [
        (_row(), "right"),
        (_row(added=["torque_offset@joint1"]), "false"),
        (_row([SPRING], added=[SPRING[0]]), "right"),
        (_row([SPRING]), "missed"),
        (_row([SPRING], added=["joint_spring@joint2"]), "false"),
        (_row([FAINT]), "right"),
        (_row([FAINT], added=[FAINT[0]]), "right"),
        (_row([SPRING, FAINT], added=[SPRING[0]]), "right"),
        (_row([SPRING], added=[SPRING[0], "stribeck_friction@joint2"]), "false"),
        (_row(inseparable=[SPRING]), "right"),
        (_row(inseparable=[SPRING], added=[SPRING[0]]), "right"),
        (
            _row(
                [SPRING],
                added=["torque_offset@joint1"],
                undecided=[("joint1", ["torque_offset", "joint_spring"])],
            ),
            "undecided",
        ),
        (_row(outside=[STRANGE], unexplained=["joint2"]), "right"),
        (_row(outside=[STRANGE], unexplained=["joint1"]), "missed"),
        (
            _row(outside=[STRANGE], unexplained=["joint2"], added=["joint_spring@joint2"]),
            "false",
        ),
        (_row(outside=[("joint_spring@joint2", 4.0)], added=["joint_spring@joint2"]), "right"),
        (_row([SPRING], error="ValueError"), "crashed"),
    ],
)
def test_outcomes(row, wanted):
    assert outcome(row) == wanted


def test_categories_go_by_what_can_be_seen():
    assert category(_row()) == "clean"
    assert category(_row(inseparable=[SPRING])) == "inseparable effects only"
    assert category(_row([FAINT])) == "faint effects only"
    assert category(_row([SPRING, FAINT])) == "2 effects, 1 visible"
    assert category(_row(outside=[STRANGE])) == "outside law, visible"


def test_wilson_interval_of_nothing_wrong_in_many():
    """Zero of 500: the upper end is z^2 / (n + z^2), three quarters of a percent."""
    assert wilson(0, 500) == "0/500 = 0.0 % [0.0, 0.8]"
    assert wilson(0, 0) == "-"


def test_a_row_that_crashed_is_counted_and_not_scored():
    crashed = _row(
        [SPRING],
        error="diagnose: x",
        size=3,
        controller="pd",
        motion="ptp",
        declares="nothing",
        checked=False,
    )
    text = worlds_table([crashed])
    assert "| crashes | 1/1 = 100.0 %" in text


def test_labels_from_names_and_from_numbers():
    assert place_label("base_tilt", None, None) == "base_tilt"
    assert place_label("joint_spring", 2, None) == "joint_spring@joint2"
    assert place_label("cable_coupling", "joint1", "joint3") == "cable_coupling@joint1:joint3"


def test_prediction_error_is_blind_above_its_band():
    t = np.arange(0.0, 10.0, 0.005)
    clean = np.zeros((len(t), 1))
    fast, slow = np.sin(2 * np.pi * 60 * t), np.sin(2 * np.pi * 1 * t)
    assert prediction_error(t, fast[:, None], clean, 200.0)[0] < 1e-3
    assert prediction_error(t, slow[:, None], clean, 200.0)[0] == pytest.approx(0.5**0.5, rel=1e-2)
    assert np.abs(low_pass(slow, 200.0, 8.0) - slow)[100:-100].max() < 1e-2


@pytest.mark.parametrize("name", ["stepwise, CV", "stepwise, BIC", "STLSQ", "LASSO"])
def test_every_rival_finds_two_plain_columns(name):
    pytest.importorskip("sklearn")
    from benchmarks.worlds.choosers import CHOOSERS, blocks

    rng = np.random.default_rng(0)
    x = rng.normal(size=(600, 20))
    x /= np.linalg.norm(x, axis=0)
    y = 5.0 * x[:, 3] - 4.0 * x[:, 11] + 1e-3 * rng.normal(size=600)
    kept = CHOOSERS[name](x, y, blocks(600))
    assert {3, 11} <= set(kept)
    w = np.linalg.lstsq(x[:, kept], y, rcond=None)[0]
    assert np.linalg.norm(y - x[:, kept] @ w) < 0.05
