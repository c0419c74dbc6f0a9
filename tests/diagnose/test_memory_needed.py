"""A diagnosis that would not fit into memory is refused before it begins, with numbers."""

import importlib
from dataclasses import replace

import numpy as np
import pytest

import jaxswarm.memory as place
from jaxswarm.diagnose import memory
from jaxswarm.errors import InputError
from jaxswarm.identify.forward.columns import rigid_of
from jaxswarm.identify.forward.sensitivity import sensitivity_of
from jaxswarm.identify.synthetic import demo_case, synthetic_log
from jaxswarm.logs.motion import prepare
from jaxswarm.robot import rx60


@pytest.fixture(scope="module")
def motion():
    arm, declared, _ = demo_case(rx60(), 1)
    return prepare(synthetic_log(arm, declared, 1, duration=8.0))


def test_what_is_needed_holds_the_columns_and_their_derivatives(motion):
    rigid = rigid_of(rx60(), motion)
    held = rigid.full.nbytes + rigid.low.nbytes
    for joint in range(3):
        own = sensitivity_of(rx60(), motion, joint, rigid)._whole
        held += own.by_q.nbytes + own.by_dq.nbytes + own.by_ddq.nbytes
    told = 2**30 * memory.needed([motion])
    assert held < told < 3 * held
    assert memory.needed([motion, motion]) == pytest.approx(2 * memory.needed([motion]))


def test_a_long_log_needs_no_columns_of_all_its_samples(motion, monkeypatch):
    # A million samples at 1 kHz, whose motion is slow.
    long = replace(motion, t=np.arange(250_000) / 250.0, q=np.empty((250_000, 7)))
    assert memory.needed([long]) < 3.5
    columns = importlib.import_module("jaxswarm.identify.forward.columns")
    kept = memory.needed([motion])
    monkeypatch.setattr(columns, "_KEPT", 0)
    assert memory.needed([motion]) < kept


def test_a_log_whose_few_samples_are_kept_needs_their_columns(motion):
    """Those of seven joints at 1 kHz for 30 s on every fourth sample, which springs are tried on."""
    low = replace(motion.decimator, factor=8)
    t, q = np.arange(30_000) / 1e3, np.empty((30_000, 7))
    fast = replace(motion, t=t, q=q, decimator=low, torque_cutoff=7.0)
    wide = replace(fast, torque_cutoff=60.0)  # compared so far that all samples are asked
    few = fast.q.size * (70 + 3 * 10 * 28) / 4
    told = memory.needed([fast]) - memory.needed([wide])
    assert told == pytest.approx(8.0 * few / 2**30)


def test_too_large_is_refused_with_what_is_needed_and_what_there_is(motion, monkeypatch):
    memory.refuse_too_large([motion])
    monkeypatch.setattr(place, "free", lambda: None)
    memory.refuse_too_large([motion])
    monkeypatch.setattr(place, "free", lambda: 1e-3)
    with pytest.raises(InputError, match=r"to diagnose .* GiB, and 0\.001 GiB are free; .*cutoff"):
        memory.refuse_too_large([motion])


def test_the_task_refuses_it(motion, monkeypatch):
    import jaxswarm

    arm, declared, _ = demo_case(rx60(), 1)
    log = synthetic_log(arm, declared, 1, duration=8.0)
    monkeypatch.setattr(place, "free", lambda: 0.0)
    with pytest.raises(InputError, match="to diagnose 2000 samples"):
        jaxswarm.diagnose(log, "rx60", "viscous_friction,coulomb_friction")


def test_a_container_may_have_less_than_the_machine(tmp_path):
    assert place._group(tmp_path) == []
    (tmp_path / "memory.max").write_text("3000\n")
    (tmp_path / "memory.current").write_text("1000\n")
    assert place._group(tmp_path) == [2000.0]
    (tmp_path / "memory.max").write_text("max\n")
    assert place._group(tmp_path) == []
    assert np.isfinite(place.free() or 0.0)
