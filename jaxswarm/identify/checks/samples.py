"""Motion and torque of a log as the checks take it: thinned to what a rough model needs, or as a fit has it."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from jaxswarm.logs.filtering import Decimator
from jaxswarm.logs.motion import Motion

# Rows that a sign or a swapped channel needs by far; more only cost time.
_MOST_ROWS = 1000
# Of a long log so many stretches, evenly spread, are taken whole: a low-pass needs what lies between its rows.
_STRETCHES = 6
# Rows that are so many usual steps apart are of two stretches.
_GAP = 1.5
# Samples whose columns pass the low-pass at a time.
_BLOCK = 4096


@dataclass(frozen=True)
class Samples:
    """Motion [rad, m, s], torque [N m or N] and its derivative on the compared clock.

    Attributes:
        t: Times of the torques [s], (R,).
        q, dq, ddq: Motion, (T, n): on the clock of the torques, or on the working clock where ``parts`` says
            how its columns become rows.
        tau, tau_rate: Torque below its cutoff and its derivative, (R, n).
        parts: Stretches of the motion and their low-pass, in order; none: rows are samples, R is T.
    """

    t: np.ndarray
    q: np.ndarray
    dq: np.ndarray
    ddq: np.ndarray
    tau: np.ndarray
    tau_rate: np.ndarray
    parts: tuple[tuple[slice, Decimator], ...] = ()

    def rows(self, columns: Callable[[slice], np.ndarray]) -> np.ndarray:
        """What a model asks of its samples, low-passed as the torque is: (T, ...) -> (R, ...).

        Args:
            columns: Makes the columns of a stretch of the samples.
        """
        if not self.parts:
            return columns(slice(None))
        return np.concatenate([low.apply(columns(part)) for part, low in self._blocks()])

    def derivative(self, values: np.ndarray) -> np.ndarray:
        """Derivative by time of what is told of every row, (R,); not across gaps."""
        steps = np.diff(self.t)
        usual = np.median(steps)
        ends = np.flatnonzero((steps <= 0.0) | (steps > _GAP * usual)) + 1
        parts = zip(np.split(values, ends), np.split(self.t, ends), strict=True)
        return np.concatenate([np.gradient(x, t) if len(x) > 1 else 0.0 * x for x, t in parts])

    def placed(self, scale: np.ndarray | float = 1.0, zero: np.ndarray | float = 0.0) -> "Samples":
        """Every position (n,) times a scale, plus a zero [rad or m]; its derivatives go with it."""
        return replace(self, q=scale * self.q + zero, dq=scale * self.dq, ddq=scale * self.ddq)

    def taken(self, rows: np.ndarray) -> "Samples":
        """Some of the rows, by a mask (R,); of samples that are rows."""
        names = "t", "q", "dq", "ddq", "tau", "tau_rate"
        return Samples(*(getattr(self, name)[rows] for name in names))

    def faster(self, factor: float) -> "Samples":
        """The same positions with the clock running so many times as fast."""
        return replace(self, dq=factor * self.dq, ddq=factor**2 * self.ddq)

    def turned(self, sign: np.ndarray, zero: np.ndarray) -> "Samples":
        """Joints that turn the other way where the sign (n,) is -1: positions as placed, torques with them."""
        return replace(self.placed(sign, zero), tau=sign * self.tau, tau_rate=sign * self.tau_rate)

    def reordered(self, positions: np.ndarray, torques: np.ndarray | None = None) -> "Samples":
        """Column ``positions[j]`` of the motion and ``torques[j]`` of the torque for joint j; None: its own."""
        moved = replace(
            self, q=self.q[:, positions], dq=self.dq[:, positions], ddq=self.ddq[:, positions]
        )
        if torques is None:
            return moved
        return replace(moved, tau=self.tau[:, torques], tau_rate=self.tau_rate[:, torques])

    def _blocks(self) -> Iterator[tuple[slice, Decimator]]:
        for part, low in self.parts:
            for block in low.blocks(part.stop - part.start, _BLOCK):
                yield slice(part.start + block.start, part.start + block.stop), low


def samples_of(motions: Sequence[Motion]) -> Samples:
    """The stretches of a log, thinned to the rows that a rough fit needs."""
    kept = [m.decimator.kept(len(m.t)) for m in motions]
    stride = max(1, sum(map(len, kept)) // _MOST_ROWS)

    def joined(parts) -> np.ndarray:
        return np.concatenate([part[::stride] for part in parts])

    torques = [m.low_torque for m in motions]
    return Samples(
        joined([m.t[k] for m, k in zip(motions, kept, strict=True)]),
        joined([m.q[k] for m, k in zip(motions, kept, strict=True)]),
        joined([m.dq[k] for m, k in zip(motions, kept, strict=True)]),
        joined([m.ddq[k] for m, k in zip(motions, kept, strict=True)]),
        joined(torques),
        joined(_rates(motions, torques)),
    )


def fine_samples(motions: Sequence[Motion]) -> Samples:
    """The log on its working clock, or stretches of a long one, for columns that pass the torque's low-pass."""
    times = [m.t[m.decimator.kept(len(m.t))] for m in motions]
    rows = [len(t) for t in times]
    share = min(1.0, _MOST_ROWS / max(sum(rows), 1))
    torques = [m.low_torque for m in motions]
    rates = _rates(motions, torques)
    moved: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    pushed: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    parts, end = [], 0
    for motion, time, torque, rate in zip(motions, times, torques, rates, strict=True):
        low = motion.decimator
        for first, last in _spread(len(time), share):
            samples = slice(first * low.factor, (last - 1) * low.factor + len(low.taps))
            moved.append((motion.q[samples], motion.dq[samples], motion.ddq[samples]))
            pushed.append((time[first:last], torque[first:last], rate[first:last]))
            length = samples.stop - samples.start
            parts.append((slice(end, end + length), low))
            end += length
    q, dq, ddq = (np.concatenate(x) for x in zip(*moved, strict=True))
    t, tau, tau_rate = (np.concatenate(x) for x in zip(*pushed, strict=True))
    return Samples(t, q, dq, ddq, tau, tau_rate, tuple(parts))


def _spread(count: int, share: float) -> list[tuple[int, int]]:
    """First and last row (exclusive) of stretches that hold a share of so many rows."""
    if share == 1.0:
        return [(0, count)] if count else []
    edges = np.linspace(0, count, _STRETCHES + 1).astype(int)
    length = max(1, int(share * count / _STRETCHES))
    return [(a, min(a + length, b)) for a, b in zip(edges[:-1], edges[1:], strict=True) if b > a]


def _rates(motions: Sequence[Motion], torques: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Derivatives of low-passed torques [N m/s or N/s]."""
    steps = [m.decimator.factor / m.rate for m in motions]
    return [
        np.gradient(x, step, axis=0) if len(x) > 1 else 0.0 * x
        for x, step in zip(torques, steps, strict=True)
    ]
