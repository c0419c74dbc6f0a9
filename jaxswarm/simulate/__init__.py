"""Motion from torque: a robot with its effects and its controller, integrated in time."""

from jaxswarm.robot.trig import polynomial_sincos
from jaxswarm.simulate.acceleration import Drive, State, accelerations, rest
from jaxswarm.simulate.controllers import PD, Cascade, ComputedTorque, Controller, Reference
from jaxswarm.simulate.loops import Loop, closed_loop, open_loop
from jaxswarm.simulate.measure import measured_torque
from jaxswarm.simulate.plant import Acting, Plant, make_plant
from jaxswarm.simulate.rollout import Trajectory, simulate, track
from jaxswarm.simulate.stability import check_step, fastest_mode, stable_substeps

__all__ = [
    "PD",
    "Acting",
    "Cascade",
    "ComputedTorque",
    "Controller",
    "Drive",
    "Loop",
    "Plant",
    "Reference",
    "State",
    "Trajectory",
    "accelerations",
    "check_step",
    "closed_loop",
    "fastest_mode",
    "make_plant",
    "measured_torque",
    "open_loop",
    "polynomial_sincos",
    "rest",
    "simulate",
    "stable_substeps",
    "track",
]
