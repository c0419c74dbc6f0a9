"""Public logs of measured arms, as their authors published them, at a fixed commit of their repository.

Nothing of them is part of this package: the licence of each is told, and what to cite. An address names a
commit, so what it holds should not change, but the authors publish no checksums: the first download is
trusted, its SHA-256 is shown and kept beside the files (``checksums.json``), and every later one has to be
the same. Who has the checksums of somebody else puts that file into the folder first.
"""

import json
import shutil
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote, unquote, urlparse

from jaxswarm import outputs
from jaxswarm.errors import InputError, nearest
from jaxswarm.tables import Result, Table

CHECKSUMS = "checksums.json"


@dataclass(frozen=True)
class Source:
    """Where a set of logs is published.

    Attributes:
        base: Address of the folder, at a commit.
        files: Paths below it.
        licence: Under which it may be used.
        cite: What to cite.
        about: What it is.
    """

    base: str
    files: tuple[str, ...]
    licence: str
    cite: str
    about: str


def _github(repository: str, commit: str, folder: str) -> str:
    return f"https://raw.githubusercontent.com/{repository}/{commit}/{quote(folder)}/"


SOURCES = {
    "emps": Source(
        _github(
            "forgi86/sysid-neural-continuous",
            "956aa7ecd73061b0321c6f6098d74c9e4a7ce67a",
            "examples/EMPS/data",
        ),
        ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"),
        "Apache-2.0 (the repository; the benchmark itself states none)",
        "A. Janot, M. Gautier, M. Brunot, Data Set and Reference Models of EMPS, Workshop on Nonlinear "
        "System Identification Benchmarks, Eindhoven, 2019",
        "one prismatic axis, 1 kHz, two runs; position in m, voltage in V (35.15065 N/V)",
    ),
    "tx40": Source(
        _github(
            "thanhndv212/figaroh-examples",
            "c0b5c7f0fda10078be55104f9ee76ac106b7a5ee",
            "examples/staubli_TX40/data",
        ),
        ("pos_read_data.csv", "curr_data.csv"),
        "Apache-2.0",
        "A. Janot, P.-O. Vandanjon, M. Gautier, A generic instrumental variable approach for industrial "
        "robot identification, IEEE TCST 22(1), 2014",
        "six joints, 5 kHz, one run; motor positions and currents",
    ),
    "ur10e": Source(
        _github(
            "shamilmamedov/dynamic_calibration",
            "11af40e7deb758ec080a175fed8fcdd6c99aca29",
            "dataset_ur10e",
        ),
        (
            "identification_data/ur-20_02_12-50sec_12harm.csv",
            "identification_data/ur-20_02_10-30sec_12harm.csv",
            "validation_data/ur-20_01_17-ptp_10_points.csv",
        ),
        "none is stated: use it to test, do not pass it on",
        "S. Mamedov, S. Mikhel, Practical Aspects of Model-Based Collision Detection, Front. Robot. AI "
        "7:571574, 2020",
        "six joints, about 94 Hz, irregular; CSV without a header line: time, 6 positions, 6 velocities, "
        "6 motor currents, and 12 columns more",
    ),
    "kr300": Source(
        _github(
            "JonasWeigand/Robot_Identification",
            "9e403c07d9dadbb391a9f3921e8d219f714636a8",
            "data/recorded_trajectories",
        ),
        tuple(f"2020-10-21 10s FF {run} 08ms/data.mat" for run in "ABC"),
        "MIT",
        "J. Weigand, J. Goetz, J. Ulmen, M. Ruskowski, Dataset and Baseline for an Industrial Robot "
        "Identification Benchmark, 2022",
        "six joints, 250 Hz, three runs of 10 s",
    ),
}


