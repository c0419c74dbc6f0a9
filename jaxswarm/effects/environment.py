r"""Effects of the sensing and of the surroundings: another clock, scale, gravity, body or touch.

All but the contact change how the whole model is evaluated rather than add one joint's torque.

References: A. Janot, M. Gautier, M. Brunot 2019 (time skew on the EMPS); M. Gautier, S. Briot,
"Global identification of joint drive gains and dynamic parameters of robots", J. Dyn. Sys. Meas.
Control 136 (2014); W. Khalil, M. Gautier, P. Lemoine, ICRA 2007 (payload).
"""

from jaxswarm.effects.base import Law, Parameter, register

register(
    Law(
        name="drive_gain",
        scope="joint",
        parameters=(Parameter("gain", "1", 0.5, 2.0, False, 1.0, "measured over true torque"),),
        summary="measured torque = gain x torque",
        reference="Gautier, Briot 2014, J. Dyn. Sys. Meas. Control 136(5)",
        warp="gain",
    )
)

register(
    Law(
        name="time_delay",
        scope="global",
        parameters=(
            Parameter("seconds", "s", -0.05, 0.05, False, 0.0, "by which the torque clock lags"),
        ),
        summary="torque measured at t belongs to the motion at t - seconds",
        reference="Janot, Gautier, Brunot 2019 (EMPS, time skew)",
        warp="delay",
    )
)

register(
    Law(
        name="base_tilt",
        scope="global",
        parameters=(
            Parameter("gx", "m/s^2", -3.0, 3.0, False, 0.0, "gravity along the base x axis"),
            Parameter("gy", "m/s^2", -3.0, 3.0, False, 0.0, "gravity along the base y axis"),
        ),
        summary="gravity has components along base x and y, same magnitude",
        reference="Khalil, Dombre 2002, ch. 9",
        warp="gravity",
    )
)

_MOMENT = "kg m"
_INERTIA = "kg m^2"
register(
    Law(
        name="payload",
        scope="global",
        parameters=(
            Parameter("m", "kg", 0.0, 1e3, False, 1.0, "mass"),
            *(
                Parameter(f"mc{a}", _MOMENT, -1e3, 1e3, False, 0.0, f"first moment along {a}")
                for a in "xyz"
            ),
            *(
                Parameter(
                    f"I{a}", _INERTIA, -1e3, 1e3, False, 0.0, f"inertia {a} about the last joint"
                )
                for a in ("xx", "xy", "yy", "xz", "yz", "zz")
            ),
        ),
        summary="ten inertial parameters added to the last link, against an earlier model",
        reference="Khalil, Gautier, Lemoine 2007, ICRA",
        warp="payload",
        derived=lambda p: (
            {f"c{a}": (p[f"mc{a}"] / p["m"], "m") for a in "xyz"} if p["m"] > 0 else {}
        ),
        reference_only=True,
    )
)

register(
    Law(
        name="contact",
        scope="global",
        parameters=(
            Parameter("start", "s", 0.0, 1e6, False, 0.0, "begin of the touch"),
            Parameter("end", "s", 0.0, 1e6, False, 1.0, "end of the touch"),
            Parameter(
                "log", "1", 0.0, 1e6, False, 0.0, "number of its log, from zero", fitted=False
            ),
        ),
        summary="external torque in a time window, constant on each joint",
        reference="Haddadin, De Luca, Albu-Schaeffer 2017, IEEE T-RO 33(6)",
        warp="window",
        reference_only=True,
        recurring=True,
    )
)
