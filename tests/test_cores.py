"""Work shared out over cores: the same results in their order, and errors that come through."""

import threading

import pytest

from jaxswarm import cores


@pytest.mark.parametrize("count", [1, 2, 8])
def test_results_come_in_the_order_of_what_was_given(monkeypatch, count):
    monkeypatch.setattr(cores, "count", lambda: count)
    assert cores.each(lambda x: x * x, range(5)) == [0, 1, 4, 9, 16]
    assert cores.each(abs, []) == []
    for given in (range(5), []):
        with cores.beside_each(lambda x: x * x, given) as found:
            assert found() == [x * x for x in given]


def test_two_cores_work_at_once(monkeypatch):
    monkeypatch.setattr(cores, "count", lambda: 2)
    met = threading.Barrier(2, timeout=60)
    assert cores.each(lambda _: met.wait() in (0, 1), range(2)) == [True, True]
    with cores.beside(met.wait) as found:
        met.wait()
        assert found() in (0, 1)


@pytest.mark.parametrize("count", [1, 2])
def test_what_fails_is_told(monkeypatch, count):
    monkeypatch.setattr(cores, "count", lambda: count)
    with pytest.raises(ZeroDivisionError):
        cores.each(lambda x: 1 / x, [1, 0])
    with pytest.raises(ZeroDivisionError), cores.beside(lambda: 1 / 0) as found:
        found()
    with pytest.raises(ZeroDivisionError), cores.beside_each(lambda x: 1 / x, [1, 0]) as found:
        found()


def test_who_asks_helps_with_what_was_not_begun(monkeypatch):
    monkeypatch.setattr(cores, "count", lambda: 2)
    met = threading.Barrier(2, timeout=60)
    with cores.beside_each(lambda _: (met.wait(), threading.get_ident())[1], range(4)) as found:
        threads = found()
    assert len(set(threads)) == 2 and threads[-1] == threading.get_ident()


def test_an_error_does_not_wait_for_the_other_threads(monkeypatch):
    monkeypatch.setattr(cores, "count", lambda: 2)
    go_on = threading.Event()
    try:
        with pytest.raises(KeyboardInterrupt), cores.beside(lambda: go_on.wait(60)):
            raise KeyboardInterrupt
        with pytest.raises(ZeroDivisionError):
            cores.each(lambda x: 1 / x if x < 2 else go_on.wait(60), [0, 2])
        assert not go_on.is_set()
    finally:
        go_on.set()
