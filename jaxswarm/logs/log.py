"""What every reader returns: one log of one robot, in SI units, joints in the robot's own order.

A log is plain numpy on the host. Whatever the file looked like, here the columns are named, sorted
and float64; currents are already torques (``tau = drive_gain * current``). Quantities with one
value per joint have shape (T, n), channels without a joint have shape (T,).
"""

from dataclasses import dataclass, field, replace

import numpy as np

from jaxswarm.logs.finding import Finding


@dataclass(frozen=True, eq=False)
class Log:
    """Samples of a moving robot.

    Attributes:
        source: File it came from, or a description.
        joints: Joint names in the robot's order, n of them.
        t: Time stamps [s], shape (T,), strictly increasing, not necessarily uniform.
        q: Positions [rad or m], shape (T, n).
        dq: Velocities [rad/s or m/s], shape (T, n), or None if not logged.
        ddq: Accelerations [rad/s^2 or m/s^2], shape (T, n), or None if not logged.
        tau: Motor torques [N m or N], shape (T, n), or None if not logged.
        channels: Anything else: (T, n) with NaN where a joint has none, or (T,) if it has no joint.
        notes: Plain sentences about what was found while reading.
        findings: What checks against the robot found wrong with it; their sentences are among the notes.

    Raises:
        ValueError: If a shape does not fit ``t`` and ``joints``.

    >>> log = Log("demo", ("joint1",), np.arange(3.0), np.zeros((3, 1)))
    >>> log
    Log('demo', 3 samples of 1 joint: t, q)
    """

    source: str
    joints: tuple[str, ...]
    t: np.ndarray
    q: np.ndarray
    dq: np.ndarray | None = None
    ddq: np.ndarray | None = None
    tau: np.ndarray | None = None
    channels: dict[str, np.ndarray] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()

    def __post_init__(self) -> None:
        if self.t.ndim != 1:
            raise ValueError(f"t has shape {self.t.shape}, expected (T,)")
        expected = (len(self.t), len(self.joints))
        for name in ("q", "dq", "ddq", "tau"):
            values = getattr(self, name)
            if values is not None and values.shape != expected:
                raise ValueError(f"{name} has shape {values.shape}, expected (T, n) = {expected}")
        for name, values in self.channels.items():
            if values.shape not in (expected, expected[:1]):
                raise ValueError(
                    f"channel {name} has shape {values.shape}, expected {expected} or (T,)"
                )

    def __repr__(self) -> str:
        size = f"{len(self.t)} samples of {len(self.joints)} joint{'s' * (len(self.joints) != 1)}"
        given = [name for name in ("q", "dq", "ddq", "tau") if getattr(self, name) is not None]
        content = ", ".join(["t", *given, *self.channels])
        return f"Log({self.source!r}, {size}: {content})"


def take(log: Log, rows: slice | np.ndarray) -> Log:
    """Keep the samples ``rows`` (a slice, a mask (T,) or indices, increasing) of a log.

    >>> log = Log("demo", ("joint1",), np.arange(3.0), np.zeros((3, 1)))
    >>> take(log, slice(1, None)).t
    array([1., 2.])
    """

    def keep(values: np.ndarray | None) -> np.ndarray | None:
        return None if values is None else values[rows]

    return replace(
        log,
        t=log.t[rows],
        q=log.q[rows],
        dq=keep(log.dq),
        ddq=keep(log.ddq),
        tau=keep(log.tau),
        channels={name: values[rows] for name, values in log.channels.items()},
    )
