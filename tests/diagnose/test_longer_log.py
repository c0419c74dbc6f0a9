"""What may be chance in a short log, and is worth a longer one."""

import pytest

from jaxswarm.diagnose.report.refusal import _CHANCE, worth_a_longer_log


def refused(joint, share=0.99, because=(_CHANCE,)) -> dict:
    named = {"effect": "base_tilt" if joint is None else "torque_offset", "joint": joint}
    return {**named, "share_of_error": share, "p_value": 1e-4, "rejected_because": list(because)}


@pytest.mark.parametrize(
    ("joint", "told"),
    [
        ("joint2", "torque_offset would take off 99 % of the error of joint2, but"),
        (None, "base_tilt would take off 99 % of the error of the joint where it shows most, but"),
    ],
)
def test_each_is_told_where_it_acts(joint, told):
    (line,) = worth_a_longer_log([refused("joint2"), refused(None)], joint)
    assert line.startswith(told) and "record a longer log" in line


@pytest.mark.parametrize("other", [{"share": 0.4}, {"because": (_CHANCE, "sign or size")}])
def test_what_fails_by_more_than_chance_is_not_told(other):
    assert worth_a_longer_log([refused(None, **other)], None) == []
