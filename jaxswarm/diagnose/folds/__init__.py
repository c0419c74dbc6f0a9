"""Partialling out and cross-fitting: what the current model absorbs, on every fold."""
