"""Errors of a torque prediction: per joint and global, moving and standing apart."""

import numpy as np

# A joint counts as moving above this share of its largest speed in the log.
_MOVING_SHARE = 0.01


def is_moving(dq: np.ndarray) -> np.ndarray:
    """Whether each sample of each joint moves: |dq| above 1 % of the joint's top speed."""
    return moves_at(dq, np.abs(dq).max(axis=0))


def slow_speed(dq: np.ndarray) -> np.ndarray:
    """The speed (n,) up to which a joint hardly moves."""
    return _MOVING_SHARE * np.abs(dq).max(axis=0)


def moves_at(dq: np.ndarray, top: np.ndarray) -> np.ndarray:
    """The same by top speeds (n,) of several logs."""
    return np.abs(dq) > _MOVING_SHARE * np.maximum(top, 1e-12)


def torque_errors(
    measured: np.ndarray,
    predicted: np.ndarray,
    moving: np.ndarray,
    scored: np.ndarray | None = None,
) -> dict:
    """Compare two torques of shape (T, n), where ``scored`` (T, n) says so; None: everywhere.

    Returns:
        ``rms`` [N m or N], ``relative`` (norm of the error over norm of the torque), ``rae`` (sum of
        absolute errors over sum of absolute deviations from the mean), ``rms_moving`` and
        ``rms_standing`` (None where there is no such sample), lists over joints, and
        ``relative_global``, the same ratio over all joints at once.

    >>> e = torque_errors(np.array([[1.0], [3.0]]), np.array([[1.0], [2.0]]), np.ones((2, 1), bool))
    >>> round(e["relative"][0], 4), e["rae"][0], e["rms_standing"][0]
    (0.3162, 0.5, None)
    """
    joints = measured.shape[1]
    # A joint at a time: of a long log whole copies are as large as all else.
    told = [
        _joint_errors(
            measured[:, j], predicted[:, j], moving[:, j], None if scored is None else scored[:, j]
        )
        for j in range(joints)
    ]
    error, size = (float(np.linalg.norm([own[key] for own in told])) for key in ("error", "torque"))
    names = ("rms", "relative", "rae", "rms_moving", "rms_standing")
    return {name: [own[name] for own in told] for name in names} | {
        "relative_global": error / max(size, 1e-300)
    }


def _joint_errors(
    measured: np.ndarray, predicted: np.ndarray, moving: np.ndarray, scored: np.ndarray | None
) -> dict:
    """The errors of one joint, by the names of :func:`torque_errors`, and the norms of error and torque."""
    if scored is not None:
        measured, predicted, moving = measured[scored], predicted[scored], moving[scored]
    error = measured - predicted

    def rms(part: np.ndarray) -> float | None:
        return float(np.sqrt(np.mean(part**2))) if part.size else None

    def share(top: float, bottom: float) -> float:
        return float(top / bottom) if bottom > 0 else float("inf")

    norms = float(np.linalg.norm(error)), float(np.linalg.norm(measured))
    mean = measured.sum() / max(len(measured), 1)
    return {
        "error": norms[0],
        "torque": norms[1],
        "rms": rms(error),
        "relative": share(*norms),
        "rae": share(np.abs(error).sum(), np.abs(measured - mean).sum()),
        "rms_moving": rms(error[moving]),
        "rms_standing": rms(error[~moving]),
    }
