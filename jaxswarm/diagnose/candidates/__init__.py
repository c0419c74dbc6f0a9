"""Candidate terms: which are eligible, and the columns each would add to the model."""
