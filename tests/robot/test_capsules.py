"""Capsules: what they cover, which links they belong to, and their distances, against another program."""

import jax.numpy as jnp
import numpy as np
import pytest

from jaxswarm.robot import load_robot
from jaxswarm.robot.build import build_description
from jaxswarm.robot.capsules import (
    BASE,
    capsules_of,
    distances,
    pairs_of_links,
    segment_distance,
)
from jaxswarm.robot.load import describe_robot
from jaxswarm.robot.urdf import describe_urdf

SHAPES = """<robot name="r">
<link name="base"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
<link name="upper"><inertial><mass value="1"/></inertial>
 <collision><origin xyz="0.2 0 0" rpy="0 1.5707963267948966 0"/>
  <geometry><cylinder radius="0.03" length="0.4"/></geometry></collision></link>
<link name="tip"><visual><geometry><box size="0.1 0.6 0.2"/></geometry></visual>
 <collision><geometry><mesh filename="package://a/b.stl"/></geometry></collision></link>
<link name="flange"><collision><geometry><box size="0.1 0.6 0.2"/></geometry></collision></link>
<joint name="a" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 0.5"/>
 <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="40" velocity="2"/></joint>
<joint name="b" type="revolute"><parent link="upper"/><child link="tip"/><origin xyz="0.4 0 0"/>
 <axis xyz="0 1 0"/><limit lower="-3" upper="3" effort="0" velocity="2"/></joint>
<joint name="f" type="fixed"><parent link="tip"/><child link="flange"/><origin xyz="0 0 1"/></joint>
</robot>"""


def test_segments_are_as_far_apart_as_another_program_says():
    coal = pytest.importorskip("coal")
    rng = np.random.default_rng(0)
    ends = rng.normal(size=(4, 60, 3))
    ends[1, :10] = ends[0, :10]  # points
    ends[3, 5:15] = ends[2, 5:15]
    ends[3, 15:25] = ends[2, 15:25] + 0.7 * (ends[1] - ends[0])[15:25]  # parallel
    found = np.asarray(segment_distance(*map(jnp.asarray, ends)))
    for k in range(60):
        bodies = []
        for start, end in (ends[:2, k], ends[2:, k]):
            along = end - start
            length = np.linalg.norm(along)
            turn = np.eye(3)
            if length > 0:
                turn = np.linalg.qr(np.column_stack([along, rng.normal(size=(3, 2))]))[0]
                turn = np.column_stack([turn[:, 1], turn[:, 2], along / length])
                turn[:, 0] *= np.sign(np.linalg.det(turn))
            place = coal.Transform3s(turn, 0.5 * (start + end))
            bodies += [coal.Capsule(1e-3, max(length, 1e-9)), place]
        result = coal.DistanceResult()
        coal.distance(*bodies, coal.DistanceRequest(), result)
        assert found[k] == pytest.approx(result.min_distance + 2e-3, abs=2e-5)


def test_shapes_of_a_file_are_covered_and_those_of_meshes_are_not():
    found = capsules_of(describe_urdf(SHAPES, "r.urdf"))
    assert found.link.tolist() == [BASE, 0, 1]
    assert found.without == ()
    # The cylinder lies along x; the flange, fixed one meter above the tip, is along its longest side.
    np.testing.assert_allclose(found.start[1], [0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(found.end[1], [0.4, 0, 0], atol=1e-12)
    np.testing.assert_allclose(sorted([found.start[2, 1], found.end[2, 1]]), [-0.3, 0.3])
    np.testing.assert_allclose([found.start[2, 2], found.end[2, 2]], 1.0)
    np.testing.assert_allclose(found.radius, [0.1, 0.03, np.hypot(0.05, 0.1)])


def test_a_link_without_shapes_has_segments_through_its_joints():
    bare = SHAPES.replace("<sphere", "<ball").replace("<box", "<brick")
    assert capsules_of(describe_urdf(bare, "r.urdf")).without == (BASE, 1)
    found = capsules_of(describe_urdf(bare, "r.urdf"), 0.05)
    assert found.without == () and found.link.tolist() == [BASE, 0, 1]
    np.testing.assert_allclose(found.end[[0, 2]], [[0, 0, 0.5], [0, 0, 1.0]])
    np.testing.assert_allclose(found.radius, [0.05, 0.03, 0.05])


@pytest.mark.parametrize("bad", ['radius="-1"', 'radius="nan"', "", 'radius="a"'])
def test_damaged_shapes_are_none_and_the_robot_is_read(bad):
    text = SHAPES.replace('radius="0.03"', bad)
    described = describe_urdf(text, "r.urdf")
    assert capsules_of(described).without == (0,)
    assert build_description(described).joints == ("a", "b")


def test_neighbors_are_no_pair_and_distances_are_those_of_a_drawing():
    robot = build_description(describe_urdf(SHAPES, "r.urdf"))
    found = capsules_of(describe_urdf(SHAPES, "r.urdf"))
    pairs = pairs_of_links(robot, found)
    assert pairs.tolist() == [[0, 2]]
    # Upper arm level, the flange a meter above or below its end at (0.4, 0, 0.5).
    above = distances(robot, found, pairs, jnp.zeros(2))
    below = distances(robot, found, pairs, jnp.array([0.0, np.pi]))
    thick = 0.1 + np.hypot(0.05, 0.1)
    assert float(above[0]) == pytest.approx(np.hypot(0.4, 1.5) - thick)
    assert float(below[0]) == pytest.approx(np.hypot(0.4, 0.5) - thick)


def test_a_built_in_arm_has_segments():
    found = capsules_of(describe_robot("ur10e"), 0.05)
    robot = load_robot("ur10e")
    lengths = np.linalg.norm(found.end - found.start, axis=1)
    assert set(found.link.tolist()) >= set(range(robot.num_joints))
    assert lengths.max() == pytest.approx(np.linalg.norm(robot.translation, axis=1).max())
