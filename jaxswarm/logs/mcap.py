"""MCAP and rosbag recordings: topics of ``sensor_msgs/JointState``, joints found by name.

Positions are q, velocities dq, efforts ``effort``: by ROS's definition N m or N, by many drivers currents.
Which topic is meant is asked for where several would do; :mod:`jaxswarm.logs.joint_states` joins messages
that hold some of the joints each. Time is that of the headers, counted from the first one in integer
nanoseconds, so that no digits are lost to the size of an epoch time.
"""

from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.logs.bounds import refuse_large
from jaxswarm.logs.joint_states import State, joined
from jaxswarm.logs.mcap_size import unpacked_size
from jaxswarm.logs.table import Table

_JOINT_STATE = "sensor_msgs/msg/JointState"
_FIELDS = {"q": "position", "dq": "velocity", "effort": "effort"}


def read_mcap(path: Path, joints: tuple[str, ...], topic: str | None = None) -> Table:
    """Read the joint states of a recording into a table of arrays.

    Args:
        path: An ``.mcap``, ``.db3`` or ``.bag`` file, or the folder of a rosbag2 with its metadata.
        joints: The robot's joint names; further joints of the messages are left out.
        topic: Topic to read, or several parted by commas that hold some of the joints each; None: the
            one that will do.

    Returns:
        The table with arrays in the order of ``joints``.

    Raises:
        InputError: If rosbags is missing, no topic has all joints, or several have.
    """
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(
            f"{path}: reading MCAP and rosbag recordings needs rosbags. Install it: pip install "
            "'jaxswarm[formats]'."
        ) from None
    parts = sorted(path.glob("*.mcap")) if path.is_dir() else [path]
    refuse_large(path, sum(unpacked_size(part) for part in parts))
    taken = 0
    with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
        connections = [c for c in reader.connections if c.msgtype == _JOINT_STATE]
        connections = _asked_for(path, connections, topic)
        topics: dict[str, list[State]] = {connection.topic: [] for connection in connections}
        for connection, stamp, raw in reader.messages(connections) if connections else ():
            taken += len(raw)  # what other formats unpack to is seen only on the way
            refuse_large(path, taken)
            message = reader.deserialize(raw, connection.msgtype)
            topics[connection.topic].append(_state(message, stamp))
        others = sorted({connection.topic for connection in reader.connections})
    if not topics:
        raise InputError(
            f"{path}: no topic of {_JOINT_STATE}, only {', '.join(others) or 'none'}. Record "
            "/joint_states."
        )
    chosen, states, notes = _choose(path, topics, joints, pooled=topic is not None)
    time, arrays, told = joined(path, chosen, states, joints)
    if "q" not in arrays:
        raise InputError(
            f"{path}: the messages of {chosen} carry no positions. Log the positions of the joints."
        )
    return Table(str(path), {"t": time, **arrays}, joints, notes=(*notes, *told))


def _asked_for(path: Path, connections: list, topic: str | None) -> list:
    """The connections of the topics that were asked for; all where none was."""
    if topic is None:
        return connections
    known = {connection.topic for connection in connections}
    wanted = [name.strip() for name in topic.split(",")]
    for name in wanted:
        if name not in known:
            raise InputError(
                f"{path}: no topic {name!r} of {_JOINT_STATE}. {nearest(name, known)} (--topic)"
            )
    return [connection for connection in connections if connection.topic in wanted]


def _state(message: Any, received: int) -> State:
    rows = {q: np.asarray(getattr(message, f), dtype=np.float64) for q, f in _FIELDS.items()}
    values = {quantity: row for quantity, row in rows.items() if row.size}
    stamp = message.header.stamp
    nanoseconds = int(stamp.sec) * 10**9 + int(stamp.nanosec)
    return State(nanoseconds, received, tuple(message.name), values)


def _choose(
    path: Path, topics: dict[str, list[State]], joints: tuple[str, ...], pooled: bool
) -> tuple[str, list[State], list[str]]:
    """The topic that holds all joints, with efforts if any does; what is not clear is asked for."""
    if pooled:
        states = [state for states in topics.values() for state in states]
        return ", ".join(topics), states, []
    named = {name: {joint for s in states for joint in s.names} for name, states in topics.items()}
    complete = [name for name in topics if set(joints) <= named[name]]
    if not complete:
        found = sorted(set().union(*named.values()))
        together = f"; together they do: --topic {','.join(topics)}" * (set(joints) <= set(found))
        raise InputError(
            f"{path}: no message names all joints of the robot ({', '.join(joints)}); the "
            f"recording has {', '.join(found) or 'none'}{together}. Use the robot's joint names."
        )
    with_effort = [name for name in complete if any("effort" in s.values for s in topics[name])]
    able = with_effort or complete
    if len(able) > 1:
        raise InputError(
            f"{path}: the topics {', '.join(sorted(able))} hold the joints of the robot"
            f"{' and efforts' * bool(with_effort)}. Say which is the measured one: --topic {able[0]}"
        )
    others = sorted(set(topics) - set(able))
    notes = [f"Joint states are those of topic {able[0]}; also recorded: {', '.join(others)}."]
    return able[0], topics[able[0]], notes if others else []
