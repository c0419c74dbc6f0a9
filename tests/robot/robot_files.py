"""Robot files as text: what public descriptions hold, in small."""


def inertial(mass, xyz="0 0 0", i=0.1):
    return (
        f'<inertial><origin xyz="{xyz}" rpy="0.1 0 0"/><mass value="{mass}"/><inertia ixx="{i}" '
        f'ixy="0" ixz="0" iyy="{i}" iyz="0.01" izz="{i}"/></inertial>'
    )


def link(name, mass=1.0, xyz="0.01 0.02 0.03", more=""):
    return f'<link name="{name}">{inertial(mass, xyz)}{more}</link>'


def joint(name, parent, child, kind="revolute", xyz="0 0 0.3", rpy="0 0 0", axis="0 0 1", more=""):
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="{xyz}" rpy="{rpy}"/>'
        f'<parent link="{parent}"/><child link="{child}"/><axis xyz="{axis}"/>'
        f'<limit lower="-2.5" upper="2.5" effort="80" velocity="2"/>{more}</joint>'
    )


def gripper_arm(extra=""):
    """Seven joints, a fixed hand and two fingers, the second of which mimics the first."""
    parts = [link("l0", 2.0)]
    for j in range(1, 8):
        rpy = "0 0 0" if j == 1 else f"{'-' if j % 2 == 0 else ''}1.5707963 0 0.1"
        parts += [link(f"l{j}", 3.0 / j), joint(f"j{j}", f"l{j - 1}", f"l{j}", rpy=rpy)]
    parts += [link("hand", 0.7), joint("flange", "l7", "hand", "fixed", "0 0 0.1", "0 0 -0.785")]
    slide = dict(kind="prismatic", xyz="0 0 0.06", axis="0 1 0")
    mimic = '<mimic joint="finger1" multiplier="-1" offset="0.01"/>'
    parts += [link("f1", 0.1), joint("finger1", "hand", "f1", **slide)]
    parts += [link("f2", 0.1), joint("finger2", "hand", "f2", **slide, more=mimic)]
    return f'<robot name="gripper_arm">{"".join(parts)}{extra}</robot>'


FOREIGN = (
    '<drake:diagonal a="1"/><transmission name="t"><type>x</type><joint name="j1">'
    "<hardwareInterface>e</hardwareInterface></joint><actuator name='m'/></transmission>"
    '<gazebo reference="l1"><mu1>nan</mu1></gazebo>'
    '<material name="m"><texture/><color rgba="a b"/></material>'
)

TREE = (
    '<robot name="tree">'
    + link("base", 5.0)
    + link("left", 2.0)
    + link("left_tip", 0.5)
    + link("right", 1.5)
    + link("slide", 0.8)
    + joint("left_joint", "base", "left", xyz="0 0.2 0.5", axis="0 1 0")
    + joint("left_wrist", "left", "left_tip", "continuous", axis="1 1 0")
    + joint("right_joint", "base", "right", xyz="0 -0.2 0.5", rpy="0.3 0 1")
    + joint("right_slide", "right", "slide", "prismatic", axis="0 0.6 0.8")
    + "</robot>"
)

TABLE = """
name = "two"
gravity = [0, 0, -9.81]
drive_gain = [10, 20]
[dh]
convention = "modified"
alpha = [0, 0.5]
a = [0, 0.5]
d = [0.1, 0]
theta = [0, 0.1]
kinds = ["revolute", "prismatic"]
joints = ["a", "b"]
base_rpy = [0, 0, 1]
parameters = [[1, 0, 0, 0, 1, 0, 1, 0, 0, 1], [1, 0, 0, 0, 1, 0, 1, 0, 0, 1]]
"""
BLOCKS = """
name = "blocks"
[[joint]]
name = "lift"
kind = "prismatic"
axis = "z"
[[joint]]
name = "turn"
parent = "lift"
xyz = [0, 0, 0.3]
rpy = [0, 1.5, 0]
axis = [0, 2, 0]
parameters = [1, 0, 0, 0, 1, 0, 1, 0, 0, 1]
[[joint]]
name = "flange"
kind = "fixed"
"""
