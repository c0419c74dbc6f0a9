"""The first line names the joints whose error fell where that of the whole arm hides it."""

import pytest

from jaxswarm.diagnose.report.error_change import error_change


def result(before, after, effects=(), changed=()):
    def errors(whole):
        return {"relative_global": whole, "relative": [whole, 0.5 * whole**2], "on": "b.npz"}

    return {
        "joints": ("joint1", "joint2"),
        "effects": [{"joint": joint} for joint in effects],
        "changed": [{"joint": joint} for joint in changed],
        "discovered": [],
        "error": {"before": errors(before), "after": errors(after)},
    }


WHOLE = "20.00 % before, 30.00 % after, on b.npz"


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (result(0.2, 0.2), "20.00 %"),
        (result(0.2, 0.1, ["joint2"]), "20.00 % before, 10.00 % after, on b.npz"),
        (result(0.2, 0.3, ["joint2"]), f"joint2 2.00 % before, 4.50 % after; whole arm {WHOLE}"),
        (
            result(0.2, 0.3, [], ["joint2"]),
            f"joint2 2.00 % before, 4.50 % after; whole arm {WHOLE}",
        ),
        (result(0.2, 0.3, [None]), WHOLE),
    ],
)
def test_error_change(given, told):
    assert error_change(given) == told
