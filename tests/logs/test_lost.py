"""Samples that are missing while time goes on evenly, told from stamps that jitter about even samples."""

import numpy as np
import pytest

from jaxswarm.logs.log import Log
from jaxswarm.logs.lost import lost_samples

EVEN = np.arange(4000) * 0.005


def moving(t: np.ndarray, stamps: np.ndarray) -> Log:
    number = np.arange(1, 6)
    q = np.sin(number**0.5 * t[:, None] + number)
    joints = tuple(f"joint{k}" for k in number)
    return Log("made", joints, stamps, q, tau=np.zeros_like(q))


@pytest.mark.parametrize("share", [0.1, 0.2, 0.3])
def test_stamps_that_jitter_about_even_samples_hide_no_loss(share):
    """Half of a step of time doubles a speed; the joints move as far as in every other step."""
    stamps = np.sort(EVEN + share * 0.005 * np.random.default_rng(1).normal(size=EVEN.size))
    assert lost_samples(moving(EVEN, stamps)) == []


@pytest.mark.parametrize("share", [0.0, 0.05])
def test_samples_that_are_missing_are_told_with_or_without_jitter(share):
    rng = np.random.default_rng(2)
    kept = np.sort(rng.choice(EVEN.size, 3200, replace=False))
    stamps = EVEN[:3200] + share * 0.005 * rng.normal(size=3200)
    assert len(lost_samples(moving(EVEN[kept], stamps))) == 1
