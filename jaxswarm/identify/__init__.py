"""Identification: base parameters, weighted least squares, swarms, uncertainty, validation."""

from jaxswarm.effects.term import Term as Term
from jaxswarm.effects.term import parse_terms as parse_terms
from jaxswarm.identify.estimation.estimate import Estimate as Estimate
from jaxswarm.identify.estimation.estimate import estimate as estimate
from jaxswarm.identify.forward.model import Model as Model
from jaxswarm.identify.forward.model import load_model as load_model
from jaxswarm.identify.forward.model import model_torque as model_torque
from jaxswarm.identify.forward.model import save_model as save_model
from jaxswarm.identify.report.console import print_identification as print_identification
