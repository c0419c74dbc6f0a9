"""A log from arrays: the checks of :func:`jaxswarm.logs.read_log` without a file."""

from collections.abc import Mapping

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.log import Log
from jaxswarm.logs.read import log_of_table
from jaxswarm.logs.table import Table, as_numbers


def log_from_arrays(
    t: np.ndarray,
    q: np.ndarray,
    tau: np.ndarray | None = None,
    *,
    dq: np.ndarray | None = None,
    ddq: np.ndarray | None = None,
    current: np.ndarray | None = None,
    channels: Mapping[str, np.ndarray] | None = None,
    joints: tuple[str, ...] | None = None,
    drive_gain: np.ndarray | None = None,
    require_torque: bool = True,
    source: str = "arrays",
) -> Log:
    """Build a checked log from arrays.

    Args:
        t: Time stamps [s], shape (T,), increasing.
        q: Positions [rad or m], shape (T, n), or (T,) for one joint.
        tau: Motor torques [N m or N], shaped as ``q``.
        dq, ddq: Velocities and accelerations, shaped as ``q``.
        current: Motor currents [A] in place of ``tau``, for a robot with drive gains.
        channels: Further channels by name, (T, n) or (T,).
        joints: Names of the joints in the order of the columns; default ``joint1``, ...
        drive_gain: Torque per current [N m/A or N/A], shape (n,), NaN where unknown.
        require_torque: Whether arrays without ``tau`` or ``current`` are refused.
        source: What messages call these data.

    Raises:
        InputError: If an array cannot be used; the message names it, the row, and what to do.

    >>> t = np.arange(100) * 0.01
    >>> log_from_arrays(t, np.sin(t), np.cos(t))
    Log('arrays', 100 samples of 1 joint: t, q, tau)
    """
    given = {"t": t, "q": q, "tau": tau, "dq": dq, "ddq": ddq, "current": current}
    given.update(channels or {})
    columns = {name: _numbers(name, x, source) for name, x in given.items() if x is not None}
    if joints is None:
        width = columns["q"].shape[1] if columns["q"].ndim == 2 else 1
        joints = tuple(f"joint{k + 1}" for k in range(width))
    table = Table(source, columns)
    return log_of_table(table, tuple(joints), drive_gain, require_torque=require_torque)


def _numbers(name: str, values, source: str) -> np.ndarray:
    try:
        array = as_numbers(np.array(values))  # the log has its own
    except (ValueError, TypeError) as error:
        raise InputError(
            f"{source}: {name} is no array ({error}). Give one row a sample."
        ) from None
    if array is None:
        raise InputError(
            f"{source}: {name} holds {np.asarray(values).dtype}, not real numbers. Convert it."
        )
    return array
