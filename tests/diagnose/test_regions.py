"""Regions of the states of a log, of which each is held out once."""

from types import SimpleNamespace

import numpy as np
import pytest

from jaxswarm.diagnose.folds.other_motion import regions


def _log(*groups: tuple[float, int]):
    """A log of one joint whose rows lie around places, so many at each."""
    rng = np.random.default_rng(0)
    q = np.concatenate([place + 0.1 * rng.standard_normal(count) for place, count in groups])
    whole = SimpleNamespace(kept=np.arange)
    motion = SimpleNamespace(
        t=np.arange(len(q)), q=q[:, None], dq=0.0 * q[:, None], decimator=whole
    )
    return SimpleNamespace(motions=[motion])


def test_a_few_rows_far_from_all_others_belong_to_the_region_next_to_them():
    """Point-to-point motion passes some places in a few rows: nothing could be shown on any such log."""
    label = regions(_log((0.0, 60), (1.0, 60), (2.0, 60), (-9.0, 5), (12.0, 5)))
    assert label is not None and np.bincount(label).min() >= 15
    assert (label[180:185] == label[0]).all() and (label[185:] == label[120]).all()


@pytest.mark.parametrize("groups", [[(0.0, 60), (9.0, 60), (1.0, 3)], [(0.0, 80)]])
def test_every_region_has_rows_enough_or_there_is_none(groups):
    label = regions(_log(*groups))
    assert label is None or (np.bincount(label).min() >= 15 and label.max() >= 2)


def test_a_joint_that_stands_has_no_regions():
    log = _log((0.0, 200))
    log.motions[0].q[:] = 1.0
    assert regions(log) is None
