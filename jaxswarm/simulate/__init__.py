"""Motion from torque: a robot with its effects and its controller, integrated in time."""
