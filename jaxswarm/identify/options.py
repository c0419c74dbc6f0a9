"""How to identify: the options of the command, and what they do to an estimate by least squares."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from jaxswarm.errors import InputError, nearest
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.physical.enforce import consistency_of, consistency_report, with_bodies
from jaxswarm.identify.physical.physical_model import PULL
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot.load import load_robot


@dataclass(frozen=True)
class Options:
    """How to identify or diagnose; the fields are the options of the command line."""

    optimizer: str = "least_squares"
    runs: int = 10
    steps: int = 500
    whiten: bool = True
    seed: int = 0
    motion_cutoff: float | None = None
    torque_cutoff: float | None = None
    estimator: str = "least_squares"
    physical: bool = False
    prior: str | None = None
    prior_weight: float = PULL
    accept: tuple[str, ...] = ()
    budget: float | None = None
    discover: bool = False
    command: str | None = None  # the words it was asked with, told in the result

    @property
    def filtering(self) -> Filtering:
        """The frequencies asked for."""
        return Filtering(self.motion_cutoff, self.torque_cutoff)


# Simulation and swarms are loaded for those who ask for them.
def _by_instruments(found: Estimate) -> tuple[Estimate, dict]:
    from jaxswarm.identify.simulation_error.from_log import by_instruments

    return by_instruments(found)


def _by_output_error(found: Estimate) -> tuple[Estimate, dict]:
    from jaxswarm.identify.simulation_error.from_log import by_output_error

    return by_output_error(found)


ESTIMATORS: dict[str, Callable[[Estimate], tuple[Estimate, dict]]] = {
    "least_squares": lambda found: (found, {"name": "least_squares"}),
    "instrumental": _by_instruments,
    "output_error": _by_output_error,
}


def check_options(options: Options) -> None:
    """Refuse options that do not exist or exclude each other, before any work."""
    if options.estimator not in ESTIMATORS:
        raise InputError(
            f"unknown estimator {options.estimator!r}. {nearest(options.estimator, ESTIMATORS)}"
        )
    if options.optimizer != "least_squares":
        from jaxswarm.swarm import find_optimizer

        find_optimizer(options.optimizer)
        if options.estimator != "least_squares":
            raise InputError("a swarm searches the least-squares problem: leave out one of both")
    if not 0.0 < options.prior_weight < np.inf:
        raise InputError(f"prior weight {options.prior_weight}: give a number above zero")


def consistency_told(found: Estimate) -> dict:
    """Whether rigid bodies can have the parameters, and the nearest ones, as plain data."""
    return consistency_report(found, consistency_of(found), False, None, PULL)


def refined(found: Estimate, options: Options, progress) -> tuple[Estimate, dict, dict]:
    """The estimate by the estimator asked for, with bodies where asked for, and what to tell of both."""
    if options.estimator != "least_squares":
        progress(f"estimating by {options.estimator}")
    found, told = ESTIMATORS[options.estimator](found)
    progress("asking whether rigid bodies can have these parameters")
    prior = None if options.prior is None else load_robot(options.prior)
    bodies = consistency_of(found, prior, options.prior_weight)
    consistency = consistency_report(
        found, bodies, options.physical, options.prior, options.prior_weight
    )
    return (with_bodies(found, bodies) if options.physical else found), told, consistency
