"""Where a result comes from: digests of its inputs, versions, options; nothing that changes from run to run."""

import hashlib
import platform
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

_PLAIN = (bool, int, float, str)
_PACKAGES = ("jaxswarm", "jax", "jaxlib", "numpy", "scipy")


def provenance(inputs: Sequence[Path], options: dict) -> dict:
    """Digests of input files by name, versions of what computed, and the options it was given.

    Args:
        inputs: Files that were read.
        options: Options by name, as text or numbers.
    """
    return {
        "inputs": [
            {"name": Path(p).name, "sha256": hashlib.sha256(Path(p).read_bytes()).hexdigest()}
            for p in inputs
        ],
        "versions": {"python": platform.python_version(), **{n: version(n) for n in _PACKAGES}},
        "options": {
            k: v if v is None or isinstance(v, _PLAIN) else str(v) for k, v in options.items()
        },
    }
