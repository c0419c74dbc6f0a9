"""LeRobot data sets: Parquet tables of episodes, with what their columns mean in ``meta/info.json``.

Versions 2 and 3: ``data/*/episode_*.parquet`` or ``data/*/file-*.parquet`` with ``timestamp`` [s],
``episode_index`` and arrays ``observation.state``, perhaps ``observation.velocity`` and
``observation.effort``. One episode is one log. The sets do not say their units, which therefore is told.
"""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.logs.parquet import read_parquet
from jaxswarm.logs.table import Table

_INFO = Path("meta") / "info.json"
_OURS = {
    "observation.state": "q",
    "observation.velocity": "dq",
    "observation.state.velocity": "dq",
    "observation.effort": "effort",
    "observation.state.effort": "effort",
    "timestamp": "t",
}
_EPISODE = "episode_index"
# Folders above a file in which its data set may begin.
_ABOVE = 4


def home_of(path: Path) -> Path | None:
    """The data set that a folder is, or that a Parquet file belongs to; None where there is none."""
    folders = [path] if path.is_dir() else list(path.absolute().parents)[:_ABOVE]
    return next((folder for folder in folders if (folder / _INFO).is_file()), None)


def read_lerobot(path: Path, home: Path, part: str | None = None) -> Table:
    """Read one episode of a data set.

    Args:
        path: The folder of the set, or one of its files.
        home: The folder of the set.
        part: Number of the episode; None: the only one there is.

    Raises:
        InputError: If the set cannot be read, or which episode is meant has to be said.
    """
    files = [path] if path.is_file() else sorted((home / "data").rglob("*.parquet"))
    if part is not None and not part.isdigit():
        raise InputError(f"{path}: --topic {part}: give the number of an episode")
    seen: set[int] = set()
    chosen: Table | None = None
    for table, episode in _episodes(path, files, part):
        seen |= set(np.unique(episode).astype(int).tolist())
        rows = episode == (episode[0] if part is None else int(part))
        if chosen is None and rows.any():
            columns = {n: x[rows] for n, x in table.columns.items() if n != _EPISODE}
            chosen = replace(table, columns=columns, source=str(path))
        if part is None and len(seen) > 1:
            raise InputError(
                f"{path}: holds several episodes; each is a log of its own. Say which: --topic "
                f"{min(seen)}"
            )
    if chosen is None:
        raise InputError(
            f"{path}: no episode {'at all' if part is None else part}"
            + (f"; there are {min(seen)} to {max(seen)} (--topic)" if seen else "")
        )
    columns = {_OURS.get(name, name): values for name, values in chosen.columns.items()}
    note = "LeRobot does not say units: positions are taken in rad or m, efforts in N m or N."
    return replace(
        chosen, columns=columns, joints=_joints(home, columns), notes=(*chosen.notes, note)
    )


def _episodes(
    path: Path, files: list[Path], part: str | None
) -> Iterator[tuple[Table, np.ndarray]]:
    """Tables with the episode of every row; those that a file's name rules out are passed over."""
    named = [file for file in files if part and file.stem == f"episode_{int(part):06d}"]
    for file in named or files:
        table = read_parquet(file)
        episode = table.columns.get(_EPISODE)
        if episode is None or episode.ndim != 1 or not episode.size:
            raise InputError(f"{file}: no column {_EPISODE}: is {path} a LeRobot data set?")
        if not np.isfinite(episode).all():
            raise InputError(f"{file}: {_EPISODE} lacks numbers: every row belongs to an episode")
        yield table, episode


def _joints(home: Path, columns: dict[str, np.ndarray]) -> tuple[str, ...] | None:
    """Names of the columns of q, where the set has one name a column."""
    try:
        info = json.loads((home / _INFO).read_text(encoding="utf-8"))
        names = info["features"]["observation.state"]["names"]
    except (OSError, ValueError, LookupError, TypeError):
        return None
    if isinstance(names, dict) and len(names) == 1:
        (names,) = names.values()
    q = columns.get("q")
    fits = isinstance(names, list) and all(isinstance(name, str) for name in names)
    if not fits or q is None or q.shape[1:] != (len(names),):
        return None
    return tuple(name.removesuffix(".pos") for name in names)
