"""Physical effects a rigid body lacks: one law a function, a table of its parameters, one registry."""

from jaxswarm.effects import environment as environment
from jaxswarm.effects import friction as friction
from jaxswarm.effects import transmission as transmission
from jaxswarm.effects.base import REGISTRY as REGISTRY
from jaxswarm.effects.base import Law as Law
from jaxswarm.effects.base import Parameter as Parameter
from jaxswarm.effects.base import Sample as Sample
from jaxswarm.effects.base import get_law as get_law
from jaxswarm.effects.base import make_sample as make_sample
from jaxswarm.effects.base import register as register
