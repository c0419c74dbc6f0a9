"""The picture of an effect shows that effect: on the joint that feels it, against what it follows."""

from types import SimpleNamespace

import numpy as np
import pytest
from planted import BAND, DECLARED, log_with, small_arm

from jaxswarm.diagnose.report.figures import evidence
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import prepare

# A forearm that sits 30 mm further out.
LONGER = {"x": 0.03, "y": 0.0, "turn_x": 0.0, "turn_y": 0.0}


@pytest.fixture(scope="module")
def motion():
    return prepare(log_with(), BAND)


def drawn(term, motion):
    """Axes of the picture of a term in a model, and the points of the effect in the left one."""
    model = Model(small_arm(), (*DECLARED, term), (0.02, 0.02), BAND, (0.1, 0.1))
    axes = evidence(SimpleNamespace(added=term, rest=None), model, motion).axes
    return axes, axes[0].get_lines()[1].get_xydata().T


@pytest.mark.parametrize(
    ("term", "slope"),
    [
        (Term("time_delay", values={"seconds": 0.01}), -0.01),
        (Term("torque_lag", values={"tc": 0.01, "seconds": 0.005}), -0.015),
        (Term("rotor_inertia", 0, values={"ia": 0.5}), 0.5),
        (Term("drive_gain", 0, values={"gain": 1.25}), 0.2),
        (Term("torque_crosstalk", 0, 1, values={"c": 0.3}), 0.3),
        (
            Term("transmission_coupling", 0, 1, values={"b": 3.0, "fc": 0.0, "fd": 0.0, "ia": 0.0}),
            3.0,
        ),
    ],
)
def test_what_is_a_matter_of_one_variable_is_drawn_as_a_line_against_it(term, slope, motion):
    _, (x, y) = drawn(term, motion)
    assert np.corrcoef(x, y)[0, 1] * np.sign(slope) > 0.97
    assert np.polyfit(x, y, 1)[0] == pytest.approx(slope, rel=0.15)


def test_a_link_elsewhere_is_drawn_on_the_joint_that_carries_it(motion):
    axes, (_, y) = drawn(Term("link_geometry", 1, values=LONGER), motion)
    assert axes[0].get_ylabel() == "joint1 [N m]" and axes[0].get_xlabel() == "q of joint2 [rad]"
    assert np.abs(y).max() > 0.5


def test_what_goes_by_time_is_drawn_over_time_once(motion):
    axes, (x, y) = drawn(Term("friction_change", 0, values={"fc": 2.0, "t0": 5.0}), motion)
    assert len(axes) == 1 and axes[0].get_xlabel() == "time [s]"
    assert np.abs(y[x < 4.8]).max() < 0.01 and np.abs(y[x > 5.5]).max() > 1.9
