"""Your effect.

A law is a function of one sample and a table of bounded parameters with units. Parameters that the torque is
linear in are solved for, the others searched within their bounds.

>>> from jaxswarm.effects import Law, Parameter
>>> from jaxswarm.testing import check_effect
>>> cable = Law(
...     name="cable_twist",
...     scope="joint",
...     parameters=(Parameter("k", "N m/rad^3", 0.0, 100.0, True, 1.0, "stiffening of the cable"),),
...     summary="k q^3",
...     reference="own measurement",
...     torque=lambda p, s: p["k"] * s.q**3,
... )
>>> check_effect(cable)

``check_effect`` says in a sentence which property that others rely on does not hold: finite derivatives at
rest, zero where all linear parameters are, a dissipative law that never drives, units. Put the law into a
file with ``jaxswarm.effects.register(cable)`` at its end, and every command knows it with
``--effects-from my_laws.py``: to declare, to be asked of a residual, to predict and simulate. The file is
run, so pass only what you have read.

Where it acts decides its kind: ``TorqueLaw`` at a joint, ``TransmissionLaw`` between motor and link,
``BodyChange`` for gravity and inertia, ``ExternalTorque`` in a window of time, ``MeasurementLaw`` for what is
written down of a torque or a position. If no law is known, ``jaxswarm diagnose ... --discover`` searches a
formula and writes it as such a file.
"""
