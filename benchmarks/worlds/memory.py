"""What a joint remembers: the bend of bristles, the age of contacts; exact over a step of steady velocity."""

import numpy as np


def dahl(p: dict, z: float, dq: float, h: float) -> float:
    """Bend in units of its level: dz = (dq - |dq| z) / x0 dt."""
    target = np.sign(dq)
    return target + (z - target) * np.exp(-abs(dq) * h / p["x0"])


def lugre(p: dict, z: float, dq: float, h: float) -> float:
    """The same with a level that falls with speed: dz = (dq - |dq| z / g) / x0 dt."""
    level = 1.0 + p["rise"] * np.exp(-((dq / p["vs"]) ** 2))
    target = np.sign(dq) * level
    return target + (z - target) * np.exp(-abs(dq) * h / (p["x0"] * level))


def age(p: dict, z: float, dq: float, h: float) -> float:
    """Age of contacts [s] that are used up over a way: dz = (1 - |dq| z / x0) dt."""
    rate = abs(dq) / p["x0"]
    grown = h if rate * h < 1e-9 else -np.expm1(-rate * h) / rate
    return z * np.exp(-rate * h) + grown


def along(law, p: dict, t: np.ndarray, dq: np.ndarray) -> np.ndarray:
    """The memory of a law at all times of a motion, (T,)."""
    z, state = np.zeros_like(dq), 0.0
    for k, step in enumerate(np.diff(t, append=t[-1])):
        z[k] = state
        state = law.memory(p, state, dq[k], step)
    return z
