"""The command ``excite``, from a limits file to a trajectory."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from jaxswarm import outputs, plots
from jaxswarm.identify.excitation.limits import read_limits
from jaxswarm.identify.excitation.ros import write_ros
from jaxswarm.identify.excite_plan import Plan, plan_motion
from jaxswarm.identify.forward.model import load_model
from jaxswarm.logs.write import write_table
from jaxswarm.robot.load import describe_robot, load_robot
from jaxswarm.robot.model import Robot
from jaxswarm.tables import Table


def excite_file(
    robot_spec: str,
    limits_path: Path,
    out: Path,
    effects: str | None = None,
    duration: float | None = None,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
    separate: str | None = None,
    given: Path | None = None,
) -> dict:
    """Plan a trajectory and write it as CSV and ROS message, with ``excitation.json`` and a picture.

    Args:
        robot_spec: Built-in name, ``.urdf`` or ``.toml``.
        limits_path: Limits file, see :mod:`jaxswarm.identify.excitation.limits`.
        out: Folder to write to.
        effects: Effects to be identified beside the rigid body; None: viscous and dry friction.
        duration: Length [s], filled with whole periods; None: one period.
        seed: Seed of the search.
        progress: Called with one line per stage.
        separate: Two effects to tell apart, ``A,B``; None: all parameters are to be told apart.
        given: A ``model.json`` whose masses and effects say what torque a motion needs, and which
            ``separate`` takes for granted.

    Returns:
        The content of ``excitation.json``.

    Raises:
        InputError: On anything that cannot be used; nothing is written then.
    """
    robot = load_robot(robot_spec)
    limits = read_limits(limits_path, robot.joints)
    model = None if given is None else load_model(given)
    plan, content = plan_motion(
        robot, limits, effects, duration, seed, progress, separate=separate, given=model,
        description=describe_robot(robot_spec), check=lambda: outputs.check_folder(out),
    )  # fmt: skip
    progress("writing")
    header = ["t", *(f"{x}_{j}" for x in ("q", "dq", "ddq") for j in robot.joints)]
    table = np.column_stack([plan.t, *plan.motion])
    outputs.write_results(
        out,
        {
            "trajectory.csv": lambda path: write_table(path, header, table, "%.9g"),
            "trajectory.yaml": lambda path: write_ros(path, robot.joints, plan.t, plan.motion),
            "excitation.json": outputs.to_json(content),
            "trajectory.png": plots.png(picture(plan, robot)),
        },
    )
    return content


def picture(plan: Plan, robot: Robot) -> Figure:
    """One period of every joint: position, velocity, acceleration, with their limits dashed."""
    limits = plan.limits
    t = np.linspace(0.0, 1.0 / plan.trajectory.fundamental, 600)
    motion = plan.trajectory.motion(t)
    bounds = (
        (limits.lower, limits.upper),
        (-limits.velocity, limits.velocity),
        (-limits.acceleration, limits.acceleration),
    )
    figure, axes = plots.panels(
        robot.num_joints, 3, 10.0, 1.9 * robot.num_joints + 0.8, sharex=True
    )
    for j, joint in enumerate(robot.joints):
        unit = "rad" if robot.kinds[j] == "revolute" else "m"
        labels = (f"{joint} [{unit}]", f"[{unit}/s]", f"[{unit}/s^2]")
        for k, (x, (low, high), label) in enumerate(zip(motion, bounds, labels, strict=True)):
            axis = axes[3 * j + k]
            axis.plot(t, x[:, j], color=plots.MODEL, lw=1.1)
            for limit in (low[j], high[j]):
                axis.axhline(limit, color=plots.MEASURED, lw=0.8, ls="--")
            axis.set_ylabel(label)
    for axis in axes[-3:]:
        axis.set_xlabel("time [s]")
    figure.suptitle(
        f"{robot.name}: condition number {plan.condition:.3g}, "
        f"random motions {np.median(plan.random):.3g} (median)",
        fontsize=11,
    )
    return figure


def print_excitation(result: dict, out: Path) -> None:
    """Print what a trajectory is worth and where it starts."""
    from rich.console import Console

    console = Console()
    numbers = result["condition_number"]
    console.print(
        f"condition number {numbers['after']:.4g}; random motions within the same limits "
        f"{numbers['random_median']:.4g} (median), {numbers['random_best']:.4g} (best of 20)"
    )
    apart = result.get("separation")
    if apart:
        console.print(
            f"{' and '.join(apart['effects'])}: {apart['ratio']:.3g} times as far apart as on the ordinary "
            f"exciting motion ({apart['reached']:.3g} against {apart['ordinary']:.3g})"
        )
        if apart["left_out"]:
            console.print(f"not asked whether they could imitate: {', '.join(apart['left_out'])}")
    periods = "1 period" if result["periods"] == 1 else f"{result['periods']} periods"
    console.print(
        f"{result['duration']:.6g} s, {periods} at {result['fundamental']:.4g} Hz, "
        f"{len(result['base_parameters'])} base parameters"
    )
    torque = result["torque"]
    rows = []
    for joint, used in result["limits_used"].items():
        shares = [f"{100 * share:.0f} %" for share in used.values()]
        limited = torque is not None and torque[joint]["limit"] is not None
        if torque is not None and limited:
            shares.append(f"{100 * torque[joint]['largest'] / torque[joint]['limit']:.0f} %")
        else:
            shares.append("")
        rows.append((joint, f"{result['start'][joint]:.4g}", *shares))
    head = ("joint", "starts at (rad or m)", "position", "velocity", "acceleration", "torque")
    console.print(Table("", head, tuple(rows)))
    console.print("percentages are of the limits; surroundings are not known")
    near = result["self_distance"]
    if near:
        console.print(
            f"{' and '.join(near['between'])} come as near as {near['least']:.3g} m "
            f"({near['asked']:g} m were asked for)"
        )
    for note in result["notes"]:
        console.print(f"note: {note}")
    console.print(f"written to {out / 'trajectory.csv'} and, for ROS 2, {out / 'trajectory.yaml'}")
