"""A recording under two names is refused, in whatever format and with however many digits it is written."""

from dataclasses import replace

import numpy as np
import pytest
from slide import run, slide_log

import jaxswarm
from jaxswarm.errors import InputError
from jaxswarm.logs import Log, read_log
from jaxswarm.logs.repeated import refuse_repeated_stretches
from jaxswarm.logs.write import write_log


@pytest.fixture(scope="module")
def whole():
    t, q, tau = np.array([line.split(",") for line in slide_log(900)[1:]], float).T
    return jaxswarm.log_from_arrays(t, q, tau, joints=("slide",))


def cut(log: Log, part: slice) -> Log:
    return replace(log, source="a part", t=log.t[part], q=log.q[part], tau=log.tau[part])


COPIES = {
    "with other digits": lambda log: replace(log, q=np.round(log.q, 5), tau=np.round(log.tau, 3)),
    "with a trace of noise": lambda log: replace(log, tau=log.tau + 1e-9),
    "later": lambda log: replace(log, t=log.t + 100.0),
    "a part": lambda log: cut(log, slice(300, 600)),
    "an overlap": lambda log: cut(log, slice(600, None)),
}


@pytest.mark.parametrize("kind", COPIES)
def test_copies_and_parts_are_refused_in_either_order(whole, kind):
    copy, other = COPIES[kind](whole), whole
    if kind == "an overlap":
        other = cut(whole, slice(0, 750))
    for pair in ((copy, other), (other, copy)):
        with pytest.raises(InputError, match="same motion twice"):
            refuse_repeated_stretches(pair[0], pair[1:])
        with pytest.raises(InputError, match="same motion twice"):
            jaxswarm.identify(pair, "emps", "viscous_friction")
        with pytest.raises(InputError, match="same motion twice"):
            jaxswarm.identify(pair[0], "emps", "viscous_friction", validation=pair[1])


def test_the_same_motion_measured_again_is_another_recording(whole):
    rng = np.random.default_rng(3)
    again = replace(
        whole, tau=whole.tau + 0.01 * whole.tau.std() * rng.normal(size=whole.tau.shape)
    )
    refuse_repeated_stretches(again, [whole])


def test_arms_at_rest_look_alike():
    still = Log(
        "still", ("slide",), np.arange(200) * 0.01, np.ones((200, 1)), tau=np.full((200, 1), 3.0)
    )
    refuse_repeated_stretches(replace(still, source="again"), [still])


def test_the_command_refuses_the_same_log_in_another_format(whole, tmp_path):
    write_log(whole, tmp_path / "log.csv")
    log = read_log(tmp_path / "log.csv", ("slide",))
    np.savez(tmp_path / "log.npz", t=log.t, q=log.q, tau=log.tau)
    given = "--robot", "emps", "--effects", "viscous_friction", "--out", tmp_path / "out"
    for more in ((tmp_path / "log.npz",), ("--validation", tmp_path / "log.npz")):
        code, _, err = run("identify", tmp_path / "log.csv", *more, *given)
        assert code == 2 and "same motion twice" in err and not (tmp_path / "out").exists()
