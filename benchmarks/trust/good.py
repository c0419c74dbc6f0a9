"""Files that are right: logs of a two-joint arm in every format, robots, limits, models, results."""

from functools import cache
from pathlib import Path

import numpy as np

from jaxswarm.identify.synthetic import random_links, synthetic_log
from jaxswarm.robot import robot_from_dh

JOINTS = ("joint1", "joint2")
RATE, SECONDS = 100.0, 4.0
STATE = "sensor_msgs/msg/JointState"

TOML = """
name = "small"
gravity = [0, 0, -9.81]
drive_gain = [10, 20]
[dh]
convention = "modified"
alpha = [1.5707963, 0.3]
a = [0, 0.35]
d = [0, 0.1]
theta = [0, 0]
kinds = ["revolute", "revolute"]
joints = ["joint1", "joint2"]
"""
TREE = """
name = "blocks"
[[joint]]
name = "joint1"
kind = "prismatic"
axis = "z"
[[joint]]
name = "joint2"
parent = "joint1"
xyz = [0, 0, 0.3]
rpy = [0, 1.5, 0]
axis = [0, 2, 0]
parameters = [1, 0, 0, 0, 1, 0, 1, 0, 0, 1]
[[joint]]
name = "flange"
kind = "fixed"
"""
LIMITS = """
fundamental = 0.2
harmonics = 3
rate = 100
[joint1]
position = [-2.0, 2.0]
velocity = 1.5
acceleration = 4.0
[joint2]
position = [-1.0, 1.0]
velocity = 2.5
acceleration = 8.0
"""
URDF = """<robot name="arm"><material name="m"><color rgba="1 1 1 1"/></material>
<link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 0.1" rpy="0 0.2 0"/><mass value="2"/>
<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.05"/></inertial></link>
<link name="lower"><inertial><mass value="1"/>
<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.05"/></inertial></link>
<link name="finger"/><link name="hand"/>
<joint name="joint1" type="revolute"><origin xyz="0 0 0.3" rpy="1.57 0 0"/><parent link="base"/>
<child link="upper"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="80" velocity="2"/></joint>
<joint name="joint2" type="continuous"><origin xyz="0.3 0 0"/><parent link="upper"/><child link="lower"/>
<axis xyz="0 1 1"/><dynamics damping="1" friction="0.5"/></joint>
<joint name="slide" type="prismatic"><parent link="lower"/><child link="finger"/><axis xyz="1 0 0"/>
<limit lower="0" upper="0.1" effort="8" velocity="2"/>
<mimic joint="joint2" multiplier="0.1" offset="0"/></joint>
<joint name="flange" type="fixed"><parent link="lower"/><child link="hand"/></joint></robot>"""
MJCF = """<mujoco model="arm"><compiler angle="degree" eulerseq="zyx" autolimits="true"/>
<option gravity="0 0 -9.81"/>
<default><joint axis="0 1 0" armature="0.3"/>
<default class="s"><joint type="slide" ref="0.1"/></default></default>
<worldbody><geom type="plane" size="1 1 1"/><body name="stand" pos="0 0 0.5" euler="10 20 30">
<inertial pos="0 0 0" mass="4" diaginertia="1 1 1"/>
<body name="upper" pos="0 0.1 0.2"><joint name="joint1" axis="0 0 1" range="-90 90" damping="2"/>
<inertial pos="0.1 0 0.2" quat="0.8 0.6 0 0" mass="3" diaginertia="0.03 0.02 0.02"/>
<body name="rail" pos="0.3 0 0" axisangle="1 0 0 40"><joint name="joint2" class="s"/>
<inertial pos="0 0.1 0" mass="0.2" fullinertia="0.02 0.03 0.04 0.001 0.002 0.003"/></body></body></body>
</worldbody></mujoco>"""