def fetch(
    name: str,
    folder: str | Path = ".",
    *,
    sources: dict[str, Source] | None = None,
    progress: Callable[[str], None] = lambda text: None,
) -> Result:
    """Download a public set of logs into ``folder/name``.

    Args:
        name: One of :data:`SOURCES`.
        folder: Folder for the sets.
        sources: Other sets by name.
        progress: Called with one line per file.

    Returns:
        ``files``, ``sha256``, ``licence``, ``cite``, and ``first_seen``: the files whose checksum
        nobody had told.

    Raises:
        InputError: If the set is unknown, pooch is not installed, there is no connection, or a file is
            another one than was fetched before.
    """
    sources = SOURCES if sources is None else sources
    if name not in sources:
        raise InputError(f"unknown data {name!r}. {nearest(name, sources)}")
    try:
        import pooch
    except ImportError:
        raise InputError("fetching needs pooch: pip install 'jaxswarm[fetch]'") from None
    source, target = sources[name], Path(folder) / name
    outputs.check_folder(target)
    known = _known(target / CHECKSUMS)
    names = [path.replace("/", "_") for path in source.files]
    with tempfile.TemporaryDirectory() as place:
        for path, own in zip(source.files, names, strict=True):
            address = source.base + quote(path)
            progress(f"fetching {address}")
            _get(pooch, address, Path(place), own, known.get(own))
        found = {own: pooch.file_hash(str(Path(place) / own)) for own in names}
        content = {own: (Path(place) / own).read_bytes() for own in names}
    outputs.write_told(target, {**content, CHECKSUMS: outputs.to_json(found)})
    return _told(name, source, target, found, [own for own in names if own not in known])


def _told(
    name: str, source: Source, target: Path, found: dict[str, str], fresh: list[str]
) -> Result:
    """What arrived, under which licence, and what its checksums were compared with."""
    result = {
        "name": name,
        "about": source.about,
        "files": [str(target / own) for own in found],
        "sha256": found,
        "first_seen": fresh,
        "source": source.base,
        "licence": source.licence,
        "cite": source.cite,
    }
    lines = [f"{k}: {result[k]}" for k in ("about", "licence", "cite", "source")]
    lines.append(
        f"checksums: the same as in {CHECKSUMS}"
        if not fresh
        else f"checksums: {len(fresh)} of {len(found)} files were fetched for the first time, with nothing to "
        f"compare them with; what arrived is pinned in {target / CHECKSUMS} from now on"
    )
    rows = tuple((str(target / own), checksum) for own, checksum in found.items())
    return Result(result, tuple(lines), (Table("", ("file", "SHA-256"), rows),))


def _get(pooch, address: str, place: Path, own: str, known: str | None) -> None:
    """One file, through pooch, with every failure as one sentence."""
    local = urlparse(address).scheme == "file"
    try:
        pooch.get_logger().setLevel("ERROR")
        pooch.retrieve(
            address,
            known_hash=None if known is None else f"sha256:{known}",
            fname=own,
            path=place,
            downloader=_copy if local else None,
        )
    except ValueError as error:
        raise InputError(
            f"{address}: is not the file whose SHA-256 is pinned ({known}), as fetched before; remove "
            f"{CHECKSUMS} if it is to be another one"
        ) from error
    except Exception as error:
        # Whatever the network and its libraries raise, the user can only try another way.
        answer = getattr(getattr(error, "response", None), "status_code", None)
        what, remedy = (
            (type(error).__name__, "check the connection, or download it by hand")
            if answer is None
            else (f"the server answers {answer}", "it may have moved; look for it by hand")
        )
        raise InputError(f"{address}: cannot be fetched ({what}); {remedy}") from error


def _copy(url: str, output_file: str, pooch: object) -> None:
    """A downloader for files of this machine or a mounted one."""
    shutil.copyfile(unquote(urlparse(url).path), output_file)


def _known(path: Path) -> dict[str, str]:
    if not path.exists():
        return {}
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, RecursionError) as error:
        raise InputError(f"{path}: cannot be read ({error}); remove it to fetch anew") from None
