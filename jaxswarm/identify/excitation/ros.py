"""A planned motion as ROS 2 message ``trajectory_msgs/JointTrajectory`` in YAML, for ``ros2 topic pub``."""

import json
from pathlib import Path

import numpy as np

_NANO = 1_000_000_000


def write_ros(path: Path, joints: tuple[str, ...], t: np.ndarray, motion: tuple) -> None:
    """Write every sample as a point.

    Args:
        path: The file.
        joints: Their names.
        t: Times since the start [s], (T,).
        motion: Position [rad or m], velocity and acceleration, each (T, n).
    """
    keys = ("positions", "velocities", "accelerations")
    with Path(path).open("w", encoding="utf-8", newline="\n") as file:
        file.write("header: {stamp: {sec: 0, nanosec: 0}, frame_id: ''}\n")
        # A JSON string is a YAML string, whatever the name holds.
        file.write(f"joint_names: [{', '.join(json.dumps(joint) for joint in joints)}]\npoints:\n")
        for time, *rows in zip(t, *motion, strict=True):
            sec, nanosec = divmod(round(float(time) * _NANO), _NANO)
            lead = "- "
            for key, row in zip(keys, rows, strict=True):
                # Fixed point: readers of YAML 1.1 take 1e-05 for a word.
                file.write(f"{lead}{key}: [{', '.join(f'{x:.9f}' for x in row)}]\n")
                lead = "  "
            file.write(f"  time_from_start: {{sec: {sec}, nanosec: {nanosec}}}\n")
