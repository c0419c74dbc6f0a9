"""``python -m jaxswarm``."""

from jaxswarm.cli import command_line

command_line()
