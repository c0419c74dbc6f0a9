"""Positions in degrees, revolutions or millimeters are told with the unit to name."""

from dataclasses import replace

import numpy as np
import pytest

from jaxswarm.errors import InputError
from jaxswarm.identify.checks.channels import _believed
from jaxswarm.identify.checks.check_log import against_robot, checked
from jaxswarm.identify.checks.position_units import position_unit_guesses
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import samples_of
from jaxswarm.identify.checks.sound import Tried
from jaxswarm.logs import read_log
from jaxswarm.logs.motion import Filtering
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.robot.load import load_robot

TURN = 2.0 * np.pi


def found(arm, log):
    return against_robot(arm, prepare_segments(log, Filtering(torque_cutoff=5.0))[1])


@pytest.mark.parametrize(("size", "unit"), [(TURN, "rev"), (TURN / 360.0, "deg"), (1e-3, "mrad")])
def test_the_unit_of_all_positions_is_told_as_the_option_that_names_it(arm, log, size, unit):
    finding, *_ = found(arm, replace(log, q=log.q / size))
    assert finding.check == "encoder_scale" and finding.refused
    assert finding.remedy == f"Name the unit: --columns q:{unit}"


def test_revolutions_are_told_where_undeclared_friction_leaves_much(data_root):
    """They gain 0.6 there, and on logs that are right nothing."""
    robot = load_robot("rx60")
    log = read_log(data_root / "cases" / "p02" / "train.npz", robot.joints)
    with pytest.raises(InputError, match="encoder_scale: .* in revolutions"):
        checked(replace(log, q=log.q / TURN, dq=None), robot, Filtering())


def test_one_joint_in_revolutions_is_told(arm, log):
    finding, *_ = found(arm, replace(log, q=log.q / np.array([1, 1, TURN, 1, 1, 1])))
    assert "the position of joint3 is in revolutions" in finding.what
    assert "scale = [1, 1, 6.283185, 1, 1, 1]" in finding.remedy


@pytest.mark.parametrize("turning", [1.0, 180.0 / np.pi])
def test_a_slide_in_millimeters_is_told_where_no_torque_tells_it(data_root, turning):
    """A spindle along the axes that turn: its position changes nothing but its own friction."""
    robot = load_robot(data_root / "cases" / "q03" / "robot.urdf")
    log = read_log(data_root / "cases" / "q03" / "train.npz", robot.joints)
    slides = np.array([kind == "prismatic" for kind in robot.kinds])
    wrong = replace(log, q=log.q * np.where(slides, 1e3, turning), dq=None)
    with pytest.raises(InputError, match="encoder_scale: .* in millimeters"):
        checked(wrong, robot, Filtering())


def test_a_long_slide_of_a_speed_that_exists_is_not_refused(data_root):
    """An axis that carries an arm along a hall may travel 20 m."""
    robot = load_robot("emps")
    path = data_root / "data" / "emps" / "train.npz"
    log = read_log(path, robot.joints, np.asarray(robot.drive_gain))
    after, _ = checked(replace(log, q=100.0 * log.q, dq=None), robot, Filtering())
    assert not any(note.startswith("encoder_scale: ") for note in after.notes)


def test_turns_that_no_arm_makes_are_degrees_for_less(arm, log):
    _, motions = prepare_segments(replace(log, q=100.0 * log.q), Filtering(torque_cutoff=5.0))
    samples = samples_of(motions)
    near = replace(samples, q=1e-2 * samples.q)
    (degrees,), (usual,) = (
        [g for g in position_unit_guesses(arm, Rough(arm, s), True) if "degrees" in g.what]
        for s in (samples, near)
    )
    logged, less = (Tried(np.full(6, left), np.ones(6)) for left in (0.3, 0.28))
    assert _believed(degrees, less, logged, 1.0)
    assert not _believed(usual, less, logged, 1.0)


@pytest.mark.parametrize(("travel", "asked"), [(0.9, False), (1.1, True)])
def test_no_unit_is_asked_of_which_a_log_moves_by_a_fraction(arm, log, travel, asked):
    """Slides that went 0.1 and 0.3 m, of which weak motion told little, were called millimeters."""
    _, motions = prepare_segments(log, Filtering(torque_cutoff=5.0))
    samples = samples_of(motions)
    near = replace(samples, q=samples.q * travel / np.ptp(samples.q, axis=0).max())
    told = [g.what for g in position_unit_guesses(arm, Rough(arm, near), True)]
    assert any("degrees" in what for what in told) == asked
    assert any("revolutions" in what for what in told)
