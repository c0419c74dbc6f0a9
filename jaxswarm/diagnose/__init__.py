"""The loop: find the residual, trace it to the effect the model lacks, add it, show the error."""

from jaxswarm.diagnose.console import print_diagnosis as print_diagnosis
from jaxswarm.diagnose.decide import Rules as Rules
from jaxswarm.diagnose.loop import Diagnosis as Diagnosis
from jaxswarm.diagnose.loop import diagnose as diagnose
