"""Writing results: a folder that is checked before the work and filled only after it, whole or not at all.

Every file of a set is written beside its place first; only when all of them are complete are they moved
there. A hidden manifest remembers which files a command wrote, with their digests: a later set that
shares a name with them replaces all of them, so that no picture of an earlier run stands beside the
numbers of this one. Files that nobody here wrote, or that were changed since, are never deleted.
"""

import json
import os
import platform
import re
import tempfile
import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from jaxswarm import unfinished
from jaxswarm.errors import InputError, Notice, printable
from jaxswarm.manifest import MANIFEST, as_written, digest_of, read_sets

# What neither a shell nor any file system takes as it is: separators, wild cards, quotes, control characters.
_UNSAFE = re.compile(r'[\x00-\x1f\x7f/\\:*?"<>|$\[\]]')

# Characters of a stem or an ending: short enough for the usual limit of 255 bytes.
_LONGEST_NAME = 60

Content = str | bytes | Callable[[Path], object]


def check_folder(folder: Path, named: Path | None = None) -> Path:
    """Refuse an output folder that could not be written, before any work is done; create nothing.

    Args:
        folder: It.
        named: What the user named, where that is a file in it.

    Raises:
        InputError: If the path or the nearest existing parent is no writable folder.
    """
    folder = Path(folder)
    named = folder if named is None else named
    try:
        parent = _nearest(folder)
        if not parent.is_dir():
            raise InputError(f"--out {named}: {parent} is not a folder; choose another place")
        with tempfile.TemporaryFile(dir=parent):
            pass
    except OSError as error:
        raise _refusal(named, error) from None
    return folder


def check_file(path: Path) -> Path:
    """Refuse an output file that could not be written, as :func:`check_folder` does.

    Raises:
        InputError: If it is a folder, or its folder or its name cannot be used.
    """
    path = Path(path)
    check_folder(path.parent, path)
    try:
        _nearest(path)
    except OSError as error:
        raise _refusal(path, error) from None
    if path.is_dir():
        raise InputError(f"--out {path}: is a folder; name a file such as {path / 'pred.csv'}")
    _refuse_device(path)
    return path


def _refuse_device(path: Path) -> None:
    """Refuse to put a file in the place of a device or a pipe, which others need."""
    if path.exists() and not path.is_file() and not path.is_dir():
        raise InputError(f"--out {path}: {path.name} is a device or a pipe; name a file")


def write_results(folder: Path, files: Mapping[str, Content]) -> list[Path]:
    """Write a set of results; earlier sets that share a name with it are replaced whole.

    Args:
        folder: Created if missing.
        files: Content by name, see :func:`write_files`; what no file name may hold is replaced, see
            :func:`file_name`.

    Returns:
        The paths, in order.
    """
    folder = Path(folder)
    files = dict(zip(_distinct([file_name(name) for name in files]), files.values(), strict=True))
    sets = read_sets(folder)
    stale = [known for known in sets if known.keys() & files.keys()]
    ours = {name: digest for known in stale for name, digest in known.items()}
    replaced = [
        n for n in files if (folder / n).exists() and not as_written(folder / n, ours.get(n))
    ]
    done = write_files(folder, files)
    _tell(folder, "overwritten, not made by an earlier run", replaced)
    gone = [n for n, d in ours.items() if n not in files and as_written(folder / n, d)]
    for name in gone:
        (folder / name).unlink(missing_ok=True)
    _tell(folder, "removed, made by an earlier run", gone)
    kept = [known for known in sets if known not in stale]
    written = {path.name: digest_of(path) for path in done}
    write_files(folder, {MANIFEST: to_json({"sets": [*kept, written]})})
    return done


def write_told(folder: Path, files: Mapping[str, Content]) -> list[Path]:
    """Write files of their own, see :func:`write_files`; what they take the place of is told."""
    before = {n: digest_of(folder / n) for n in files if (folder / n).is_file()}
    done = write_files(folder, dict(files))
    _tell(folder, "overwritten", [n for n, d in before.items() if not as_written(folder / n, d)])
    return done


