"""MCAP and rosbag recordings: one topic of ``sensor_msgs/JointState``, joints found by name.

Positions are q, velocities dq, efforts tau [N m or N, as ROS defines them]. Time is that of the
headers, counted from the first one in integer nanoseconds, so that no digits are lost to the size
of an epoch time.
"""

from pathlib import Path

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.bounds import refuse_large
from jaxswarm.logs.mcap_size import unpacked_size
from jaxswarm.logs.table import Table

_JOINT_STATE = "sensor_msgs/msg/JointState"
_FIELDS = {"q": "position", "dq": "velocity", "tau": "effort"}


def read_mcap(path: Path, joints: tuple[str, ...]) -> Table:
    """Read the joint states of a recording into a table of arrays.

    Args:
        path: An ``.mcap``, ``.db3`` or ``.bag`` file, or the folder of a rosbag2 with its metadata.
        joints: The robot's joint names; further joints of the messages are left out.

    Returns:
        The table with arrays in the order of ``joints``.

    Raises:
        InputError: If rosbags is missing, or there is no topic with all joints.
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
        topics: dict[str, list] = {connection.topic: [] for connection in connections}
        for connection, stamp, raw in reader.messages(connections) if connections else ():
            taken += len(raw)  # what other formats unpack to is seen only on the way
            refuse_large(path, taken)
            topics[connection.topic].append((stamp, reader.deserialize(raw, connection.msgtype)))
        others = sorted({connection.topic for connection in reader.connections})
    if not topics:
        raise InputError(
            f"{path}: no topic of {_JOINT_STATE}, only {', '.join(others) or 'none'}. Record "
            "/joint_states."
        )
    topic, messages, notes = _choose(path, topics, joints)
    time, order = _stamps(messages, notes)
    columns = {"t": time}
    for name, field in _FIELDS.items():
        values = _values(path, topic, messages, field, joints)
        if values is not None:
            columns[name] = values[order]
    if "q" not in columns:
        raise InputError(
            f"{path}: the messages of {topic} carry no positions. Log the positions of the joints."
        )
    return Table(str(path), columns, joints, notes=tuple(notes))


def _choose(
    path: Path, topics: dict[str, list], joints: tuple[str, ...]
) -> tuple[str, list, list[str]]:
    """The topic with most messages that name every joint, those with efforts first."""
    complete = {
        topic: [item for item in messages if set(joints) <= set(item[1].name)]
        for topic, messages in topics.items()
    }
    topic = max(
        complete,
        key=lambda name: (any(len(m.effort) for _, m in complete[name]), len(complete[name])),
    )
    if not complete[topic]:
        found = sorted(
            {name for messages in topics.values() for _, m in messages for name in m.name}
        )
        raise InputError(
            f"{path}: no message names all joints of the robot ({', '.join(joints)}); the "
            f"recording has {', '.join(found) or 'none'}. Use the robot's joint names."
        )
    notes = []
    if len(topics) > 1:
        notes.append(
            f"Joint states are those of topic {topic}; also recorded: "
            f"{', '.join(sorted(set(topics) - {topic}))}."
        )
    skipped = len(topics[topic]) - len(complete[topic])
    if skipped:
        notes.append(f"Left out: {skipped} of the messages of {topic}, without some of the joints.")
    extra = sorted({name for _, m in complete[topic] for name in m.name} - set(joints))
    if extra:
        notes.append(
            "Joints of the recording that the robot does not have were left out: "
            f"{', '.join(extra)}."
        )
    return topic, complete[topic], notes


def _stamps(messages: list, notes: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Increasing seconds from the first stamp, and the order of messages that makes them so."""
    stamps = np.array(
        [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for _, m in messages], dtype=np.int64
    )
    if not stamps.any():
        stamps = np.array([received for received, _ in messages], dtype=np.int64)
        notes.append(
            "The headers carry no time; the times at which the messages were recorded are used."
        )
    late = int(np.sum(np.diff(stamps) < 0))
    if late:
        notes.append(f"The messages were sorted by their stamps: {late} came out of order.")
    order = np.argsort(stamps, kind="stable")
    start = int(stamps[order[0]])
    notes.append(f"Time counts from the first stamp, {start // 10**9}.{start % 10**9:09d} s.")
    return (stamps[order] - start) * 1e-9, order


def _values(
    path: Path, topic: str, messages: list, field: str, joints: tuple[str, ...]
) -> np.ndarray | None:
    """One field of all messages, (T, n) in the order of ``joints``; None if always empty."""
    rows = [np.asarray(getattr(message, field), dtype=np.float64) for _, message in messages]
    if not any(row.size for row in rows):
        return None
    picked = np.empty((len(rows), len(joints)))
    for index, (row, (_, message)) in enumerate(zip(rows, messages, strict=True)):
        names = list(message.name)
        if row.size != len(names):
            raise InputError(
                f"{path}: message {index + 1} of {topic} has {row.size} values of {field} for "
                f"{len(names)} joints. Cut the recording there."
            )
        picked[index] = row[[names.index(joint) for joint in joints]]
    return picked
