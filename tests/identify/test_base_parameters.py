"""Base parameters against numpy's rank, Pinocchio's columns and the known forms of the RX60."""

import numpy as np
import pytest

from jaxswarm.identify.estimation.base_parameters import find_base
from jaxswarm.robot import (
    Joint,
    build_robot,
    emps,
    rx60,
    rx60_paper_parameters,
    standard_parameter_names,
    ur10e,
)
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.placements import rotation_rpy

PAPER = ["Izz1"] + [f"{s}{k}" for k in (2, 3) for s in ("Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")]


def columns_of(robot, samples=40, seed=0):
    motion = np.random.default_rng(seed).normal(size=(3, samples, robot.num_joints))
    full = rigid_columns(robot, *motion)
    return full.reshape(-1, full.shape[2])


def test_what_merges_or_is_dead_leaves_the_torque_as_it_is():
    columns = columns_of(ur10e())
    base = find_base(columns, standard_parameter_names(ur10e()))
    assert base.unfelt.shape == (60, 60 - base.size)
    assert np.linalg.matrix_rank(base.unfelt) == 60 - base.size
    assert np.abs(columns @ base.unfelt).max() < 1e-9 * np.abs(columns).max()


@pytest.fixture(scope="module")
def rx60_columns():
    return columns_of(rx60())


def test_the_papers_thirteen_parameters_have_rank_eleven(rx60_columns):
    names = standard_parameter_names(rx60())
    thirteen = rx60_columns[:, [names.index(p) for p in PAPER]]
    base = find_base(thirteen, tuple(PAPER))
    assert base.size == np.linalg.matrix_rank(thirteen) == 11
    assert base.expressions() == (
        "Izz1 + Iyy2 + Iyy3", "Ixx2 - Iyy2", "Ixy2", "Ixz2", "Iyz2", "Izz2",
        "Ixx3 - Iyy3", "Ixy3", "Ixz3", "Iyz3", "Izz3",
    )  # fmt: skip
    truth = rx60_paper_parameters().ravel()[[names.index(p) for p in PAPER]]
    found = base.reduce(truth)
    assert found[[0, 1, 6]] == pytest.approx([8.7345, -1.1339, -1.0731], abs=1e-12)


@pytest.mark.parametrize(("gravity", "size"), [(0.0, 13), (-9.81, 15)])
def test_all_thirty_parameters_of_the_rx60(gravity, size):
    robot = rx60().replace(gravity=np.array([0.0, 0.0, gravity]))
    matrix = columns_of(robot)
    base = find_base(matrix, standard_parameter_names(robot))
    assert base.size == size == np.linalg.matrix_rank(matrix)
    assert len(base.kept) + len(base.dropped) + len(base.dead) == 30


def test_six_joints_have_thirty_six_base_parameters():
    robot = ur10e()
    matrix = columns_of(robot, 60)
    base = find_base(matrix, standard_parameter_names(robot))
    assert base.size == np.linalg.matrix_rank(matrix / np.linalg.norm(matrix, axis=0).max()) == 36


def test_rank_and_torque_agree_with_pinocchio(rx60_columns):
    pin = pytest.importorskip("pinocchio")
    robot, model, parent = rx60(), pin.Model(), 0
    for j in range(3):
        place = pin.SE3(np.asarray(robot.rotation[j]), np.asarray(robot.translation[j]))
        parent = model.addJoint(parent, pin.JointModelRZ(), place, f"j{j}")
        model.appendBodyToJoint(parent, pin.Inertia.Random(), pin.SE3.Identity())
    model.gravity.linear = np.asarray(robot.gravity)
    motion = np.random.default_rng(0).normal(size=(3, 40, 3))
    data = model.createData()
    theirs = np.concatenate(
        [pin.computeJointTorqueRegressor(model, data, *x) for x in zip(*motion, strict=True)]
    )
    base = find_base(rx60_columns, standard_parameter_names(robot))
    other = find_base(theirs, standard_parameter_names(robot))
    assert base.expressions() == other.expressions()
    np.testing.assert_allclose(base.merge, other.merge, atol=1e-9)


def test_merging_keeps_the_torque(rx60_columns):
    base = find_base(rx60_columns, standard_parameter_names(rx60()))
    theta = np.random.default_rng(1).normal(size=(4, 30))
    again = base.expand(base.reduce(theta))
    np.testing.assert_allclose(again @ rx60_columns.T, theta @ rx60_columns.T, atol=1e-9)
    np.testing.assert_allclose(base.reduce(again), base.reduce(theta), atol=1e-12)


def test_a_slide_has_one_base_parameter():
    base = find_base(columns_of(emps()), standard_parameter_names(emps()))
    assert base.expressions() == ("m1",)
    assert len(base.dead) == 9


def test_scaling_rows_and_columns_changes_no_verdict(rx60_columns):
    names = standard_parameter_names(rx60())
    base = find_base(rx60_columns, names)
    scale = 10.0 ** np.random.default_rng(2).uniform(-3, 3, 30)
    scaled = find_base(1e5 * rx60_columns * scale, names)
    np.testing.assert_array_equal(base.kept, scaled.kept)


def test_factors_and_signs_in_expressions():
    a, b, c = np.eye(3)
    matrix = np.stack([a, b, 0.29 * a - 2.0 * b, c, 0.0 * a], axis=1)
    base = find_base(matrix, ("x:rigid", "y", "z", "w", "v"))
    assert base.expressions() == ("x + 0.29 z", "y - 2 z", "w")
    assert list(base.dropped) == [2]
    assert list(base.dead) == [4]


def test_a_joint_at_rest_leaves_dead_columns():
    motion = np.random.default_rng(3).normal(size=(3, 40, 3))
    motion[:, :, 0] = 0.0
    full = rigid_columns(rx60(), *motion)
    base = find_base(full.reshape(-1, 30), standard_parameter_names(rx60()))
    moving = find_base(columns_of(rx60()), standard_parameter_names(rx60()))
    assert base.size < moving.size
    assert base.size == np.linalg.matrix_rank(full.reshape(-1, 30))
    assert standard_parameter_names(rx60()).index("Izz1") in base.dead


def test_half_a_turn_written_with_nine_digits_is_half_a_turn():
    def scara(half):
        flipped = rotation_rpy([half, 0.0, 0.0])
        return build_robot(
            "scara",
            [
                Joint("a"),
                Joint("b", parent="a", translation=np.array([0.4, 0.0, 0.0])),
                Joint(
                    "c", kind="prismatic", parent="b", rotation=flipped,
                    translation=np.array([0.35, 0.0, 0.0]),
                ),
                Joint("d", parent="c", translation=np.array([0.0, 0.0, 0.05])),
            ],
        )  # fmt: skip

    names = standard_parameter_names(scara(np.pi))
    exact, written = (find_base(columns_of(scara(half)), names) for half in (np.pi, 3.14159265))
    assert written.expressions() == exact.expressions()
    assert not {"mz4", "Ixz4", "Iyz4"} & {names[k] for k in written.kept}
