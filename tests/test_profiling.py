"""The profile of a command: stages exclude each other and add up."""

import threading

import pytest

from benchmarks.profiling_command import EVENTS, SEARCHING, STAGES, TIMED, Interval, exclusive


def test_time_within_a_stage_is_the_inner_stages():
    here = threading.main_thread().ident
    seen = [
        Interval("proposing candidates", here, 0.0, 10.0),
        Interval("tracing", here, 1.0, 4.0),
        Interval("tracing", here, 2.0, 3.0),
        Interval("lowering", here, 4.0, 6.0),
        Interval("scoring", here, 10.0, 11.0),
        Interval(SEARCHING, -1, 0.0, 8.0),
        Interval("tracing", -1, 1.0, 3.0),
    ]
    found = exclusive(seen)
    assert found == pytest.approx(
        {
            "proposing candidates": 5.0,
            "tracing": 3.0,
            "lowering": 2.0,
            "scoring": 1.0,
            SEARCHING: 6.0,
            "in other threads: tracing": 2.0,
        }
    )
    assert set(found) <= set(STAGES) and len(set(STAGES)) == len(STAGES)
    assert not set(TIMED) & set(EVENTS.values())
