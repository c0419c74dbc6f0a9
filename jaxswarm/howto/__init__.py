"""How to go on with what is yours: chapters, the first of what ``python -m jaxswarm.reference`` prints."""
