"""Finds the physical effect a robot model lacks; on a swarm engine for JAX.

The public names, by topic; each is loaded when it is first used, so that the command line starts fast.

>>> import jax, jaxswarm
>>> space = jaxswarm.Space(x=(-5.0, 5.0))
>>> result = jaxswarm.minimize(
...     lambda p, a: (p["x"] - a) ** 2, jaxswarm.gpso(20), space, jax.random.key(0), 2.0, num_steps=60
... )
>>> round(float(result.params["x"]), 2)
2.0
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any

# The one place of the version; what changed in it is in CHANGES.md beside this file.
__version__ = "0.1.0"

_PLACES = {
    "jaxswarm.swarm": (
        *("Bound", "Space", "minimize", "minimize_runs", "minimize_resumable", "minimize_sharded"),
        *("polish", "save", "restore", "Result", "OPTIMIZERS", "find_optimizer"),
        *("Choice", "around", "Driver", "averaged", "recommend", "reevaluate", "time_limit"),
        *("constrained", "feasibility_rules", "epsilon_level", "augmented_lagrangian"),
        *("nsga2", "mopso", "front", "Front", "hypervolume"),
        *("pso", "spso", "gpso", "sepso", "aelspso", "ga", "textbook_ga", "spso2011", "clpso"),
        *("de", "shade", "lshade", "cma_es", "ipop_cma_es", "bipop_cma_es", "sep_cma_es"),
        *("lm_ma_es", "snes", "open_es", "auto", "random_search"),
        *("elitist_learning", "restart", "islands", "freeze"),
        *("global_best", "ring", "von_neumann", "random_informants"),
        *("clip", "absorb", "bounce", "reflect", "periodic", "resample"),
        *("target", "stalled", "collapsed", "any_of", "schedules"),
    ),
    # What one needs to write an optimizer, a topology, a boundary, a rule or a schedule of one's own.
    "jaxswarm.swarm.own": (
        *("Info", "Optimizer", "State", "Swarm", "Progress", "Random", "fold"),
        *("at_least", "best_of", "candidate_info", "comparable"),
        *("pytree", "static", "replace", "as_part", "coefficient", "evaluate", "check_optimizer"),
    ),
    "jaxswarm.robot": (
        *("Robot", "build_robot", "load_robot", "BUILTIN_ROBOTS", "rx60", "tx40", "ur10e", "emps"),
        *(
            "kuka_kr300",
            "forward_kinematics",
            "inverse_dynamics",
            "forward_dynamics",
            "mass_matrix",
        ),
        *("gravity_forces", "bias_forces", "regressor", "standard_parameter_names"),
    ),
    "jaxswarm.effects": ("Law", "Parameter", "Sample", "register", "get_law"),
    "jaxswarm.logs": ("Log", "log_from_arrays", "read_log", "write_log", "summarize"),
    "jaxswarm.logs.motion": ("Filtering", "Motion", "prepare"),
    "jaxswarm.identify": (
        *("Term", "parse_terms", "Estimate", "estimate", "Model", "model_torque", "save_model"),
        "load_model",
    ),
    "jaxswarm.diagnose": ("Rules", "Diagnosis"),
    "jaxswarm.tasks": (
        *("identify", "diagnose", "compare", "predict", "excite", "simulate", "export"),
        "inspect",
    ),
}
_HOME = {name: place for place, names in _PLACES.items() for name in names}
__all__ = sorted(_HOME)


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'jaxswarm' has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])


def _function(name: str) -> property:
    """The task of this name, whatever Python sets there when it imports the subpackage of this name."""
    return property(lambda module: __getattr__(name), lambda module, value: None)


class _Package(ModuleType):
    """``jaxswarm`` itself: its tasks are functions, also those that share their name with a subpackage."""

    identify = _function("identify")
    diagnose = _function("diagnose")
    simulate = _function("simulate")


sys.modules[__name__].__class__ = _Package
