"""Contracts as code: check what you write against what the library relies on."""

from jaxswarm.effects.contract import check_effect as check_effect
from jaxswarm.swarm.contract import check_optimizer as check_optimizer
