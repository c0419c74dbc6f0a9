"""SDF with every way to place a frame, against Pinocchio models built from the same poses, and Drake."""

import numpy as np
import pinocchio as pin
import pytest

from jaxswarm.errors import InputError
from jaxswarm.robot import inverse_dynamics, load_robot
from jaxswarm.robot.placements import rotation_rpy
from jaxswarm.robot.sdf import describe_sdf

N = 4


def words(values):
    return " ".join(f"{float(v):.17g}" for v in np.ravel(values))


def pose_of(values):
    return pin.SE3(rotation_rpy(values[3:]), values[:3])


def values_of(pose):
    return np.concatenate([pose.translation, pin.rpy.matrixToRpy(pose.rotation)])


def random_sdf(seed, version="1.9"):
    """A chain whose links, joints, inertias and axes all stand askew, and the same built in Pinocchio."""
    rng = np.random.default_rng(seed)
    frame = pose_of(rng.normal(size=6))
    base = pose_of(rng.normal(size=6))
    text = [
        f'<sdf version="{version}"><world name="w"><gravity>0.3 -0.2 -9.7</gravity><model name="arm">'
    ]
    text += [f"<pose>{words(values_of(base))}</pose>"]
    text += [f'<frame name="mark"><pose>{words(values_of(frame))}</pose></frame>']
    model = pin.Model()
    model.gravity.linear = np.array([0.3, -0.2, -9.7])
    above, before, link_before = 0, base.inverse(), None
    for k in range(N):
        link, in_link = pose_of(rng.normal(size=6)), pose_of(0.3 * rng.normal(size=6))
        joint = link * in_link
        axis = rng.normal(size=3)
        mass, center = rng.uniform(1, 3), pose_of(0.2 * rng.normal(size=6))
        spread = rng.normal(size=(3, 3)) * 0.2
        second = spread @ spread.T
        inertia = np.trace(second) * np.eye(3) - second
        six = {f"i{'xyz'[r]}{'xyz'[c]}": inertia[r, c] for r in range(3) for c in range(r, 3)}
        where = [
            f"<pose>{words(values_of(link))}</pose>",
            f'<pose relative_to="mark">{words(values_of(frame.inverse() * link))}</pose>',
            f'<pose relative_to="l{k - 1}" degrees="true">'
            + words(turned(values_of((link_before or pin.SE3.Identity()).inverse() * link)))
            + "</pose>",
            f'<pose rotation_format="quat_xyzw">{words(pin.SE3ToXYZQUAT(link))}</pose>',
        ][k % 4]
        text.append(
            f'<link name="l{k}">{where}<inertial><pose>{words(values_of(center))}</pose><mass>{mass:.17g}'
            f"</mass><inertia>{''.join(f'<{n}>{v:.17g}</{n}>' for n, v in six.items())}</inertia>"
            "</inertial></link>"
        )
        askew = k % 2 == 0
        shown = frame.rotation.T @ joint.rotation @ axis if askew else axis
        seen_from = ' expressed_in="mark"' if askew else ""
        kind = "prismatic" if k == 2 else "revolute"
        parent = "world" if k == 0 else f"l{k - 1}"
        text.append(
            f'<joint name="j{k}" type="{kind}"><pose>{words(values_of(in_link))}</pose>'
            f"<parent>{parent}</parent><child>l{k}</child><axis>"
            f"<xyz{seen_from}>{words(shown)}</xyz>"
            "<limit><lower>-1e16</lower><upper>2.5</upper><velocity>-1</velocity></limit></axis></joint>"
        )
        unit = axis / np.linalg.norm(axis)
        make = pin.JointModelPrismaticUnaligned if k == 2 else pin.JointModelRevoluteUnaligned
        above = model.addJoint(above, make(unit), before.inverse() * joint, f"j{k}")
        body = pin.Inertia(mass, np.zeros(3), inertia)
        model.appendBodyToJoint(above, body, in_link.inverse() * center)
        before, link_before = joint, link
    return "".join(text) + "</model></world></sdf>", model


def turned(values):
    return np.concatenate([values[:3], np.rad2deg(values[3:])])


def same(path, model, seed):
    robot = load_robot(path)
    q, dq, ddq = np.random.default_rng(seed).normal(size=(3, N))
    tau = pin.rnea(model, model.createData(), q, dq, ddq)
    np.testing.assert_allclose(inverse_dynamics(robot, q, dq, ddq), tau, rtol=1e-9, atol=1e-9)
    return robot


