"""The two papers as runnable studies: ``jaxswarm study rx60`` and ``jaxswarm study sepso``."""

from jaxswarm.studies.rx60.study import run_rx60
from jaxswarm.studies.sepso.study import run_sepso

STUDIES = {"rx60": run_rx60, "sepso": run_sepso}
"""Studies by the name the command line knows them by."""

__all__ = ["STUDIES", "run_rx60", "run_sepso"]
