"""Units stand in every result, and results of a fleet come from other processes."""

import copy
import pickle

from jaxswarm.effects import REGISTRY
from jaxswarm.effects.parameter import ORDER


def test_units_of_all_laws_travel_between_processes():
    units = {p.unit for law in REGISTRY.values() for p in law.parameters}
    assert ORDER in units
    for unit in units:
        for other in (pickle.loads(pickle.dumps(unit)), copy.deepcopy(unit)):
            assert other == unit and type(other) is type(unit)
            assert getattr(other, "sliding", unit) == getattr(unit, "sliding", unit)
