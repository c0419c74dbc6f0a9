"""Robots as trees of joints: built-ins, files, kinematics, dynamics and the torque regressor."""

from jaxswarm.robot.build import build_robot
from jaxswarm.robot.builtin import (
    BUILTIN_ROBOTS,
    emps,
    kuka_kr300,
    kuka_kr300_cad_parameters,
    rx60,
    rx60_paper_parameters,
    tx40,
    ur10e,
)
from jaxswarm.robot.dh import robot_from_dh
from jaxswarm.robot.dynamics import bias_forces, gravity_forces, inverse_dynamics
from jaxswarm.robot.energy import kinetic_energy, momentum, potential_energy
from jaxswarm.robot.joints import Description, Joint, Limits, Mimic
from jaxswarm.robot.kinematics import forward_kinematics
from jaxswarm.robot.lanes import in_blocks
from jaxswarm.robot.load import describe_robot, load_robot
from jaxswarm.robot.mass import check_mass_matrix, forward_dynamics, mass_matrix
from jaxswarm.robot.model import Robot
from jaxswarm.robot.names import PARAMETER_SYMBOLS, PARAMETER_UNITS, standard_parameter_names
from jaxswarm.robot.options import RobotChoice, RobotOptions, parse_options
from jaxswarm.robot.regressor import regressor
from jaxswarm.robot.toml import load_toml
from jaxswarm.robot.urdf import load_urdf, robot_from_urdf

__all__ = [
    "BUILTIN_ROBOTS",
    "PARAMETER_SYMBOLS",
    "PARAMETER_UNITS",
    "Description",
    "Joint",
    "Limits",
    "Mimic",
    "Robot",
    "RobotChoice",
    "RobotOptions",
    "bias_forces",
    "build_robot",
    "check_mass_matrix",
    "describe_robot",
    "emps",
    "forward_dynamics",
    "forward_kinematics",
    "gravity_forces",
    "in_blocks",
    "inverse_dynamics",
    "kinetic_energy",
    "kuka_kr300",
    "kuka_kr300_cad_parameters",
    "load_robot",
    "load_toml",
    "load_urdf",
    "mass_matrix",
    "momentum",
    "parse_options",
    "potential_energy",
    "regressor",
    "robot_from_dh",
    "robot_from_urdf",
    "rx60",
    "rx60_paper_parameters",
    "standard_parameter_names",
    "tx40",
    "ur10e",
]
