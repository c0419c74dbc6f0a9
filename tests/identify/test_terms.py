"""Lists of declared effects: what they expand to, and every way to misspell them."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jaxswarm.effects import REGISTRY
from jaxswarm.effects.term import physical_unit
from jaxswarm.errors import InputError
from jaxswarm.identify import parse_terms

JOINTS = ("joint1", "joint2", "joint3")


def labels(text, joints=JOINTS):
    return [term.label(joints) for term in parse_terms(text, joints)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("none", []),
        ("", []),
        (" none , ", []),
        ("torque_offset@joint2", ["torque_offset@joint2"]),
        ("viscous_friction", [f"viscous_friction@{j}" for j in JOINTS]),
        (
            " torque_offset@joint3 ,rotor_inertia@joint1 ",
            ["torque_offset@joint3", "rotor_inertia@joint1"],
        ),
        ("transmission_coupling@joint3", ["transmission_coupling@joint3:joint2"]),
        ("transmission_coupling@joint1:joint3", ["transmission_coupling@joint1:joint3"]),
        ("time_delay", ["time_delay"]),
    ],
)
def test_lists_expand(text, expected):
    assert labels(text) == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("viscous", "viscous_friction"),
        ("viscous_friction@joint9", "no joint 'joint9'"),
        ("viscous_friction@", "names no joint"),
        ("viscous_friction,viscous_friction@joint2", "viscous_friction@joint2 is listed twice"),
        ("time_delay@joint1", "whole arm"),
        ("viscous_friction@joint1:joint2", "no partner"),
        ("transmission_coupling@joint1:joint1", "itself"),
        ("transmission_coupling@joint1:elbow", "no joint 'elbow'"),
        ("viscous_friction@joint1@joint2", "no joint"),
        ("viscous_friction;coulomb_friction", "unknown effect"),
    ],
)
def test_mistakes_are_named(text, message):
    with pytest.raises(InputError, match=message):
        parse_terms(text, JOINTS)


def test_a_pair_needs_two_joints():
    with pytest.raises(InputError, match="couples two joints"):
        parse_terms("transmission_coupling", ("slide",))


@settings(max_examples=200, deadline=None)
@given(
    st.lists(
        st.one_of(
            st.text(max_size=12),
            st.builds(
                lambda n, s, j: n + s + j,
                st.sampled_from(sorted(REGISTRY)),
                st.sampled_from(["", "@", ":", "@@"]),
                st.sampled_from(["", *JOINTS, "joint1:joint2", "none"]),
            ),
        ),
        max_size=3,
    )
)
def test_any_text_parses_or_is_refused(parts):
    try:
        terms = parse_terms(",".join(parts), JOINTS)
    except InputError as error:
        assert str(error)
    else:
        written = ",".join(term.label(JOINTS) for term in terms)
        assert parse_terms(written, JOINTS) == terms


def test_column_names_are_unique():
    text = "viscous_friction,transmission_coupling,transmission_coupling@joint1:joint3,contact"
    names = [name for term in parse_terms(text, JOINTS) for name in term.columns(JOINTS)]
    assert len(set(names)) == len(names)
    assert "b_joint1_joint3:transmission_coupling" in names


def test_units_of_a_slide():
    assert physical_unit("N m s^2/rad^2", "prismatic") == "N s^2/m^2"
    assert physical_unit("N m/rad", "revolute") == "N m/rad"
    for name in ("torque_ripple", "position_dependent_friction"):
        law = REGISTRY[name]
        order = next(p.unit for p in law.parameters if p.name == "n")
        assert [physical_unit(order, kind) for kind in ("revolute", "prismatic")] == ["1", "1/m"]
        phase = law.derived(law.nominal())["phase"][1]
        assert [physical_unit(phase, kind) for kind in ("revolute", "prismatic")] == ["rad"] * 2
