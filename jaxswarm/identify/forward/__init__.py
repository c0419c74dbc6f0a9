"""The torque a model predicts along a log: columns, measuring chain, derivatives, the model itself."""
