"""The one way into the library for a measured log: read, name, check, describe.

file -> Table (format) -> names and units of ours -> Arranged (joints) -> checks -> Log with notes
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.logs.checks import check_time, check_values, drop_repeated_rows, torque
from jaxswarm.logs.columns import Arranged, arrange
from jaxswarm.logs.csv import read_csv
from jaxswarm.logs.findings import describe
from jaxswarm.logs.hdf5 import ENDINGS as HDF5_ENDINGS
from jaxswarm.logs.hdf5 import read_hdf5
from jaxswarm.logs.lerobot import home_of, read_lerobot
from jaxswarm.logs.log import Log
from jaxswarm.logs.mat import read_mat
from jaxswarm.logs.mcap import read_mcap
from jaxswarm.logs.names import QUANTITIES, offer
from jaxswarm.logs.npz import read_npz
from jaxswarm.logs.parquet import read_parquet
from jaxswarm.logs.reading import LogChoice, Reading, reading_of
from jaxswarm.logs.rename import as_ours
from jaxswarm.logs.summary import summarize
from jaxswarm.logs.table import Table

# Files that hold one log, and those in which a part may have to be named.
_READERS: dict[str, Callable[[Path], Table]] = {
    ".csv": read_csv,
    ".npz": read_npz,
    ".parquet": read_parquet,
}
_PARTED: dict[str, Callable[[Path, str | None], Table]] = {
    ".mat": read_mat,
    **dict.fromkeys(HDF5_ENDINGS, read_hdf5),
}
_RECORDINGS = (".mcap", ".db3", ".bag")
LOG_FORMATS = (*_READERS, *_PARTED, *_RECORDINGS)


def read_log(
    path: str | Path | LogChoice,
    joints: tuple[str, ...],
    drive_gain: np.ndarray | None = None,
    *,
    require_torque: bool = True,
    reading: Reading | None = None,
) -> Log:
    """Read and check a log of a robot.

    Args:
        path: A ``.csv``, ``.npz``, ``.parquet``, ``.mat``, ``.h5``, ``.mcap``, ``.db3`` or ``.bag``
            file, the folder of a rosbag2 or of a LeRobot data set; or such a path with how to read it.
        joints: The robot's joint names, n of them; columns are matched to them by name.
        drive_gain: Torque per motor current [N m/A or N/A], shape (n,), NaN where unknown.
        require_torque: Whether a log without ``tau`` or ``current`` is refused.
        reading: Names, units and parts that the file does not tell; None: those that ``path`` carries.

    Returns:
        The log in SI units and in the robot's order of joints, with notes about what was found.

    Raises:
        InputError: If the file cannot be read or its content cannot be used; the message names
            file, row and column, and says what to do.
    """
    reading = reading or reading_of(path)
    joints = tuple(joints)
    return log_of_table(
        as_ours(read_table(Path(path), joints, reading), joints, reading, drive_gain),
        joints,
        drive_gain,
        require_torque=require_torque,
    )


def log_of_table(
    table: Table,
    joints: tuple[str, ...],
    drive_gain: np.ndarray | None,
    *,
    require_torque: bool,
) -> Log:
    """Name, check and describe columns of numbers; arguments and errors of :func:`read_log`."""
    arranged = arrange(table, joints)
    if not len(arranged.t):
        raise InputError(f"{table.source}: no samples. Was the log cut?")
    check_values(table, arranged)
    keep, repeated = drop_repeated_rows(table, arranged)
    rows = np.flatnonzero(keep)
    # A copy of a long log is a large one.
    kept: slice | np.ndarray = slice(None) if keep.all() else keep
    time = arranged.t[kept]
    check_time(table, time, rows)
    others = [name for name in table.columns if name.split("_")[0] not in QUANTITIES]
    tau, torque_notes = torque(
        table, arranged, joints, drive_gain, require_torque, offer("tau", joints[0], 1, others)
    )
    table = replace(table, columns={})  # of a long log they are as large as the log
    log = Log(
        source=table.source,
        joints=joints,
        t=time,
        q=arranged.joint["q"][kept],
        dq=_kept(arranged, "dq", kept),
        ddq=_kept(arranged, "ddq", kept),
        tau=None if tau is None else tau[kept],
        channels=_channels(arranged, kept),
    )
    notes = [*table.notes, *arranged.notes, *([repeated] if repeated else []), *torque_notes]
    return replace(log, notes=(*notes, *describe(summarize(log))))


def read_table(path: Path, joints: tuple[str, ...] | None, reading: Reading) -> Table:
    """Read any supported format; whatever goes wrong inside a parser is an :class:`InputError`."""
    try:
        found = path.exists()
    except OSError as error:
        raise InputError(f"{path}: cannot be reached ({error.strerror}). Check the path.") from None
    if not found:
        raise InputError(f"{path}: no such file.{_neighbors(path)}")
    recording = path.suffix.lower() in _RECORDINGS or (path / "metadata.yaml").is_file()
    if recording and joints is None:
        raise InputError(
            f"{path}: a recording holds many topics; give the robot whose joints it has"
        )
    home = None if recording else home_of(path)
    if path.is_dir() and not recording and home is None:
        raise InputError(
            f"{path}: is a folder without a rosbag2 metadata.yaml or a LeRobot meta/info.json. Give the "
            "log file itself."
        )
    if not path.is_dir() and not path.is_file():
        raise InputError(f"{path}: is no file but a device or a pipe. Give the log file itself.")
    ending = path.suffix.lower()
    if not (recording or home or ending in _READERS or ending in _PARTED):
        raise InputError(
            f"{path}: unknown log format {path.suffix or '(no ending)'}. Known: "
            f"{', '.join(LOG_FORMATS)}."
        )
    home = home if path.is_dir() or ending == ".parquet" else None
    if reading.topic is not None and ending in _READERS and home is None:
        raise InputError(f"{path}: holds one log; leave out --topic {reading.topic}")
    try:
        if recording:
            return read_mcap(path, joints or (), reading.topic)
        if home is not None:
            return read_lerobot(path, home, reading.topic)
        if ending in _PARTED:
            return _PARTED[ending](path, reading.topic)
        return _READERS[ending](path)
    except InputError:
        raise
    except Exception as error:
        # Parsers of foreign formats raise anything on damaged bytes, from KeyError to MemoryError.
        reason = (str(error).splitlines() or [""])[0][:200]
        raise InputError(
            f"{path}: cannot be read as {path.suffix.lstrip('.').upper() or 'rosbag2'} "
            f"({type(error).__name__}: {reason}). Write the file again, or check its ending."
        ) from error


def _neighbors(path: Path) -> str:
    """Offer files of a similar name in the same folder."""
    try:
        names = [
            other.name for other in path.parent.iterdir() if other.suffix.lower() in LOG_FORMATS
        ]
    except OSError:
        return f" The folder {path.parent} cannot be listed."
    return f" {nearest(path.name, names)}" if 0 < len(names) <= 20 else ""


def _kept(arranged: Arranged, name: str, keep: np.ndarray | slice) -> np.ndarray | None:
    return arranged.joint[name][keep] if name in arranged.joint else None


def _channels(arranged: Arranged, keep: np.ndarray | slice) -> dict[str, np.ndarray]:
    """Everything that is not q, dq, ddq or tau; currents stay, for effects that use them."""
    channels = {**arranged.joint, **arranged.shared}
    return {
        name: values[keep]
        for name, values in channels.items()
        if name not in ("q", "dq", "ddq", "tau")
    }
