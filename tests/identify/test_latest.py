"""Arrays that are kept while there is room for them."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from jaxswarm.identify.forward.latest import Latest


class Asked:
    """An array that counts how often it is asked for its size."""

    count = 0

    @property
    def size(self):
        Asked.count += 1
        return 1


def test_what_is_kept_is_not_added_up_for_each_new_one():
    latest = Latest(100)
    for place in range(1000):
        latest.of(place, Asked)
    assert Asked.count <= 4 * 1000


def test_the_oldest_go_where_there_is_no_room_and_the_newest_stays():
    made, latest = [], Latest(5)

    def of(place, size):
        return latest.of(place, lambda: made.append(place) or np.zeros(size))

    for place, size in (
        ("a", 2),
        ("b", 2),
        ("large", 9),
        ("large", 9),
        ("a", 2),
        ("b", 2),
        ("a", 2),
    ):
        assert of(place, size).size == size
    assert made == ["a", "b", "large", "a", "b"]


def test_what_two_threads_made_at_once_is_counted_once():
    latest = Latest(4)

    def nested():
        latest.of("a", lambda: np.ones(2))  # the other thread is done first
        return np.zeros(2)

    assert latest.of("a", nested)[0] == 1.0
    latest.of("b", lambda: np.zeros(2))
    assert latest.of("a", lambda: np.zeros(2))[0] == 1.0, "there was room for both"


def test_threads_find_what_they_ask_for():
    latest = Latest(6)
    with ThreadPoolExecutor(4) as pool:
        asked = [k % 7 for k in range(4000)]
        found = pool.map(lambda k: latest.of(k, lambda: np.full(1 + k % 3, k))[0], asked)
        assert [*found] == asked
