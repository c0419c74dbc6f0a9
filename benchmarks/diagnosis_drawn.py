"""What is hidden in a simulated log: which parameter is scaled to a wanted size, how the others are drawn."""

from typing import NamedTuple

import numpy as np


def _uniform(low, high):
    return lambda rng: float(rng.uniform(low, high))


def _log(low, high):
    return lambda rng: float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _zero(rng):
    return 0.0


class Drawn(NamedTuple):
    """How an effect is hidden.

    Attributes:
        amplitude: The parameter that is scaled to the wanted ratio.
        others: The parameters that are drawn.
        size: Where the search for the amplitude starts.
        most: Where it ends, whatever is asked for.
    """

    amplitude: str
    others: dict
    size: float = 1.0
    most: float = 200.0


# Those of the suite.
DRAWN = {
    "stribeck_friction": Drawn("df", {"vs": _log(0.04, 0.2), "delta": lambda rng: 2.0}),
    "torque_ripple": Drawn("sine", {"n": _uniform(6.0, 60.0), "cosine": _zero}),
    "joint_spring": Drawn("k", {"tau0": _zero}),
    "load_dependent_friction": Drawn("mu", {"inertial": _uniform(0.0, 1.0)}),
    "hysteresis": Drawn("fc", {"x0": _log(0.03, 0.15)}),
    "torque_offset": Drawn("tau0", {}),
    "thermal_drift": Drawn("fc", {"tc": _log(5.0, 20.0)}),
    "transmission_coupling": Drawn("b", {"fc": _zero, "fd": _zero, "ia": _zero}),
    "quadratic_drag": Drawn("c", {}),
    "nonlinear_viscous_friction": Drawn("c", {"alpha": _uniform(0.3, 0.6)}),
    "coulomb_friction": Drawn("fc", {}),
    "rotor_inertia": Drawn("ia", {}),
    "time_delay": Drawn("seconds", {}, 0.004, 0.03),
    "drive_gain": Drawn("gain", {}, 0.05, 0.4),
    "base_tilt": Drawn("gx", {"gy": _zero}, 0.3, 2.0),
}
# Those that came later: their detection limits are a table of their own.
LATER = {
    "position_dependent_friction": Drawn("sine", {"n": _uniform(1.0, 4.0), "cosine": _zero}),
    "friction_change": Drawn("fc", {"t0": _uniform(6.0, 14.0)}),
    "dwell_friction": Drawn("fc", {"x0": _log(0.02, 0.1), "tr": _log(0.3, 2.0)}),
    "lugre_friction": Drawn(
        "fc", {"x0": _log(0.02, 0.1), "rise": _uniform(0.4, 1.0), "vs": _log(0.08, 0.25)}
    ),
    "gravity_compensator": Drawn(
        "a", {"b": _uniform(0.3, 0.8), "q0": _uniform(-0.5, 0.5)}, most=2000.0
    ),
    "cubic_spring": Drawn("k3", {"q0": _uniform(-0.3, 0.3)}, most=2000.0),
    "dead_zone_spring": Drawn(
        "k", {"q0": _uniform(-0.3, 0.3), "gap": _uniform(0.1, 0.4)}, most=2000.0
    ),
    "cable_coupling": Drawn("kc", {"k": _zero, "tau0": _zero}),
    "periodic_force": Drawn("sine", {"cosine": _zero, "hertz": _log(0.5, 5.0), "log": _zero}),
    "encoder_offset": Drawn("dq0", {}, 0.02, 0.4),
    "encoder_eccentricity": Drawn("s1", {"c1": _zero, "s2": _zero, "c2": _zero}, 0.01, 0.15),
    "gear_coupling_error": Drawn("c", {}, 0.01, 0.4),
    "torque_constant_saturation": Drawn("c", {}, 1e-3, 0.05),
    "torque_dead_band": Drawn("d", {}),
    "torque_lag": Drawn("tc", {"seconds": _zero}, 0.002, 0.05),
    "link_geometry": Drawn("x", {"y": _zero, "turn_x": _zero, "turn_y": _zero}, 0.005, 0.15),
    "base_compliance": Drawn("cx", {"cy": _zero}, 1e-5, 5e-3),
    "maxwell_slip": Drawn("fc1", {"fc2": _zero, "x1": _log(0.06, 0.3), "part": _log(0.08, 0.4)}),
    "torque_crosstalk": Drawn("c", {}, 1e-3, 0.09),
    "offset_drift": Drawn("rate", {"tc": _log(5.0, 20.0)}),
    "offset_change": Drawn("tau", {"t0": _uniform(6.0, 14.0)}),
    "relaxing_spring": Drawn("k", {"tc": _log(0.1, 1.0)}, most=2000.0),
    "drive_lag": Drawn("tc", {}, 0.002, 0.1),
}
KNOWN = DRAWN | LATER
# Effects of the whole arm, and those between a joint and the next one.
WHOLE_ARM = ("time_delay", "base_tilt", "torque_lag", "base_compliance")
BETWEEN_TWO = (
    "transmission_coupling",
    "cable_coupling",
    "gear_coupling_error",
    "torque_crosstalk",
)
