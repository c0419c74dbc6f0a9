"""What a log's torques lose by a misreading: beside it alone a law that extends that misreading is told."""

from collections.abc import Sequence

import numpy as np

from benchmarks.diagnosis_drawn import LATER
from jaxswarm.effects.base import REGISTRY
from jaxswarm.effects.kinds import MeasurementLaw
from jaxswarm.effects.term import Term
from jaxswarm.identify.synthetic import Noise, synthetic_log
from jaxswarm.logs.log import Log
from jaxswarm.robot import Robot

SILENT = Noise(0.0, 0.0)
# Value of a misreading's first parameter that is a tangent: a millisecond of delay.
_LITTLE = 1e-3


def extended_misreadings(
    effect: str, arm: Robot, declared: Sequence[Term], base: Log, moved: tuple[np.ndarray, ...]
) -> list[np.ndarray]:
    """The change (T, 3) of a log's torques by a little of each misreading that an effect extends.

    The log was made along the motion t (T,), q, dq, ddq (T, 3), without noise.
    """
    names = REGISTRY[effect].extends if effect in LATER else ()
    told = []
    for law in (REGISTRY[name] for name in names):
        if isinstance(law, MeasurementLaw):
            little = {p.name: p.nominal for p in law.parameters}
            little[law.parameters[0].name] = _LITTLE
            terms = (*declared, Term(law.name, None, values=little))
            log = synthetic_log(arm, terms, 0, noise=SILENT, moved=moved)
            told.append(log.tau - base.tau)
    return told
