"""What it cannot see.

What a motion does not show is no matter of method. A base parameter stands for a sum of link parameters, and
only the sum is known; ``jaxswarm inspect`` names what never shows itself alone in a log. On a single slide
the mass, the rotor and a load are one number:

>>> import numpy as np
>>> import jaxswarm
>>> t = np.arange(0.0, 8.0, 0.01)
>>> q = 0.2 * np.sin(2.5 * t) + 0.05 * np.sin(7.0 * t)
>>> dq, ddq = np.gradient(q, t), np.gradient(np.gradient(q, t), t)
>>> force = 20.0 * ddq + 30.0 * dq + 0.1 * np.random.default_rng(0).normal(size=t.size)
>>> log = jaxswarm.log_from_arrays(t, q, force, joints=("slide",))
>>> found = jaxswarm.identify(log, "emps", "viscous_friction,rotor_inertia")
>>> [(row["name"], row["expression"]) for row in found["base_parameters"]]
[('m1', 'm1 + ia_slide'), ('b_slide', 'b_slide')]

A wrong scale of a joint's torque scales its parameters. Friction that varies with position looks like one that
varies with load in a vertical plane. Backlash shows only where the load changes sign, breakaway only after
rest, heat only in minutes, a soft joint only near its resonance. Effects below a fifth of a joint's squared
residual are not named, and torques are compared below a cutoff: no ripple at speed, no short impacts.

Bristles and elements that stick and slip by themselves (LuGre, generalized Maxwell slip) are told as
``hysteresis`` until their difference from it, a tenth of its torque where they bend by a few hundredths of a
radian, stands out of the noise; ``lugre_friction`` and ``maxwell_slip`` are then asked beside it. Where
masses are unknown they take up wrong geometry: on simulated RX60 logs a link drawn 150 mm too short leaves
about what the noise does.

A model is only as wide as its motion. What was shown on other motion of the same kind may fail at twice the
speed, with a load, or when warm: log what the arm will do, and give it as ``--validation``.

There are no closed loops of joints and no floating base, contacts with surroundings are constant torques in
a window of time, and drive gains are taken as given.
"""
