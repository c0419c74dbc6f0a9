"""A closed-form law for what no known law explains."""
