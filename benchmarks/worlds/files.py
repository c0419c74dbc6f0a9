"""A world on disk, in the layout of the practice cases: robot file, logs, truth."""

import json
from pathlib import Path

import numpy as np

from benchmarks.worlds.arm import toml, urdf
from benchmarks.worlds.laws import LAWS, Effect
from benchmarks.worlds.simulate import DivergedError
from benchmarks.worlds.world import World

TESTS = ("test_ptp", "test_fourier")
CHECK = "check"


def declared_list(world: World) -> str:
    """What a user would give to ``--declare``."""
    return ",".join(f"{e}@joint{j + 1}" for e, j in world.declared) or "none"


def robot_file(world: World, folder: Path) -> Path:
    """Kinematics as URDF for even numbers, TOML for odd ones."""
    path = folder / ("robot.toml" if world.number % 2 else "robot.urdf")
    path.write_text(toml(world.arm) if world.number % 2 else urdf(world.arm))
    return path


def write_world(world: World, folder: Path) -> dict:
    """Write robot, ``train.npz``, the tests and ``truth.json``; returns the truth.

    ``test.npz`` is the point-to-point test under the name the practice cases use. ``*_truth.npz`` beside a
    training log holds ``tau_clean`` and ``tau_effect``; a test log holds them itself. ``edit_ptp.npz`` is
    the point-to-point test recorded without the last effect; ``check.npz``, where there is one, is a second log
    that the user has, without what is true of it.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    robot = robot_file(world, folder)
    log, hidden = world.log("train", world.runs["train"])
    np.savez_compressed(folder / "train.npz", **log)
    np.savez_compressed(folder / "train_truth.npz", **hidden)
    if CHECK in world.runs:
        np.savez_compressed(folder / f"{CHECK}.npz", **world.log(CHECK, world.runs[CHECK])[0])
    for name in TESTS:
        log, hidden = world.log(name, world.runs[name])
        np.savez_compressed(folder / f"{name}.npz", **log, **hidden)
    (folder / "test.npz").write_bytes((folder / "test_ptp.npz").read_bytes())
    edited = write_edit(world, folder)
    truth = {**world_truth(world), "robot_file": robot.name, "edited": edited}
    (folder / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")
    return truth


def write_edit(world: World, folder: Path) -> str | None:
    """The point-to-point test without the last effect; its label, or None where there is no such run."""
    edited = world.edited
    if edited is None:
        return None
    kept = tuple(e for e in world.present("test_ptp") if e is not edited)
    try:
        run = world.run("test_ptp", kept)
    except DivergedError:
        return None
    log, hidden = world.log("test_ptp", run, kept)
    np.savez_compressed(folder / "edit_ptp.npz", **log, **hidden)
    return label(edited)


def label(effect: Effect) -> str:
    """``kind@joint2:joint3`` as the diagnosis writes it."""
    where = "" if effect.joint is None else f"@joint{effect.joint + 1}"
    return effect.kind + where + ("" if effect.other is None else f":joint{effect.other + 1}")


def _entry(effect: Effect, told: dict) -> dict:
    entry = {"effect": effect.kind, "params": effect.params, **told}
    if effect.joint is not None:
        entry["joint"] = effect.joint + 1
    if effect.other is not None:
        entry["other"] = effect.other + 1
    return entry


def world_truth(world: World) -> dict:
    """What is true of a world; joints count from 1."""
    arm, logging = world.arm, world.logging
    values = {"viscous_friction": ("b", arm.viscous), "coulomb_friction": ("fc", arm.coulomb)}
    values["rotor_inertia"] = ("ia", arm.rotor)
    lists: dict[str, list] = {"effects": [], "outside": [], "inseparable": []}
    for effect, told in zip(world.effects, world.told, strict=True):
        place = "outside" if LAWS[effect.kind].outside else "effects"
        lists["inseparable" if told["inseparable"] else place].append(_entry(effect, told))
    return {
        "name": f"w{world.number:04d}",
        "robot": arm.name,
        "size": arm.size,
        "kinds": list(arm.kinds),
        "motion": world.motions["train"].family,
        "duration": world.motions["train"].seconds,
        "controller": world.control.kind,
        "control_rate": world.control.rate,
        "rate": logging.rate,
        "bits": logging.bits,
        "noise": logging.noise.tolist(),
        "logger": {
            k: getattr(logging, k)
            for k in ("coarse", "lag", "jitter", "true_stamps", "dropouts", "spikes", "dq")
        },
        "width": arm.width.tolist(),
        "declares": world.plan.declared,
        "common": world.plan.common,
        "attempt": world.attempt,
        "checked": CHECK in world.runs,
        "declared": [
            {"effect": e, "joint": j + 1, "params": {values[e][0]: float(values[e][1][j])}}
            for e, j in world.declared
        ],
        **lists,
    }
