"""Torques of the surroundings."""

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import ExternalTorque
from jaxswarm.effects.parameter import Parameter

register(
    ExternalTorque(
        name="contact",
        scope="global",
        parameters=(
            Parameter("start", "s", 0.0, 1e6, False, 0.0, "begin of the contact"),
            Parameter("end", "s", 0.0, 1e6, False, 1.0, "end of the contact"),
            Parameter(
                "log", "1", 0.0, 1e6, False, 0.0, "number of its log, from zero", fitted=False
            ),
        ),
        summary="external torque in a time window, constant on each joint",
        reference="Haddadin, De Luca, Albu-Schaeffer 2017, IEEE T-RO 33(6)",
        meaning=(
            "Something pushed the arm for a while: a person, an obstacle or a process; leave that"
            " stretch out, or record again without it."
        ),
        shown_against="time",
    )
)
