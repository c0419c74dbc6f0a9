"""Estimators that do not need differentiated positions: output error, instrumental variables."""
