"""What wrong encoders say of the true motion: zeros that are off, discs out of true, wrong coupling ratios."""

import numpy as np

from benchmarks.worlds.effect import Effect

READING = ("encoder_offset", "encoder_eccentricity", "gear_coupling_error")


def said(effects: tuple[Effect, ...], q, dq, ddq) -> tuple[np.ndarray, ...]:
    """Position, velocity and acceleration (..., n) as the encoders say them of the true ones."""
    told = q.copy(), dq.copy(), ddq.copy()
    for e in (e for e in effects if e.kind in READING):
        j, p = e.joint, e.params
        if e.kind == "encoder_offset":
            more = (p["dq0"], 0.0, 0.0)
        elif e.kind == "gear_coupling_error":
            more = tuple(-p["c"] * x[..., e.other] for x in (q, dq, ddq))
        else:
            more = _waves(p, q[..., j], dq[..., j], ddq[..., j])
        for x, error in zip(told, more, strict=True):
            x[..., j] += error
    return told


def _waves(p: dict, q, dq, ddq):
    """Errors once and twice a turn, and their derivatives."""
    value = slope = bend = 0.0
    for n in (1, 2):
        s, c = p[f"s{n}"], p[f"c{n}"]
        sine, cosine = np.sin(n * q), np.cos(n * q)
        value = value + s * sine + c * cosine
        slope = slope + n * (s * cosine - c * sine)
        bend = bend - n * n * (s * sine + c * cosine)
    return value, slope * dq, slope * ddq + bend * dq**2
