"""Effects with the values of usual drives, to put into made logs: what a search for them is tried on."""

import numpy as np

from jaxswarm.effects.term import Term


def usual_friction(rng: np.random.Generator, num_joints: int) -> tuple[Term, ...]:
    """Viscous and dry friction of every joint, less towards the wrist."""
    return tuple(
        Term(name, j, values={symbol: float(rng.uniform(3.0, 6.0) / (1 + j))})
        for name, symbol in (("viscous_friction", "b"), ("coulomb_friction", "fc"))
        for j in range(num_joints)
    )


def dry_friction(joint: int, fc: float) -> Term:
    """Dry friction fc [N m] on a joint."""
    return Term("coulomb_friction", joint, values={"fc": fc})


def ripple(joint: int) -> Term:
    """22 waves a turn of 1.1 N m."""
    return Term("torque_ripple", joint, values={"sine": 0.9, "cosine": 0.7, "n": 22.0})


def one_of_each(joint: int, other: int) -> tuple[Term, ...]:
    """What may be missing from a model, one of each, on a joint (with another one as its partner)."""
    return (
        Term("stribeck_friction", joint, values={"df": 4.0, "vs": 0.1, "delta": 2.0}),
        ripple(joint),
        Term("joint_spring", joint, values={"k": 18.0, "tau0": 2.0}),
        Term("load_dependent_friction", joint, values={"mu": 0.08, "inertial": 1.0}),
        Term("hysteresis", joint, values={"fc": 5.0, "x0": 0.06}),
        Term("thermal_drift", joint, values={"fc": 5.0, "tc": 12.0}),
        Term(
            "transmission_coupling",
            joint,
            other,
            values={"b": 5.0, "fc": 0.0, "fd": 0.0, "ia": 0.0},
        ),
        Term("quadratic_drag", joint, values={"c": 2.5}),
        Term("time_delay", values={"seconds": 0.008}),
    )
