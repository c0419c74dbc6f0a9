r"""A smooth term: torque of one joint as a fitted function of its motion, where no law is known.

Random Fourier features (A. Rahimi, B. Recht, NIPS 2007) of the standardized inputs x,
:math:`\cos(\omega^T x + \varphi)`, the inputs themselves and a constant; inputs that are velocities also
enter by their direction, so that the function may jump where a joint reverses. It describes and does not
explain: outside the range of the inputs it was fitted on, it stays at the edge.
"""

from dataclasses import dataclass

import numpy as np

from jaxswarm.logs.motion import Motion

QUANTITIES = ("q", "dq", "ddq")


@dataclass(frozen=True)
class Smooth:
    """A smooth term with its coefficients.

    Attributes:
        joint: Index of the joint whose torque it adds to.
        inputs: Quantity (``q``, ``dq`` or ``ddq``) and joint index of every input.
        lower, upper: Range of the inputs it was fitted on, each (m,).
        center, scale: What standardizes them, each (m,).
        frequency: omega, shape (m, c).
        phase: Shape (c,).
        width: Width of the smooth sign of every input, for those that are velocities, (m,).
        coefficients: Of the features [N m or N], see :func:`features`.
    """

    joint: int
    inputs: tuple[tuple[str, int], ...]
    lower: np.ndarray
    upper: np.ndarray
    center: np.ndarray
    scale: np.ndarray
    frequency: np.ndarray
    phase: np.ndarray
    width: tuple[float, ...]
    coefficients: np.ndarray

    def torque(self, motion: Motion) -> np.ndarray:
        """Torque along a log, shape (T,)."""
        x = np.stack([getattr(motion, name)[:, j] for name, j in self.inputs], axis=1)
        x = np.clip(x, self.lower, self.upper)
        sides = [
            np.tanh(x[:, k] / self.width[k])
            for k, (name, _) in enumerate(self.inputs)
            if name == "dq"
        ]
        standard = (x - self.center) / self.scale
        return features(standard, sides, self.frequency, self.phase) @ self.coefficients


def features(
    x: np.ndarray, sides: list[np.ndarray], frequency: np.ndarray, phase: np.ndarray
) -> np.ndarray:
    """Features (T, f) of standardized inputs (T, m).

    Args:
        x: Standardized inputs.
        sides: Smooth signs (T,) of inputs at whose zero the function may jump.
        frequency: omega, shape (m, c).
        phase: Shape (c,).

    >>> features(np.zeros((2, 1)), [], np.ones((1, 3)), np.zeros(3)).shape
    (2, 5)
    """
    smooth = np.concatenate([np.cos(x @ frequency + phase), x, np.ones((len(x), 1))], axis=1)
    return np.concatenate([smooth, *(s[:, None] * smooth[:, ::2] for s in sides)], axis=1)


def to_json(term: Smooth, joints: tuple[str, ...]) -> dict:
    """The term as ``model.json`` holds it."""
    return {
        "joint": joints[term.joint],
        "inputs": [[name, joints[j]] for name, j in term.inputs],
        **{name: np.asarray(getattr(term, name)).tolist() for name in _ARRAYS},
        "width": list(term.width),
        "meaning": "fitted function without a law; constant beyond the range of its inputs",
    }


def from_json(content: dict, joints: tuple[str, ...]) -> Smooth:
    """Read what :func:`to_json` wrote.

    Raises:
        KeyError, ValueError: If something is missing or of another shape.
    """
    inputs = tuple((name, joints.index(joint)) for name, joint in content["inputs"])
    if not all(name in QUANTITIES for name, _ in inputs):
        raise ValueError(f"smooth term with inputs {content['inputs']!r}")
    arrays = {name: np.asarray(content[name], float) for name in _ARRAYS}
    count, width = len(inputs), content["width"]
    width = tuple(map(float, width if isinstance(width, list) else [width] * count))
    term = Smooth(joints.index(content["joint"]), inputs, width=width, **arrays)
    probe = features(
        np.zeros((1, count)),
        [np.zeros(1)] * sum(name == "dq" for name, _ in inputs),
        term.frequency,
        term.phase,
    )
    whole = all(getattr(term, n).shape == (count,) for n in ("lower", "upper", "center", "scale"))
    if not whole or len(width) != count or term.coefficients.shape != (probe.shape[1],):
        raise ValueError("smooth term whose arrays do not fit together")
    return term


_ARRAYS = ("lower", "upper", "center", "scale", "frequency", "phase", "coefficients")
