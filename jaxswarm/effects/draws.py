"""Drawn motion and parameters on which an effect is tried."""

import numpy as np

from jaxswarm.effects.base import Effect
from jaxswarm.effects.sample import Sample, make_sample

_WIDTH = 0.05
# A table may leave a coefficient almost unbounded; a law is tried with values up to this.
_LARGE = 100.0


def draw_parameters(law: Effect, rng: np.random.Generator) -> dict[str, float]:
    """Draw a value of every parameter between its bounds, each on its own scale."""
    values = {}
    for p in law.parameters:
        low, high = max(p.lower, -_LARGE), min(p.upper, _LARGE)
        if p.scale == "log":
            values[p.name] = float(np.exp(rng.uniform(np.log(p.lower), np.log(p.upper))))
        else:
            values[p.name] = float(rng.uniform(low, high))
    return values


def draw_series(rng: np.random.Generator, length: int = 64) -> Sample:
    """A smooth motion of a joint and its partner that stops in the middle, Sample of (T,) arrays."""
    t = np.linspace(0.0, 2.0, length)
    waves = rng.normal(size=(2, 3, 1)), rng.uniform(1.0, 6.0, (2, 3, 1))
    moving = np.where((t > 0.9) & (t < 1.1), 0.0, 1.0)
    dq, other = (waves[0] * np.sin(waves[1] * t)).sum(axis=1) * moving
    ddq, ddq_other = (waves[0] * waves[1] * np.cos(waves[1] * t)).sum(axis=1)
    fields = {
        "t": t,
        "q": np.cumsum(dq) * t[1],
        "dq": dq,
        "ddq": ddq,
        "direction": np.tanh(dq / _WIDTH),
        "load": rng.normal(0.0, 20.0, length),
        "static_load": rng.normal(0.0, 20.0, length),
        "temperature": rng.uniform(10.0, 60.0, length),
        "q_other": np.cumsum(other) * t[1],
        "dq_other": other,
        "ddq_other": ddq_other,
        "direction_sum": np.tanh((dq + other) / _WIDTH),
        "direction_difference": np.tanh((dq - other) / _WIDTH),
    }
    return make_sample(**fields)
