"""The loop: find the residual, trace it to the effect the model lacks, add it, show the error."""

from jaxswarm.diagnose.decision.rules import Rules as Rules
from jaxswarm.diagnose.report.console import print_diagnosis as print_diagnosis
from jaxswarm.diagnose.selection.diagnosis import Diagnosis as Diagnosis
from jaxswarm.diagnose.selection.stepwise import diagnose as diagnose