@pytest.mark.parametrize("seed", range(5))
def test_torques_are_those_of_the_same_arm_in_pinocchio(tmp_path, seed):
    text, model = random_sdf(seed)
    path = tmp_path / "arm.sdf"
    path.write_text(text)
    robot = same(path, model, seed)
    assert robot.kinds == ("revolute", "revolute", "prismatic", "revolute")
    limits = describe_sdf(text, "arm").joints[0].limits
    assert np.isnan(limits.lower) and limits.upper == 2.5 and np.isnan(limits.velocity)


def test_torques_are_those_of_drake(tmp_path):
    multibody = pytest.importorskip("pydrake.multibody.all")
    text, _ = random_sdf(7)
    (tmp_path / "arm.sdf").write_text(text)
    plant = multibody.MultibodyPlant(0.0)
    multibody.Parser(plant).AddModels(str(tmp_path / "arm.sdf"))
    plant.mutable_gravity_field().set_gravity_vector([0.3, -0.2, -9.7])  # it passes the file's over
    plant.Finalize()
    context = plant.CreateDefaultContext()
    q, dq, ddq = np.random.default_rng(7).normal(size=(3, N))
    plant.SetPositions(context, q)
    plant.SetVelocities(context, dq)
    forces = multibody.MultibodyForces(plant)
    plant.CalcForceElementsContribution(context, forces)
    tau = plant.CalcInverseDynamics(context, ddq, forces)
    robot = load_robot(tmp_path / "arm.sdf")
    np.testing.assert_allclose(inverse_dynamics(robot, q, dq, ddq), tau, rtol=1e-9, atol=1e-9)


def test_a_link_that_hangs_on_nothing_is_the_base(tmp_path):
    path = tmp_path / "arm.sdf"
    path.write_text(SMALL.format(parent="base", more='<link name="base"/>'))
    robot = load_robot(path)
    assert robot.joints == ("j",) and any("taken as the base" in note for note in robot.notes)


SMALL = """<sdf version="1.7"><model name="m">{more}<link name="tip"><inertial><mass>2</mass></inertial>
</link><joint name="j" type="revolute"><parent>{parent}</parent><child>tip</child>
<axis><xyz>0 0 1</xyz><dynamics><damping>0.5</damping></dynamics></axis></joint></model></sdf>"""


def test_axes_of_old_files_stand_in_the_frame_of_the_model(tmp_path):
    pose = "<pose>0 0 0 0 1.5707963267948966 0</pose>"
    old = SMALL.format(parent="world", more="").replace(
        '<link name="tip">', f'<link name="tip">{pose}'
    )
    new = describe_sdf(old, "new").joints[0].axis
    np.testing.assert_allclose(new, [0, 0, 1], atol=1e-12)
    older = describe_sdf(old.replace('version="1.7"', 'version="1.4"'), "old").joints[0].axis
    np.testing.assert_allclose(older, [-1, 0, 0], atol=1e-12)


def test_what_is_no_part_of_the_links_is_told(tmp_path):
    (tmp_path / "arm.sdf").write_text(SMALL.format(parent="world", more="<plugin/>"))
    notes = " ".join(load_robot(tmp_path / "arm.sdf").notes)
    assert "damping is not part of the links (j 0.5)" in notes and "not read: <plugin>" in notes


@pytest.mark.parametrize(
    ("more", "parent", "what"),
    [
        ("", "nowhere", "names link 'nowhere' as its parent"),
        ('<link name="a"/><link name="b"/>', "a", "hang on no joint"),
        ("<include><uri>model://x</uri></include>", "world", "another model"),
        ('<frame name="f"><pose relative_to="g"/></frame>', "world", None),
        ('<link name="tip"/>', "world", "'tip' occurs twice"),
    ],
)
def test_what_cannot_be_read_is_refused_by_name(tmp_path, more, parent, what):
    path = tmp_path / "arm.sdf"
    path.write_text(SMALL.format(more=more, parent=parent))
    if what is None:  # a frame that nothing needs may be broken
        assert load_robot(path).joints == ("j",)
        return
    with pytest.raises(InputError) as caught:
        load_robot(path)
    assert what in str(caught.value) and "arm.sdf" in str(caught.value)


def test_frames_relative_to_each_other_are_refused(tmp_path):
    text = SMALL.format(parent="world", more='<frame name="f"><pose relative_to="g"/></frame>'
                        '<frame name="g"><pose relative_to="f"/></frame>')  # fmt: skip
    text = text.replace("<xyz>", '<xyz expressed_in="f">')
    with pytest.raises(InputError, match="relative to itself"):
        describe_sdf(text, "arm")
