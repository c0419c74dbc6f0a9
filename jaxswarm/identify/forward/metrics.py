"""Errors of a torque prediction: per joint and global, moving and standing apart."""

import numpy as np

# A joint counts as moving above this share of its largest speed in the log.
_MOVING_SHARE = 0.01


def is_moving(dq: np.ndarray) -> np.ndarray:
    """Whether each sample of each joint moves: |dq| above 1 % of the joint's top speed."""
    return moves_at(dq, np.abs(dq).max(axis=0))


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
    scored = np.ones_like(moving) if scored is None else scored
    measured = np.where(scored, measured, 0.0)
    error = np.where(scored, measured - predicted, 0.0)

    def rms(selected: np.ndarray) -> list[float | None]:
        out = []
        for j in range(error.shape[1]):
            part = error[selected[:, j], j]
            out.append(float(np.sqrt(np.mean(part**2))) if part.size else None)
        return out

    def share(top: np.ndarray, bottom: np.ndarray) -> list[float]:
        return [float(a / b) if b > 0 else float("inf") for a, b in zip(top, bottom, strict=True)]

    mean = measured.sum(axis=0) / np.maximum(scored.sum(axis=0), 1)
    deviation = np.abs(np.where(scored, measured - mean, 0.0)).sum(axis=0)
    return {
        "rms": rms(scored),
        "relative": share(np.linalg.norm(error, axis=0), np.linalg.norm(measured, axis=0)),
        "rae": share(np.abs(error).sum(axis=0), deviation),
        "rms_moving": rms(moving & scored),
        "rms_standing": rms(~moving & scored),
        "relative_global": float(np.linalg.norm(error))
        / max(float(np.linalg.norm(measured)), 1e-300),
    }
