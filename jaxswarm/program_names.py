"""What a compiled program is made from, as text that holds in another process."""

import dataclasses
import functools
import hashlib
import inspect
import os
import platform
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import jax
import numpy as np

# What stands for itself.
PLAIN = (bool, int, float, str, bytes, type(None))
_CONFIG: Any = jax.config  # its settings have no types
# Says where a program runs, not what it is.
_ELSEWHERE = ("jax_cpu_enable_async_dispatch",)


class Unknown(Exception):
    """Something a program depends on has no name that holds in another process."""


def described(x: Any) -> str:
    """What a fixed argument is, as text that holds in another process.

    Raises:
        Unknown: If it is made of something outside this package, or of what has no such text.
    """
    if isinstance(x, PLAIN):
        return repr(x)
    if isinstance(x, functools.partial):
        return f"partial({described((x.func, x.args, x.keywords))})"
    if isinstance(x, (tuple, list)):
        return f"({','.join(map(described, x))})"
    if isinstance(x, Mapping):
        return f"{{{','.join(f'{k!r}:{described(v)}' for k, v in sorted(x.items()))}}}"
    if dataclasses.is_dataclass(x) and not isinstance(x, type) and _is_ours(type(x)):
        parts = ((f.name, getattr(x, f.name)) for f in dataclasses.fields(x))
        return f"{type(x).__qualname__}({','.join(f'{n}={described(v)}' for n, v in parts)})"
    if callable(x):
        return _described_function(inspect.unwrap(x))
    raise Unknown


def _described_function(x: Any) -> str:
    """A function by where it stands in this package, with what it holds from around it."""
    code = getattr(x, "__code__", None)
    if code is None or not _is_ours(x):
        raise Unknown
    held = [described(cell.cell_contents) for cell in x.__closure__ or ()]
    usual = described((x.__defaults__ or (), x.__kwdefaults__ or {}))
    place = f"{x.__module__}:{x.__qualname__}:{code.co_firstlineno}"
    numbers = [c for c in code.co_consts if isinstance(c, PLAIN)]
    return f"{place}({held})({usual}){code.co_code.hex()}{numbers}{code.co_names}"


def _is_ours(x: Any) -> bool:
    """Whether this package defines it: its source is part of what programs are known by."""
    return (getattr(x, "__module__", None) or "").partition(".")[0] == __name__.partition(".")[0]


def settings() -> str:
    """What JAX was told, beside what no setting changes."""
    told = {k: v for k, v in _CONFIG.values.items() if "cache" not in k and k not in _ELSEWHERE}
    return f"{sorted(told.items())} {_CONFIG.jax_enable_x64} {_surroundings()}"


@functools.cache
def _surroundings() -> str:
    """What else decides what a program is: this package's source, versions, processor, flags of XLA."""
    source = hashlib.sha256()
    package = Path(__file__).parent
    for path in sorted(package.rglob("*.py")):
        source.update(str(path.relative_to(package)).encode() + path.read_bytes())
    told = [source.hexdigest(), jax.__version__, jax.lib.__version__, np.__version__, sys.version]
    told += [platform.platform(), platform.machine(), _processor()]
    told += [os.environ.get(name, "") for name in ("XLA_FLAGS", "JAX_DEFAULT_MATMUL_PRECISION")]
    return "\n".join(told)


def _processor() -> str:
    """What the processor can do, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace").splitlines()
    except OSError:
        return platform.processor()
    told = [line for line in lines if line.startswith(("model name", "flags", "Features"))]
    return "\n".join(sorted(set(told))) or platform.processor()
