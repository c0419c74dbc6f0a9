"""Structure outside the catalog: found, with the variables it depends on; none in white noise."""

from dataclasses import replace

import numpy as np
import pytest
from planted import added, declared_fit, diagnose_log, log_with

from jaxswarm.diagnose.unexplained import find_unexplained, residual_variables

WIDTH = 0.01


def with_extra(shape):
    """A log with a further torque ``shape(q, dq)`` on joint 2, from nearly exact positions."""
    log = log_with()
    dq = np.gradient(log.q, log.t, axis=0)
    extra = np.zeros_like(log.tau)
    extra[:, 1] = shape(log.q, dq)
    return replace(log, tau=log.tau + extra)


LAWS = [
    ("q_joint2", lambda q, dq: 2.0 * np.cos(5 * q[:, 1]) * np.tanh(dq[:, 1] / 0.05)),
    ("q_joint1", lambda q, dq: 2.0 * np.sin(2 * q[:, 0]) * np.tanh(dq[:, 1] / 0.05)),
]


@pytest.mark.parametrize(("other", "law"), LAWS)
def test_law_outside_the_catalog_is_unexplained_with_its_variables(other, law):
    found = diagnose_log(with_extra(law))
    left = [u for u in find_unexplained(found.final, found.background) if u.joint == 1]
    assert added(found) == []
    assert set(left[0].depends_on) == {other, "dq_joint2"}
    assert left[0].share > 0.3 and left[0].p_value < 1e-3
    assert left[0].variables.shape == (len(left[0].smooth), 2)


def test_the_smooth_term_lowers_the_residual():
    found, background = declared_fit(with_extra(LAWS[0][1]))
    left = [u for u in find_unexplained(found, background) if u.joint == 1][0]
    residual = found.fit.residual[:, 1]
    assert np.std(residual - left.smooth) < 0.85 * np.std(residual)


def test_white_residual_has_no_structure():
    found, background = declared_fit(log_with())
    assert find_unexplained(found, background) == []


def test_variables_are_named_and_sampled_like_the_residual():
    found, _ = declared_fit(log_with())
    table = residual_variables(found)
    wanted = {f"{s}_joint{j}" for s in ("q", "dq", "ddq") for j in (1, 2)} | {"t"}
    assert set(table) == wanted
    assert all(x.shape == (len(found.regression.t),) for x in table.values())
