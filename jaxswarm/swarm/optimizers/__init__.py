"""Optimizers over the unit cube: one algorithm a file, parts that compose, wrappers."""
