"""Worlds that this project did not write: MuJoCo arms, controllers, sensors, undeclared effects.

Nothing of jaxswarm's dynamics, laws or filters is used to make a log or to weigh an effect. World ``k``
is drawn from its number alone, so it is the same world in every process and on every machine.
"""
