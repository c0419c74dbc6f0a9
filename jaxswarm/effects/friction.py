r"""Friction laws: everything that opposes the motion of one joint.

Signs: a torque the motor must supply, so friction has the sign of ``dq``. The sign function is the
sample's ``direction = tanh(dq / width)``; its width is a property of the whole model, not of a law.

References: H. Olsson et al., "Friction models and friction compensation", Eur. J. Control 4 (1998);
B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994); W. Khalil, E. Dombre,
"Modeling, Identification and Control of Robots" (2002), ch. 9; A. Wahrburg et al. and P. Hamon et al.
(IROS 2010) for the dependence on load; P. R. Dahl, "A solid friction model" (1968).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import Export, register
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import WARMING, Parameter

# What every joint has: declared where nothing else is.
USUAL_FRICTION = "viscous_friction,coulomb_friction"
_OLSSON = "Olsson et al. 1998, Eur. J. Control 4(3)"


def _coefficient(name: str, unit: str, upper: float, nominal: float, description: str) -> Parameter:
    """A linear coefficient that physics allows to be positive only."""
    return Parameter(name, unit, 0.0, upper, True, nominal, description)


register(
    TorqueLaw(
        name="viscous_friction",
        scope="joint",
        everyday=True,
        parameters=(_coefficient("b", "N m s/rad", 1e4, 1.0, "viscous coefficient"),),
        summary="b dq",
        reference=_OLSSON,
        meaning="Lubricant resists in proportion to speed; look at the lubricant if it grew.",
        torque=lambda p, s: p["b"] * s.dq,
        dissipative=True,
        export=(
            Export("urdf", lambda p: {"damping": p["b"]}),
            Export("mjcf", lambda p: {"damping": p["b"]}),
        ),
    )
)

register(
    TorqueLaw(
        name="coulomb_friction",
        scope="joint",
        everyday=True,
        parameters=(_coefficient("fc", "N m", 1e4, 1.0, "dry friction level"),),
        summary="fc sign(dq)",
        reference=_OLSSON,
        meaning="Seals, bearings and gears rub at any speed; look at preload and seals if it grew.",
        torque=lambda p, s: p["fc"] * s.direction,
        uses_direction=True,
        dissipative=True,
        export=(
            Export("urdf", lambda p: {"friction": p["fc"]}),
            Export("mjcf", lambda p: {"frictionloss": p["fc"]}),
        ),
    )
)


def _asymmetric(p, s):
    forward, backward = 0.5 * (1.0 + s.direction), 0.5 * (1.0 - s.direction)
    up = p["fc_pos"] * s.direction + p["b_pos"] * s.dq
    down = p["fc_neg"] * s.direction + p["b_neg"] * s.dq
    return forward * up + backward * down


register(
    TorqueLaw(
        name="asymmetric_friction",
        scope="joint",
        parameters=(
            _coefficient("fc_pos", "N m", 1e4, 1.0, "dry friction, forward"),
            _coefficient("fc_neg", "N m", 1e4, 1.0, "dry friction, backward"),
            _coefficient("b_pos", "N m s/rad", 1e4, 1.0, "viscous coefficient, forward"),
            _coefficient("b_neg", "N m s/rad", 1e4, 1.0, "viscous coefficient, backward"),
        ),
        summary="own fc sign(dq) + b dq for each direction",
        reference="Janot, Gautier, Brunot 2019 (EMPS)",
        meaning="The joint runs harder one way, as worms and ball screws do; compensate each way by itself.",
        torque=_asymmetric,
        contains=("viscous_friction", "coulomb_friction"),
        uses_direction=True,
        dissipative=True,
    )
)


def _stribeck(p, s):
    ratio = jnp.abs(s.dq / p["vs"])
    # |x|^delta has no derivative at zero for delta < 1: keep the base away from it.
    return p["df"] * jnp.exp(-((ratio + 1e-9) ** p["delta"])) * s.direction


register(
    TorqueLaw(
        name="stribeck_friction",
        scope="joint",
        parameters=(
            _coefficient("df", "N m", 1e4, 1.0, "static minus dry friction"),
            Parameter("vs", "rad/s", 0.005, 1.0, False, 0.1, "Stribeck velocity", "log"),
            Parameter("delta", "1", 0.5, 3.0, False, 2.0, "shape exponent", usual=True),
        ),
        summary="df exp(-|dq/vs|^delta) sign(dq), on top of Coulomb",
        reference="Armstrong-Helouvry, Dupont, Canudas de Wit 1994, Automatica 30(7)",
        meaning=(
            "Friction is higher at creeping speed than when a film of lubricant carries: slow "
            "motion sticks and slips; compensate it, or avoid speeds below vs."
        ),
        torque=_stribeck,
        uses_direction=True,
        dissipative=True,
    )
)

register(
    TorqueLaw(
        name="quadratic_drag",
        scope="joint",
        parameters=(_coefficient("c", "N m s^2/rad^2", 1e4, 0.5, "drag coefficient"),),
        summary="c dq |dq|",
        reference=_OLSSON,
        meaning="Fluid or air is churned, by a fan or too much oil; it matters at full speed only.",
        torque=lambda p, s: p["c"] * s.dq * jnp.abs(s.dq),
        dissipative=True,
    )
)

register(
    TorqueLaw(
        name="nonlinear_viscous_friction",
        scope="joint",
        parameters=(
            _coefficient("c", "N m (s/rad)^alpha", 1e4, 1.0, "coefficient at 1 rad/s"),
            Parameter("alpha", "1", 0.2, 3.0, False, 0.5, "exponent (1 is plain viscous)"),
        ),
        summary="c |dq|^alpha sign(dq): power law of lubricated gears, cubic at alpha = 3",
        reference="Wahrburg et al. 2018, ICRA (power law); Khalil, Dombre 2002, ch. 9",
        meaning=(
            "The lubricant resists less than in proportion to speed, as cold or thick grease "
            "does; compensate it by this law, and warm the joint up before precise work."
        ),
        torque=lambda p, s: p["c"] * (jnp.abs(s.dq) + 1e-9) ** p["alpha"] * s.direction,
        # Beside a viscous term the exponent may run through 1 and c change its sign, as on strain-wave gears.
        replaces=("viscous_friction",),
        uses_direction=True,
        dissipative=True,
    )
)


def _load_dependent(p, s):
    load = s.static_load + p["inertial"] * (s.load - s.static_load)
    return p["mu"] * jnp.abs(load) * s.direction


register(
    TorqueLaw(
        name="load_dependent_friction",
        scope="joint",
        parameters=(
            _coefficient("mu", "1", 1.0, 0.05, "friction per load torque"),
            Parameter(
                "inertial", "1", 0.0, 1.0, False, 0.5, "share of the inertial torque that loads"
            ),
        ),
        summary="mu |tau_load| sign(dq), tau_load from the rigid-body model",
        reference="Hamon, Gautier, Garrec 2010, IROS",
        meaning=(
            "Teeth and bearings rub harder under load; friction compensation has to follow the "
            "load, and a share above a few percent points at wear or too much preload."
        ),
        torque=_load_dependent,
        shown_against="load",
        uses_load=True,
        uses_direction=True,
        dissipative=True,
    )
)


def _dahl_rate(p, s):
    # z = fc * state, so that the torque stays linear in fc: dz/dt = sigma dq (1 - z sign(dq)/fc).
    return (s.dq - jnp.abs(s.dq) * s.state) / p["x0"]


register(
    TorqueLaw(
        name="hysteresis",
        scope="joint",
        parameters=(
            _coefficient("fc", "N m", 1e4, 1.0, "level the bristle saturates at"),
            Parameter(
                "x0", "rad", 1e-4, 1.0, False, 0.05, "presliding displacement fc/sigma", "log"
            ),
        ),
        summary="Dahl bristle: dz/dt = sigma dq (1 - z sign(dq)/fc), tau = z",
        reference="Dahl 1968; Olsson et al. 1998, eq. 8",
        meaning=(
            "Before it slides the joint winds up like a spring on its bristles, so torque lags at"
            " every reversal; it limits small motions, compensate it or avoid them."
        ),
        torque=lambda p, s: p["fc"] * s.state,
        rate=_dahl_rate,
        forgets="x0",
        shown_against="position",
        derived=lambda p: {"sigma": (p["fc"] / p["x0"], "N m/rad")},
    )
)

register(
    TorqueLaw(
        name="thermal_drift",
        scope="joint",
        parameters=(
            _coefficient("fc", "N m", 1e4, 1.0, "dry friction lost when warm"),
            WARMING,
        ),
        summary="fc (exp(-t/tc) - 1) sign(dq): friction falls as the joint warms",
        reference="Carvalho Bittencourt, Gunnarsson 2012, J. Dyn. Sys. Meas. Control (thermal friction)",
        meaning="Friction falls while the joint warms up; warm it up before precise work.",
        torque=lambda p, s: p["fc"] * jnp.expm1(-s.t / p["tc"]) * s.direction,
        shown_against="time",
        uses_direction=True,
    )
)

register(
    TorqueLaw(
        name="temperature_friction",
        scope="joint",
        parameters=(
            Parameter("a", "N m/K", -100.0, 100.0, True, -0.05, "dry friction per kelvin"),
            Parameter(
                "b", "N m s/(rad K)", -100.0, 100.0, True, -0.02, "viscous friction per kelvin"
            ),
        ),
        summary="(a sign(dq) + b dq) (T - 25 deg C), where the log has a temperature",
        reference="Carvalho Bittencourt, Gunnarsson 2012, J. Dyn. Sys. Meas. Control",
        meaning="Friction changes with temperature; let the compensation follow the sensor.",
        torque=lambda p, s: (p["a"] * s.direction + p["b"] * s.dq) * (s.temperature - 25.0),
        requires=("temperature",),
        uses_direction=True,
    )
)
