"""One diagnosis of one world, through the public functions, against what is true of it."""

import json
import tempfile
import time
from pathlib import Path

import numpy as np

from benchmarks.worlds import plain
from benchmarks.worlds.edit import EDIT, edit_oracle, without
from benchmarks.worlds.files import CHECK, TESTS, declared_list, label, write_world
from benchmarks.worlds.intervals import interval_hits, true_values
from benchmarks.worlds.laws import LAWS
from benchmarks.worlds.world import World
from jaxswarm.diagnose.run import diagnose_files
from jaxswarm.diagnose.selection.what_moves import fit_of_what_moves
from jaxswarm.effects import REGISTRY
from jaxswarm.identify.predict import predict_file
from jaxswarm.identify.run import identify_files

# Harm: an error on unseen motion this many times the declared model's, and above the noise.
HARM = 1.1
# A verdict that all is explained contradicts an error on the fitted log beyond this many floors.
NEAR_NOISE = 2.5
_CONTENT = ("nothing missing", "explained")


def score_world(world: World) -> dict:
    """Write, diagnose and score a world; the row of the table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        truth = write_world(world, folder)
        robot, declare = str(folder / truth["robot_file"]), declared_list(world)
        row = {key: truth[key] for key in COPIED}
        row |= {key: labels_of(truth[key]) for key in ("effects", "outside", "inseparable")}
        row["world"] = world.number
        start = time.perf_counter()
        log, stage = [folder / "train.npz"], "diagnose"
        try:  # a crash is a row too: it must not end the run
            check = [folder / f"{CHECK}.npz"] if truth["checked"] else None
            result = diagnose_files(log, robot, declare, folder / "final", check)
            row["seconds"] = time.perf_counter() - start
            row |= _names(result, world)
            stage = "identify"
            identify_files(log, robot, declare, folder / "declared", settled=fit_of_what_moves)
            stage = "predict"
            row |= _errors(world, folder)
            row |= _edit(world, folder, truth, row)
        except Exception as error:
            row["error"] = f"{stage}: {type(error).__name__}: {error}"[:300]
    return row


COPIED = (
    "name", "robot", "size", "motion", "duration", "controller", "control_rate", "rate", "declares",
    "common", "attempt", "checked",
)  # fmt: skip


def labels_of(entries: list[dict]) -> list[dict]:
    return [
        {
            "label": place_label(e["effect"], e.get("joint"), e.get("other")),
            "kind": e["effect"],
            "ratio": e["ratio"],
            "visible": e["visible"],
        }
        for e in entries
    ]


def place_label(effect: str, joint, other) -> str:
    """``kind@joint2:joint3`` from names of joints, or from numbers that count from 1."""
    names = [f"joint{x}" if isinstance(x, int) else x for x in (joint, other) if x is not None]
    return effect + ("@" if names else "") + ":".join(names)


def _names(result: dict, world: World) -> dict:
    """What was added, undecided and unexplained; parameters against their intervals."""
    added = [place_label(e["effect"], e["joint"], e.get("other")) for e in result["effects"]]
    intervals = []
    for effect in world.effects:
        for entry in result["effects"]:
            if place_label(entry["effect"], entry["joint"], entry.get("other")) == label(effect):
                intervals += interval_hits(entry, true_values(effect, world))
    return {
        "added": added,
        "undecided": [
            {"joint": u.get("joint"), "effects": u["effects"]} for u in result.get("undecided", [])
        ],
        "unexplained": [
            {"joint": u["joint"], "depends_on": u["depends_on"], "share": u["share"]}
            for u in result.get("unexplained", [])
        ],
        "verdict": result["verdict"],
        "proof": result.get("proof"),
        "residual_over_noise": result.get("residual_over_noise"),
        "known": [kind for kind in LAWS if kind in REGISTRY],
        "intervals": intervals,
    }


def _predicted(model: Path, log: Path, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    predict_file(model, log, folder / "predicted.csv")
    table = np.loadtxt(folder / "predicted.csv", delimiter=",", skiprows=1)
    return table[:, 0], table[:, 1:]


def _errors(world: World, folder: Path) -> dict:
    """Errors per joint of declared, final and oracle models, on the fitted and the unseen logs."""
    logs = {name: _load(folder, name) for name in ("train", *TESTS)}
    floor = plain.oracle_error(world, logs)
    noise, rate = plain.band_noise(world), world.logging.rate
    models = {k: folder / k / "model.json" for k in ("declared", "final")}
    if not models["final"].exists():  # refused to decide: the declared model stands
        models["final"] = models["declared"]
    errors = {"floor": {k: np.maximum(v, noise) for k, v in floor.items()}}
    for which, path in models.items():
        errors[which] = {}
        for name, (_, hidden) in logs.items():
            t, tau = _predicted(path, folder / f"{name}.npz", folder)
            errors[which][name] = plain.prediction_error(t, tau, hidden["tau_clean"], rate)
    harmed, above = _harm(errors, dict.fromkeys(TESTS, noise)), _harm(errors, errors["floor"])
    told = json.loads((folder / "final" / "diagnosis.json").read_text())
    worst = float((errors["final"]["train"] / errors["floor"]["train"]).max())
    return {
        "noise": noise.tolist(),
        "errors": {k: {m: v.tolist() for m, v in e.items()} for k, e in errors.items()},
        "harm": harmed,
        "harm_above_floor": above,
        "train_over_floor": worst,
        "consistent": not (told["verdict"] in _CONTENT and worst > NEAR_NOISE),
    }


def _harm(errors: dict, least: dict) -> list[str]:
    """Where the diagnosis made the prediction of unseen motion worse, beyond ``least`` on its joint."""
    harmed = []
    for name in TESTS:
        rows = zip(errors["declared"][name], errors["final"][name], least[name], strict=True)
        for j, (old, new, enough) in enumerate(rows, 1):
            if new > max(HARM * old, enough):
                harmed.append(f"{name} joint{j}: {old:.3g} -> {new:.3g}")
    return harmed


def _load(folder: Path, name: str) -> tuple[dict, dict]:
    log = dict(np.load(folder / f"{name}.npz"))
    extra = folder / f"{name}_truth.npz"
    return log, dict(np.load(extra)) if extra.exists() else log


def _edit(world: World, folder: Path, truth: dict, row: dict) -> dict:
    """The edit test of :mod:`edit`.

    ``strict``: passed with all that the term holds deleted, against the whole model and the floor alone.
    """
    model = folder / "final" / "model.json"
    if truth["edited"] is None or truth["edited"] not in row["added"] or not model.exists():
        return {"edit": None}
    logs = {name: _load(folder, name) for name in ("train", "edit_ptp")}

    def error(left) -> np.ndarray:
        content = json.loads(model.read_text())
        terms = []
        for term in content["terms"]:
            named = place_label(term["effect"], term["joint"], term["other"]) == truth["edited"]
            terms += filter(None, [left(term) if named else term])
        (folder / "edited.json").write_text(json.dumps({**content, "terms": terms}))
        t, tau = _predicted(folder / "edited.json", folder / "edit_ptp.npz", folder)
        return plain.prediction_error(t, tau, logs["edit_ptp"][1]["tau_clean"], world.logging.rate)

    found, deleted = error(without), error(lambda term: None)
    oracle = edit_oracle(world, logs)
    whole = np.maximum(row["errors"]["final"]["test_ptp"], row["errors"]["floor"]["test_ptp"])
    return {
        "edit": {
            "label": truth["edited"],
            "error": found.tolist(),
            "oracle": oracle.tolist(),
            "passed": bool((found <= EDIT * np.maximum(whole, oracle)).all()),
            "strict": bool((deleted <= EDIT * whole).all()),
        }
    }
