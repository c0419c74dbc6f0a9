r"""A load that is picked up or put down in the middle of a log.

Between two times the last link carries another body: ten inertial parameters, of which the log determines
those combinations that its motion shows, as of any link. What is carried all along belongs to the last link
and is no change; a load put down for good has a mass below zero from then on. Told from ``contact``, whose
torques do not follow the arm's posture, and from ``friction_change``, which is a matter of one joint.

Reference: W. Khalil, M. Gautier, P. Lemoine, "Identification of the payload inertial parameters of industrial
manipulators", ICRA (2007).
"""

from jaxswarm.effects.base import register
from jaxswarm.effects.bodies import body_of, body_table
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.parameter import Parameter

# A time after every log: a load that is kept.
LATEST = 1e5

register(
    BodyChange(
        name="payload_change",
        scope="global",
        parameters=(
            *body_table(linear=True),
            Parameter("start", "s", 0.1, LATEST, False, 1.0, "when it is picked up", "log"),
            Parameter("end", "s", 0.1, LATEST, False, LATEST, "when it is put down", "log"),
            Parameter(
                "log", "1", 0.0, 1e6, False, 0.0, "number of its log, from zero", fitted=False
            ),
        ),
        summary="ten inertial parameters added to the last link between two times of a log",
        reference="Khalil, Gautier, Lemoine 2007, ICRA",
        meaning=(
            "A load was picked up or put down while the log ran (put down: a mass below zero); fit "
            "the stretches apart, or tell the controller of the load."
        ),
        body=body_of,
        window=True,
        reference_only=True,
        identity=("log", "start"),
        shown_against="time",
    )
)
