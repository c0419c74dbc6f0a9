"""What a user wants done, from arrays, logs, robots and models in memory; each command calls one of these.

Every task runs in double precision, whatever the session's setting, and gives a
:class:`jaxswarm.tables.Result`: a dictionary that shows itself as tables.
"""

from importlib import import_module
from typing import Any

_PLACES = {
    "compare": "comparison",
    "diagnose": "diagnosis",
    "excite": "excitation",
    "export": "exporting",
    "identify": "identification",
    "inspect": "inspection",
    "predict": "prediction",
    "simulate": "simulation",
}
__all__ = sorted(_PLACES)


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'jaxswarm.tasks' has no attribute {name!r}")
    return getattr(import_module(f"jaxswarm.tasks.{_PLACES[name]}"), name)
