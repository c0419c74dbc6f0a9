"""Commands that are killed and starved: each in a folder of its own, with the same bytes at any time."""

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from benchmarks.trust import good
from jaxswarm.manifest import MANIFEST

ROOT = Path(__file__).resolve().parents[2]
OUT = "out"
# Results that hold measured times; every other file is compared as it is.
STUDIES = ("rx60", "sepso")
_SEARCH = """
import sys, jax, numpy as np
jax.config.update("jax_enable_x64", True)
from pathlib import Path
from jaxswarm.swarm import Space, cma_es, minimize_resumable, sepso, shade
space = Space.vector([-5.0] * 8, [5.0] * 8)
cost = lambda x, args: (x**2 - 10 * jax.numpy.cos(2 * jax.numpy.pi * x)).sum()
for name, optimizer in {"cma_es": cma_es(), "shade": shade(), "sepso": sepso()}.items():
    found = minimize_resumable(cost, optimizer, space, jax.random.key(1), num_steps=1000, path=name + ".ckpt",
                               every=50)
    Path("out").mkdir(exist_ok=True)
    Path("out/" + name).write_bytes(np.asarray(found.params).tobytes() + np.asarray(found.value).tobytes())
"""
_ARM = ("--robot", "arm.toml")
_COMMAND = ("-m", "jaxswarm")
JOBS: dict[str, tuple[str, ...]] = {
    "identify": (
        *(*_COMMAND, "identify", "log.csv", *_ARM, "--out", OUT, "--effects", "viscous_friction"),
        *("--optimizer", "sepso", "--steps", "200"),
    ),
    "diagnose": (
        *(*_COMMAND, "diagnose", "log.csv", *_ARM, "--out", OUT),
        *("--declare", "viscous_friction,coulomb_friction@joint1"),
    ),
    "diagnose --model": (
        *(*_COMMAND, "diagnose", "log.csv", *_ARM, "--out", OUT),
        *("--model", "model.json"),
    ),
    "fleet": (*_COMMAND, "diagnose", "--fleet", "logs", *_ARM, "--out", OUT, "--workers", "1"),
    "study": (*_COMMAND, "study", "rx60", "--fast", "--out", OUT),
    "minimize_resumable": ("-c", _SEARCH),
}


def prepare(folder: Path) -> Path:
    """A folder with a log that lacks friction, its robot, and a model without a load."""
    folder.mkdir(parents=True)
    table = dict(columns_with_friction())
    good.write_csv(folder / "log.csv", table)
    for arm in ("arm1", "arm2"):
        (folder / "logs" / arm).mkdir(parents=True)
        good.write_csv(folder / "logs" / arm / "2026-01-05.csv", table)
    (folder / "arm.toml").write_text(good.TOML)
    (folder / "model.json").write_text(good.model_json())
    return folder


def columns_with_friction() -> dict[str, np.ndarray]:
    """The right log with friction on both joints."""
    table = dict(good.columns())
    for joint in good.JOINTS:
        dq = table[f"dq_{joint}"]
        table[f"tau_{joint}"] = table[f"tau_{joint}"] + 2.0 * dq + 1.5 * np.tanh(dq / 0.02)
    return table


def start(job: str, folder: Path, prefix: str = "", **environment: str) -> subprocess.Popen:
    """Begin a job in its folder; ``prefix`` are words of a shell before it, such as a limit."""
    surroundings = {**os.environ, "PYTHONPATH": str(ROOT), "JAX_ENABLE_X64": "1", **environment}
    words = [sys.executable, *JOBS[job]]
    if prefix:
        words = ["sh", "-c", f'{prefix}; exec "$0" "$@"', *words]
    return subprocess.Popen(
        words, cwd=folder, env=surroundings, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


def finish(process: subprocess.Popen) -> tuple[int, str]:
    """Exit code and stderr of a job that may end."""
    _, told = process.communicate(timeout=900)
    return process.returncode, told.decode("utf-8", "replace")


def content(folder: Path) -> dict[str, str]:
    """Digests of everything a job left in its output, by name, but for times that a study measures."""
    place = folder / OUT
    files = sorted(p for p in place.rglob("*") if p.is_file()) if place.is_dir() else []
    return {str(p.relative_to(place)): _digest(p) for p in files if p.name != MANIFEST}


def _digest(path: Path) -> str:
    data = path.read_bytes()
    if path.name == "diagnosis.json" and path.parent.name != OUT:
        # A log of a fleet knows its address and when it was written, by which it is not done again.
        data = json.dumps({**json.loads(data), "fleet": None}).encode()
    if path.suffix == ".json" and path.name.startswith(STUDIES):
        data = json.dumps(_untimed(json.loads(data))).encode()
    return hashlib.sha256(data).hexdigest()


def _untimed(content):
    if isinstance(content, dict):
        kept = {k: v for k, v in content.items() if not k.startswith("seconds")}
        return {k: _untimed(v) for k, v in kept.items()}
    return [_untimed(v) for v in content] if isinstance(content, list) else content