def _tell(folder: Path, what: str, names: Sequence[str]) -> None:
    """Told afterwards: whatever is told before could still fail."""
    if names:
        told = ", ".join(printable(name) for name in names)
        warnings.warn(f"{folder}: {what}: {told}", Notice, 3)


def write_files(folder: Path, files: dict[str, Content]) -> list[Path]:
    """Write files into a folder, all of them or none.

    Args:
        folder: Created if missing, and removed again if nothing could be written.
        files: Content by name: text, bytes, or a function that writes to the path it is given.

    Returns:
        The paths, in order.

    Raises:
        InputError: If they cannot be written; the folder is as it was then.
    """
    folder = Path(folder)
    parts: list[tuple[Path, Path]] = []
    created: list[Path] = []
    try:
        missing = folder
        while not missing.exists():
            created.append(missing)
            missing = missing.parent
        folder.mkdir(parents=True, exist_ok=True)
        unfinished.sweep(folder, _machine())
        for name, content in files.items():
            target = folder / name
            if target.is_dir():
                raise InputError(f"--out {folder}: {target} is a folder; move it away")
            _refuse_device(target)
            handle, temporary = tempfile.mkstemp(
                dir=folder, prefix=unfinished.mark(_machine()), suffix=target.suffix
            )
            os.close(handle)
            parts.append((Path(temporary), target))
            _write(parts[-1][0], content)
        for part, target in parts:
            os.replace(part, target)
        return [target for _, target in parts]
    except OSError as error:
        raise _refusal(folder, error) from None
    finally:
        for part, _ in parts:
            part.unlink(missing_ok=True)
        for path in created:
            if path.is_dir() and not any(path.iterdir()):
                path.rmdir()


def file_name(name: str) -> str:
    """Replace what a file name cannot hold, such as the slash in the name of a joint.

    >>> file_name("unexplained_arm/joint1.png")
    'unexplained_arm_joint1.png'
    """
    clean = Path(_UNSAFE.sub("_", name.encode("utf-8", "replace").decode()))
    return f"{clean.stem[:_LONGEST_NAME]}{clean.suffix[:_LONGEST_NAME]}"


def to_json(content) -> str:
    """JSON text of nested dicts, lists, numbers and arrays; NaN and infinity become null."""
    text = json.dumps(_plain(content), indent=1, ensure_ascii=False) + "\n"
    # Bytes of a path that are no UTF-8 are lone surrogates here; JSON has an escape for them.
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def _write(part: Path, content: Content) -> None:
    if callable(content):
        content(part)
    elif isinstance(content, bytes):
        part.write_bytes(content)
    else:
        part.write_bytes(content.encode("utf-8", "backslashreplace"))
    part.chmod(0o644)


def _distinct(names: list[str]) -> list[str]:
    """Number names that have become the same."""
    return [
        name if name not in names[:k] else f"{Path(name).stem}_{k}{Path(name).suffix}"
        for k, name in enumerate(names)
    ]


def _nearest(path: Path) -> Path:
    """The path or its nearest parent that exists.

    Raises:
        OSError: If the file system does not take one of the names below it, too long ones for example.
    """
    parent, missing = path, []
    while not os.path.lexists(parent) and parent != parent.parent:
        missing.append(parent.name)
        parent = parent.parent
    for name in missing:
        try:
            os.lstat(parent / name)
        except (FileNotFoundError, NotADirectoryError):
            pass
    return parent


def _refusal(folder: Path, error: OSError) -> InputError:
    return InputError(
        f"--out {folder}: cannot write there ({error.strerror}); choose another place"
    )


def _machine() -> str:
    return file_name(platform.node())


def _plain(x):
    if isinstance(x, dict):
        return {str(k): _plain(v) for k, v in x.items()}
    if isinstance(x, list | tuple):
        return [_plain(v) for v in x]
    if isinstance(x, np.ndarray) or hasattr(x, "__jax_array__") or hasattr(x, "device"):
        return _plain(np.asarray(x).tolist())
    if isinstance(x, np.generic):
        return _plain(x.item())
    if isinstance(x, float) and not np.isfinite(x):
        return None
    return x
