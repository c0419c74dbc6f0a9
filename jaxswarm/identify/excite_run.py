"""The command ``excite``, from a limits file to a trajectory."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from jaxswarm import outputs, plots
from jaxswarm.effects.friction import USUAL_FRICTION
from jaxswarm.effects.term import parse_terms
from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.columns import refuse_terms
from jaxswarm.identify.excitation.fourier import Fourier
from jaxswarm.identify.excitation.limits import Limits, read_limits
from jaxswarm.identify.excitation.search import Excitation, excite
from jaxswarm.logs.write import write_table
from jaxswarm.robot.load import load_robot
from jaxswarm.robot.model import Robot

# Length of a period [s] where neither the file nor the duration says otherwise.
_PERIOD = 10.0
_MOST_SAMPLES = 2_000_000


def excite_file(
    robot_spec: str,
    limits_path: Path,
    out: Path,
    effects: str | None = None,
    duration: float | None = None,
    seed: int = 0,
    progress: Callable[[str], None] = lambda text: None,
) -> dict:
    """Plan an exciting trajectory and write ``trajectory.csv``, ``excitation.json``, ``trajectory.png``.

    Args:
        robot_spec: Built-in name, ``.urdf`` or ``.toml``.
        limits_path: Limits file, see :mod:`jaxswarm.identify.excitation.limits`.
        out: Folder to write to.
        effects: Effects to be identified beside the rigid body; None: viscous and dry friction.
        duration: Length [s], filled with whole periods; None: one period.
        seed: Seed of the search.
        progress: Called with one line per stage.

    Returns:
        The content of ``excitation.json``.

    Raises:
        InputError: On anything that cannot be used; nothing is written then.
    """
    robot = load_robot(robot_spec)
    terms = parse_terms(USUAL_FRICTION if effects is None else effects, robot.joints)
    refuse_terms(terms, robot.joints)
    limits = read_limits(limits_path, robot.joints)
    outputs.check_folder(out)
    periods, samples = schedule(limits, duration)
    limits = replace(limits, fundamental=limits.rate / samples)
    found = excite(robot, terms, limits, limits.fundamental, seed=seed, progress=progress)
    t = np.arange(periods * samples + 1) / limits.rate
    motion = found.trajectory.motion(t)
    result = {
        "robot": robot.name,
        "joints": list(robot.joints),
        "effects": [term.label(robot.joints) for term in terms],
        "duration": float(t[-1]),
        "periods": periods,
        "rate": limits.rate,
        "fundamental": limits.fundamental,
        "harmonics": limits.harmonics,
        "condition_number": {
            "before": found.random[0],
            "after": found.condition,
            "random_median": float(np.median(found.random)),
            "random_best": found.random.min(),
        },
        "base_parameters": list(found.base.expressions()),
        "evaluations": found.evaluations,
        "seed": seed,
        "start": dict(zip(robot.joints, motion[0][0], strict=True)),
        "coefficients": coefficients(found.trajectory, robot.joints),
        "limits_used": {
            joint: dict(zip(("position", "velocity", "acceleration"), row, strict=True))
            for joint, row in zip(robot.joints, found.used, strict=True)
        },
        "law": "q = offset + sum over l of sine[l] sin(2 pi l fundamental t) + cosine[l] cos(..)",
    }
    progress("writing")
    header = ["t", *(f"{x}_{j}" for x in ("q", "dq", "ddq") for j in robot.joints)]
    table = np.column_stack([t, *motion])

    def write(path: Path) -> None:
        write_table(path, header, table, "%.9g")

    outputs.write_results(
        out,
        {
            "trajectory.csv": write,
            "excitation.json": outputs.to_json(result),
            "trajectory.png": plots.png(picture(found, limits, robot)),
        },
    )
    return result


def schedule(limits: Limits, duration: float | None) -> tuple[int, int]:
    """Number of periods, and of samples in one, so that both ends of the motion are samples.

    Raises:
        InputError: If a period has too few samples for its harmonics, or there are too many in all.

    >>> schedule(Limits(*np.ones((4, 1)), rate=100.0), 25.0)
    (2, 1250)
    """
    if duration is not None and not 0.0 < duration < np.inf:
        raise InputError(f"--duration {duration}: a finite time above zero is needed")
    whole = duration or 1.0 / (limits.fundamental or 1.0 / _PERIOD)
    periods = max(1, round(whole * (limits.fundamental or 1.0 / _PERIOD)))
    period = whole / periods if limits.fundamental is None else 1.0 / limits.fundamental
    if period * periods * limits.rate > _MOST_SAMPLES:
        raise InputError(
            f"{period * periods * limits.rate:.3g} samples are too many (at most {_MOST_SAMPLES}); "
            "shorten --duration or lower rate in the limits file"
        )
    samples = round(period * limits.rate)
    if samples < 10 * limits.harmonics:
        raise InputError(
            f"{samples} samples in a period of {period:.4g} s are too few for {limits.harmonics} "
            "harmonics; raise rate or the duration, or lower fundamental or harmonics"
        )
    return periods, samples


def coefficients(trajectory: Fourier, joints: tuple[str, ...]) -> dict:
    """The numbers of a trajectory by joint."""
    parts = zip(joints, trajectory.offset, trajectory.sine, trajectory.cosine, strict=True)
    return {joint: {"offset": q, "sine": s, "cosine": c} for joint, q, s, c in parts}


def picture(found: Excitation, limits: Limits, robot: Robot) -> Figure:
    """One period of every joint: position, velocity, acceleration, with their limits dashed."""
    t = np.linspace(0.0, 1.0 / found.trajectory.fundamental, 600)
    motion = found.trajectory.motion(t)
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
        f"{robot.name}: condition number {found.condition:.3g}, "
        f"random motions {np.median(found.random):.3g} (median)",
        fontsize=11,
    )
    return figure


def print_excitation(result: dict, out: Path) -> None:
    """Print what a trajectory is worth and where it starts."""
    from rich.console import Console
    from rich.table import Table

    console = Console()
    numbers = result["condition_number"]
    console.print(
        f"condition number {numbers['after']:.4g}; random motions within the same limits "
        f"{numbers['random_median']:.4g} (median), {numbers['random_best']:.4g} (best of 20)"
    )
    console.print(
        f"{result['duration']:.6g} s, {result['periods']} periods at {result['fundamental']:.4g} Hz, "
        f"{len(result['base_parameters'])} base parameters"
    )
    table = Table("joint", "starts at", "position", "velocity", "acceleration")
    for joint, used in result["limits_used"].items():
        shares = (f"{100 * share:.0f} %" for share in used.values())
        table.add_row(joint, f"{result['start'][joint]:.4g}", *shares)
    console.print(table)
    console.print("shares are of the limits; collisions and torque limits are not checked")
    console.print(f"written to {out / 'trajectory.csv'}")
