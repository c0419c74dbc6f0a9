"""What a fleet needs beyond the core, asked for before any work."""

from importlib.util import find_spec

from jaxswarm.errors import InputError

_PACKAGES = ("dask", "distributed", "fsspec", "pyarrow")


def require() -> None:
    """Refuse to begin without the packages of the extra ``fleet``.

    Raises:
        InputError: Naming what is missing and how to get it.
    """
    missing = [name for name in _PACKAGES if find_spec(name) is None]
    if missing:
        raise InputError(
            f"--fleet needs {', '.join(missing)}: install with pip install 'jaxswarm[fleet]'"
        )
