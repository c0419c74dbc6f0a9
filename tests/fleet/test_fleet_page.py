"""The page and the ranking of a fleet, from results made by hand."""

from datetime import datetime

import numpy as np

from jaxswarm.fleet.collect import collect, in_order, joint_of
from jaxswarm.fleet.drift import drifts
from jaxswarm.fleet.mixed_model import deviations
from jaxswarm.fleet.page import headline, render
from jaxswarm.fleet.pictures import changed, over_time
from jaxswarm.fleet.ranking import rank
from jaxswarm.fleet.sources import Source
from jaxswarm.plots import png_bytes

JOINTS = ["axis", "axis1"]


def result(friction, over_noise=(1.0, 1.1), verdict="nothing missing"):
    rows = [
        {"name": f"fc_{joint}", "effect": "law", "expression": f"fc_{joint}", "value": value,
         "std_error": 0.05, "unit": "N m", "verdict": "determined"}
        for joint, value in zip(JOINTS, friction, strict=True)
    ]  # fmt: skip
    return {
        "joints": JOINTS, "torque_units": ["N m"] * 2, "effects": [], "changed": [], "reasons": [],
        "verdict": verdict, "residual_over_noise": list(over_noise), "base_parameters": rows,
    }  # fmt: skip


def a_fleet():
    """Ten arms with four logs; one has more friction than the others, that of another one grows."""
    rng, results = np.random.default_rng(0), []
    for arm in range(10):
        own = [3.0, 2.0] + 0.1 * rng.normal(size=2) + [2.0 * (arm == 3), 0.0]
        for week in range(4):
            noise = 0.05 * rng.normal(size=2)
            friction = own + noise + [0.0, 0.5 * week * (arm == 6)]
            day = datetime(2026, 1, 1 + 7 * week)
            source = Source(f"/x/{arm}/{week}.csv", f"{arm}/{week}.csv", f"arm{arm}", day, 1)
            results.append((source, result(friction, (1.0, 1.0 + (arm == 6) * week))))
    bad = Source("/x/<b>.csv", "<b>.csv", "arm<b>", None, 1)
    results.append((bad, {"unused": "refused", "reason": "no & data"}))
    order = in_order(source for source, _ in results)
    return collect(sorted(results, key=lambda pair: order.index(pair[0])))


def test_the_different_arm_and_the_drifting_one_stand_first():
    fleet = a_fleet()
    apart, moved = deviations(fleet.series), drifts(fleet.series)
    arms = rank(fleet.entries, apart, moved)
    assert [arm.name for arm in arms[:2]] == ["arm6", "arm3"]
    assert arms[1].differs == ("fc_axis",) and arms[0].drifts == ("fc_axis1",)
    assert not any(arm.differs or arm.drifts for arm in arms if arm.name not in ("arm3", "arm6"))
    assert arms[0].worst == 4.0 and arms[0].last == datetime(2026, 1, 22)
    assert headline(arms).startswith("Of 11 arms ")


def test_the_page_tells_both_with_pictures_and_escapes_names():
    fleet = a_fleet()
    apart, moved = deviations(fleet.series), drifts(fleet.series)
    arms = rank(fleet.entries, apart, moved)
    images = {
        "drift.png": png_bytes(over_time(fleet, [arm.name for arm in arms])),
        "changed.png": png_bytes(changed(fleet, moved)),
    }
    page = render("kind", fleet, arms, apart, moved, images)
    assert page.count("<img") == 2 and "fc_axis1" in page and "no &amp; data" in page
    assert "<b>" not in page and "arm&lt;b&gt;" in page


def test_nothing_is_drawn_of_logs_of_one_day():
    source = Source("/x/a.csv", "a.csv", "a", datetime(2026, 1, 1), 1)
    fleet = collect([(source, result([3.0, 2.0]))])
    assert over_time(fleet, ["a"]) is None and changed(fleet, []) is None


def test_joints_of_parameters():
    assert joint_of({"name": "fc_axis1"}, JOINTS) == "axis1"
    assert joint_of({"name": "fc_axis"}, JOINTS) == "axis"
    assert joint_of({"name": "Izz2"}, JOINTS) == "axis1"
    assert joint_of({"name": "seconds"}, JOINTS) is None
