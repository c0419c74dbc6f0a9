"""What a bug report needs: versions, devices, cache, threads, and whether known numbers come out."""

import importlib.metadata
import os
import platform
import time
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.logs import log_from_arrays
from jaxswarm.tables import Result, Table
from jaxswarm.tasks.identification import identify
from jaxswarm.tasks.inputs import in_double

PACKAGES = (
    "jaxswarm",
    "jax",
    "jaxlib",
    "numpy",
    "scipy",
    "optax",
    "chex",
    "matplotlib",
    "rich",
    "typer",
)
OPTIONAL = ("pyarrow", "rosbags", "pooch")
# A slide of known mass and friction without noise: what is left is the error of differentiation.
_TRUTH = {"m1": 20.0, "b_slide": 30.0, "fc_slide": 5.0}
_ACCURACY = 0.01


def _version(name: str) -> str | None:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return None


def doctor(progress: Callable[[str], None] = lambda text: None) -> Result:
    """Look at the installation and identify a slide whose parameters are known.

    Args:
        progress: Called with one line per stage.

    Returns:
        ``healthy``, versions, devices, settings, and the identified numbers beside the true ones.
    """
    # Asked before the double precision of the check is set.
    double = bool(jax.config.jax_enable_x64)  # type: ignore[attr-defined]
    found = {
        "system": platform.platform(),
        "python": platform.python_version(),
        "versions": {name: _version(name) for name in (*PACKAGES, *OPTIONAL)},
        "devices": [f"{d.platform}: {d.device_kind}" for d in jax.devices()],
        "double_precision": double,
        "cores": os.cpu_count(),
        "threads": {
            name: os.environ.get(name) for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS")
        },
        "cache": _cache(),
    }
    progress("identifying a known slide")
    begin = time.perf_counter()
    values = _identified()
    found["check"] = {
        name: {"value": values[name], "truth": truth} for name, truth in _TRUTH.items()
    }
    found["check_seconds"] = time.perf_counter() - begin
    wrong = [n for n, t in _TRUTH.items() if not abs(values[n] / t - 1.0) < _ACCURACY]
    found["healthy"] = not wrong
    return Result(found, *_words(found, wrong))


def _cache() -> dict:
    """Where compiled programs are kept, how many, and whether more can be."""
    chosen = jax.config.jax_compilation_cache_dir  # type: ignore[attr-defined]
    folder = chosen or os.environ.get("JAX_COMPILATION_CACHE_DIR")
    if not folder:
        return {"folder": None, "programs": 0, "writable": False}
    parent = folder
    while not os.path.exists(parent) and os.path.dirname(parent) != parent:
        parent = os.path.dirname(parent)
    programs = len(os.listdir(folder)) if os.path.isdir(folder) else 0
    return {"folder": folder, "programs": programs, "writable": os.access(parent, os.W_OK)}


@in_double
def _identified() -> dict[str, float]:
    """Identified parameters of the slide by name."""
    t = np.arange(800) * 0.01
    w = 2 * np.pi * np.array([0.4, 1.1])[:, None]
    size = np.array([[0.2], [0.05]])
    q, dq, ddq = (
        np.asarray(jnp.sum(x, axis=0))
        for x in (size * np.sin(w * t), size * w * np.cos(w * t), -size * w**2 * np.sin(w * t))
    )
    tau = 20.0 * ddq + 30.0 * dq + 5.0 * np.tanh(dq / 0.01)
    result = identify(log_from_arrays(t, q, tau, joints=("slide",)), "emps")
    return {row["name"]: float(row["value"]) for row in result["base_parameters"]}


def _words(found: dict, wrong: list[str]) -> tuple[tuple[str, ...], tuple[Table, ...]]:
    versions = found["versions"]
    cache = found["cache"]
    told = [
        f"jaxswarm {versions['jaxswarm']} on Python {found['python']}, {found['system']}",
        f"devices: {', '.join(found['devices'])}; double precision is "
        f"{'on' if found['double_precision'] else 'off (the tasks switch it on for themselves)'}",
        f"{found['cores']} cores; " + ", ".join(f"{k} = {v}" for k, v in found["threads"].items()),
        "compiled programs are not kept" if cache["folder"] is None else
        f"{cache['programs']} files of compiled programs in {cache['folder']}"
        + ("" if cache["writable"] else ", which cannot be written: every run compiles anew"),
        "a known slide was identified: all is well" if found["healthy"] else
        f"a known slide came out wrong ({', '.join(wrong)}): report this, with --json",
    ]  # fmt: skip
    rows = tuple((name, version or "not installed") for name, version in versions.items())
    check = tuple(
        (n, f"{row['value']:.5g}", f"{row['truth']:g}") for n, row in found["check"].items()
    )
    return tuple(told), (
        Table("packages", ("package", "version"), rows),
        Table("check", ("parameter", "identified", "true"), check),
    )
