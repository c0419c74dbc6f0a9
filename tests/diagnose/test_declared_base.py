"""A base that the user declares to give way is fitted with the swing of its arm, where it has one."""

from dataclasses import replace

import pytest
from elbow import elbow, elbow_log
from planted import BAND
from swaying import log_on_soft_base

from jaxswarm.effects.term import Term, parse_terms
from jaxswarm.identify import estimate
from jaxswarm.logs.motion import prepare

DECLARED = parse_terms("viscous_friction,coulomb_friction,base_compliance", elbow().joints)


def fitted(log, terms=DECLARED):
    found = estimate(elbow(), terms, [prepare(log, BAND)], bounded=False)
    (base,) = [t for t in found.model.terms if t.effect == "base_compliance"]
    return base.values, found.fit.sigma


def test_a_declared_base_swings():
    """Its fit began, and ended, at a base without a swing, since no step leads from there to one."""
    log = log_on_soft_base(2e-3, 1.2e-3, inertia=0.3)
    values, sigma = fitted(log)
    assert [values["cx"], values["cy"]] == pytest.approx([2e-3, 1.2e-3], rel=0.1)
    assert max(values["fx"], values["fy"]) < 20.0
    still = {"fx": 100.0, "fy": 100.0, "zeta": 0.03}
    given = tuple(
        replace(t, values=still) if t.effect == "base_compliance" else t for t in DECLARED
    )
    told, as_given = fitted(log, given)
    assert told["fx"] == told["fy"] == 100.0
    assert (sigma < 0.8 * as_given).all()


@pytest.mark.parametrize("soft", [0.0, 1e-3])
def test_a_declared_base_that_does_not_swing_has_no_swing(soft):
    base = Term("base_compliance", values={"cx": soft, "cy": 0.0})
    values, _ = fitted(elbow_log(*([base] if soft else [])))
    assert values["fx"] == values["fy"] == 100.0
    assert values["cx"] == pytest.approx(soft, abs=3e-4)
