"""Identification: base parameters, weighted least squares, swarms, uncertainty, validation."""

from jaxswarm.identify.console import print_identification as print_identification
from jaxswarm.identify.estimate import Estimate as Estimate
from jaxswarm.identify.estimate import estimate as estimate
from jaxswarm.identify.model import Model as Model
from jaxswarm.identify.model import load_model as load_model
from jaxswarm.identify.model import model_torque as model_torque
from jaxswarm.identify.model import save_model as save_model
from jaxswarm.identify.terms import Term as Term
from jaxswarm.identify.terms import parse_terms as parse_terms
