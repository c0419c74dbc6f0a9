"""``python -m jaxswarm``."""

from jaxswarm.cli import main

main()
