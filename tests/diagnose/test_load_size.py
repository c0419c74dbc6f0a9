"""A load for a while is no larger than the arm that carries it."""

from types import SimpleNamespace

import numpy as np
import pytest
from planted import small_arm

from jaxswarm.diagnose.selection.load_size import is_no_larger_than_its_arm
from jaxswarm.effects.term import Term

FOUND = SimpleNamespace(model=SimpleNamespace(robot=small_arm()))  # links of 0.36 m in all
NAMES = ("m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")


def fits(errors=None, way=1.0, **values):
    """Whether a load of 2 kg, or one put down, is one, with what differs from a point at the joint."""
    held = {"start": 1.0, "end": 5.0, "log": 0.0}
    term = Term(
        "payload_change",
        values=dict.fromkeys(NAMES, 0.0) | {"m": 2.0 * way} | held | values,
    )
    known = dict.fromkeys((*NAMES, *held), 0.0) | (errors or {})
    return is_no_larger_than_its_arm(FOUND, term, known)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_load_of_the_size_of_a_hand_is_one(way):
    assert fits(way=way, mcx=0.2 * way, Iyy=0.03 * way, Izz=0.03 * way)


@pytest.mark.parametrize(
    "values",
    [
        {"Ixx": 0.2},  # of a radius of 0.32 m
        {"mcz": -0.5},  # 0.25 m away
        {"Iyy": -0.02},  # of the other sign
        {"m": -2.0, "Iyy": 0.02},
    ],
)
def test_what_a_force_that_keeps_its_direction_would_weigh_is_none(values):
    assert not fits(**values)


def test_chance_may_make_it_larger():
    assert fits({"Ixx": 0.1}, Ixx=0.2) and fits({"Iyy": 0.02}, Iyy=-0.02)
    assert fits({"m": np.nan}, mcx=0.2)


def test_other_terms_have_no_size():
    assert is_no_larger_than_its_arm(FOUND, Term("contact", values={"tau_joint1": 9.0}), {})
