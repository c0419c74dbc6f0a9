"""From columns to parameters: base parameters, least squares, nonlinear parameters, doubt, validation."""
