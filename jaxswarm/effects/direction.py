"""Whether a law looks at the way a joint moves."""

from functools import cache

from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.sample import make_sample


@cache
def follows_direction(law: TorqueLaw) -> bool:
    """Whether a law has another torque where its joint moves the other way; one that remembers has.

    >>> from jaxswarm.effects.base import get_law
    >>> [follows_direction(get_law(n)) for n in ("cubic_spring", "position_dependent_friction")]
    [False, True]
    """
    if law.rate is not None or law.torque is None:
        return True
    p = {q.name: 1.0 if q.linear else q.nominal for q in law.parameters}
    still = {"q": 0.5, "load": 1.0, "static_load": 1.0, "temperature": 30.0, "q_other": 0.7}
    one, two = (law.torque(p, make_sample(**still, dq=v, direction=v)) for v in (1.0, -1.0))
    return bool(one != two)
