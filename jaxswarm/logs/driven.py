"""How much of a fast motion is driven: told by the torque that goes with it.

A filter or an interpolation makes the noise of a position strong at some frequencies, and so do impacts and
controllers the motion. The torque of the joint knows which of the two it is.
"""

import numpy as np

# Resolution, as a part of the lower frequency, and the fewest stretches: of seven, noise shares 0.15. Stretches
# of so many seconds, a quarter of the log at most, keep a slow motion from leaking into the band.
_RESOLVED, _STRETCHES, _LONG = 0.25, 7, 2.0


def driven_share(
    q: np.ndarray, torque: np.ndarray, rate: float, lower: float, upper: float
) -> float:
    """Share of an acceleration's power between two frequencies that goes with the torque.

    The acceleration's density times its coherence with the torque, averaged over stretches of the log that
    overlap by half (J. Bendat, A. Piersol, Random Data, 2010, ch. 6), Hann window.

    Args:
        q: Uniformly sampled position of a joint, (T,).
        torque: Its torque, (T,).
        rate: Sampling rate [Hz].
        lower, upper: Frequencies [Hz].

    Returns:
        Between zero and one; zero where the log is too short to tell.
    """
    length = int(max(16.0, rate / (_RESOLVED * lower), min(_LONG * rate, len(q) / 4.0 - 1.0)))
    if len(q) - 2 < (_STRETCHES + 1) * length // 2:
        return 0.0
    # Differences first: of a slow motion nothing must leak into the band.
    both = np.stack([np.diff(q, 2), torque[1:-1]], axis=1)
    window = np.sin(np.pi * np.arange(length) / length)[:, None] ** 2
    frequency = np.fft.rfftfreq(length, 1.0 / rate)
    inside = (frequency >= lower) & (frequency <= upper)
    own = other = cross = np.zeros(inside.sum())
    for start in range(0, len(both) - length + 1, length - length // 2):
        part = both[start : start + length]
        a, b = np.fft.rfft((part - part.mean(axis=0)) * window, axis=0)[inside].T
        own, other, cross = own + np.abs(a) ** 2, other + np.abs(b) ** 2, cross + a.conj() * b
    known = other > 0.0
    return float((np.abs(cross[known]) ** 2 / other[known]).sum() / max(own.sum(), 1e-300))
