"""Recordings of ROS 2 as drivers make them: one topic or two, joints together or in messages of their own."""

import importlib.util
import shutil
from pathlib import Path

import numpy as np

from jaxswarm.logs import Log, LogChoice, parse_reading

_KIND = "sensor_msgs/msg/JointState"
_START = 1_700_000_000_000_000_000
# What a variant is called, and how it is written.
BAGS = {
    "rosbag2": "one",
    "rosbag2, joints in messages of their own": "split",
    "rosbag2, two topics that would do": "two",
    "rosbag2, two topics, --topic": "two, said",
    "rosbag2, commands beside the measured": "commands",
    "rosbag2, stamps of zero": "unstamped",
    "rosbag2, messages out of order": "shuffled",
    "rosbag2, no efforts": "silent",
}


def have_rosbags() -> bool:
    """Whether recordings can be written here."""
    return importlib.util.find_spec("rosbags") is not None


def written_bag(folder: Path, log: Log, kind: str) -> Path | LogChoice:
    """Write a recording of a kind and give its path, with how to read it where that is said."""
    from rosbags import rosbag2
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    shutil.rmtree(folder, ignore_errors=True)
    stamps = _START + np.round((log.t - log.t[0]) * 1e9).astype(np.int64)

    def message(k: int, joints: list[int], effort: bool = True):
        stamp = 0 if kind == "unstamped" else int(stamps[k])
        time = store.types["builtin_interfaces/msg/Time"](stamp // 10**9, stamp % 10**9)
        header = store.types["std_msgs/msg/Header"](time, "")
        tau = np.asarray(log.tau)[k, joints] if effort else np.zeros(0)
        return store.types[_KIND](
            header, [log.joints[j] for j in joints], log.q[k, joints].copy(), np.zeros(0), tau
        )

    rows, every = range(len(log.t)), list(range(len(log.joints)))
    if kind == "shuffled":
        rows = sorted(rows, key=lambda k: k + 3 * (k % 5 == 0))  # type: ignore[assignment]
    topics = {"/joint_states": [(k, message(k, every, kind != "silent")) for k in rows]}
    if kind == "split":
        parts = (every[:1], every[1:])
        topics = {"/joint_states": [(k, message(k, part)) for k in rows for part in parts]}
    elif kind.startswith("two"):
        topics["/filtered"] = topics["/joint_states"]
    elif kind == "commands":
        topics["/commands"] = [(k, message(k, every, False)) for k in rows]
    with rosbag2.Writer(folder, version=9, storage_plugin=rosbag2.StoragePlugin.MCAP) as writer:
        for topic, messages in topics.items():
            connection = writer.add_connection(topic, _KIND, typestore=store)
            for k, one in messages:
                writer.write(connection, int(stamps[k]), store.serialize_cdr(one, _KIND))
    said = parse_reading(topic="/joint_states")
    return LogChoice(folder, said) if kind == "two, said" else folder
