"""Arrays that are kept while there is room for them."""

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
