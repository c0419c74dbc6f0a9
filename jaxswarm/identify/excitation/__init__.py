"""Motions on which the parameters of a model can be told apart."""
