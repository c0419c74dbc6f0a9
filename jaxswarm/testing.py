"""Contracts as code: check what you write against what the library relies on."""

from jaxswarm.swarm.contract import check_optimizer as check_optimizer