SDF = """<sdf version="1.9"><world name="w"><gravity>0 0 -9.8</gravity><model name="arm">
<pose>0 0 0.1 0 0 0.2</pose><frame name="mark"><pose>0.1 0 0 0 0.3 0</pose></frame>
<link name="base"/><link name="upper"><pose relative_to="mark">0 0 0.3 0.1 0 0</pose>
<inertial><pose>0 0 0.1 0 0.2 0</pose><mass>2</mass><inertia><ixx>0.1</ixx><ixy>0</ixy><ixz>0</ixz>
<iyy>0.1</iyy><iyz>0</iyz><izz>0.05</izz></inertia></inertial></link>
<link name="lower"><pose degrees="true" relative_to="upper">0.3 0 0 0 20 0</pose>
<inertial><mass>1</mass></inertial></link><link name="hand"/>
<joint name="joint1" type="revolute"><parent>base</parent><child>upper</child><axis><xyz>0 0 1</xyz>
<limit><lower>-2</lower><upper>2</upper><effort>80</effort></limit></axis></joint>
<joint name="joint2" type="prismatic"><pose>0 0 0.1 0 0 0</pose><parent>upper</parent><child>lower</child>
<axis><xyz expressed_in="mark">0 1 1</xyz><dynamics><damping>2</damping></dynamics></axis></joint>
<joint name="flange" type="fixed"><parent>lower</parent><child>hand</child></joint></model></world></sdf>"""


@cache
def arm():
    """The arm of the logs, with drawn physical links."""
    bare = robot_from_dh(
        "small", convention="modified", alpha=[1.5707963, 0.3], a=[0.0, 0.35], d=[0.0, 0.1]
    )
    return bare.replace(parameters=random_links(bare, np.random.default_rng(0), mass=6.0))


@cache
def columns() -> dict[str, np.ndarray]:
    """A right log as columns by name: time, and q, dq, tau and a temperature of both joints."""
    log = synthetic_log(arm(), (), 1, duration=SECONDS, rate=RATE)
    dq = np.gradient(log.q, log.t, axis=0)
    warm = 25.0 + 0.5 * log.t[:, None] + np.zeros((1, 2))
    parts = {"q": log.q, "dq": dq, "tau": log.tau, "temperature": warm}
    table = {f"{k}_{joint}": v[:, j] for k, v in parts.items() for j, joint in enumerate(JOINTS)}
    return {"t": log.t, **table}


def write_csv(path: Path, table: dict[str, np.ndarray], separator: str = ",") -> Path:
    """Columns as text with one header line; columns of unequal length leave ragged rows."""
    length = max((len(values) for values in table.values()), default=0)
    lines = [separator.join(map(str, table))]
    for row in range(length):
        lines.append(separator.join(_cell(v[row]) for v in table.values() if row < len(v)))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8", errors="surrogatepass")
    return path


def _cell(value) -> str:
    return repr(float(value)) if isinstance(value, float | np.floating) else str(value)


@cache
def model_json() -> str:
    """A model of the arm with effects of several kinds."""
    import tempfile

    from jaxswarm.effects.term import parse_terms
    from jaxswarm.identify import Model, save_model
    from jaxswarm.logs.motion import Filtering

    effects = "viscous_friction,stribeck_friction@joint1,hysteresis@joint2,time_delay"
    terms = parse_terms(effects, arm().joints)
    for term in terms:
        term.values.update(term.law.nominal())
    model = Model(arm(), terms, (0.02, 0.02), Filtering(12.0, 6.0, True), (0.1, 0.2))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.json"
        save_model(model, path)
        return path.read_text()


@cache
def result_json() -> str:
    """What ``identify`` tells of the right log, as ``compare`` reads it."""
    from jaxswarm import log_from_arrays, tasks
    from jaxswarm.outputs import to_json

    table = columns()
    q, tau = (np.stack([table[f"{k}_{j}"] for j in JOINTS], axis=1) for k in ("q", "tau"))
    log = log_from_arrays(table["t"], q, tau, joints=JOINTS)
    return to_json(tasks.identify(log, arm(), "none").content)
