"""The table of a fleet: one Parquet file of long format, written in pieces.

Every line is of one log. ``row`` says of what: ``log`` (verdict, reason, share of the torque that is left),
``joint`` (its errors [N m or N] and residual over noise), ``effect`` and ``changed`` (parameters of what was
added or is no longer what it was), ``parameter`` (of the fitted model; with ``--against fleet`` beside those
of the other arms).
"""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from jaxswarm.diagnose.report.numbers import interval
from jaxswarm.fleet.collect import Entry, entry, joint_of, parameter_key
from jaxswarm.fleet.mixed_model import Deviation
from jaxswarm.fleet.sources import Source

# Lines that are written at once.
_PIECE = 50_000
_TEXT = ("arm", "log", "row", "effect", "joint", "parameter", "unit", "verdict", "reason")
_NUMBERS = (
    *("value", "std_error", "lower", "upper"),
    *("error_before", "error_after", "residual_over_noise"),
    *("fleet_value", "fleet_spread", "q_value"),
)

Deviations = dict[tuple[str, str], Deviation]


def schema() -> Any:
    """Names and types of the columns."""
    import pyarrow as pa

    return pa.schema(
        [
            ("arm", pa.string()),
            ("date", pa.timestamp("s")),
            *((name, pa.string()) for name in _TEXT[1:]),
            *((name, pa.float64()) for name in _NUMBERS),
            ("differs", pa.bool_()),
        ]
    )


def write_table(path: Path, results: Iterable[tuple[Source, dict]], told: Deviations) -> int:
    """Write the table; memory does not grow with the fleet.

    Args:
        path: File to write.
        results: Content of the result of every log.
        told: What the comparison of the arms says, by arm and parameter.

    Returns:
        Number of lines.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    count, columns = 0, schema()
    with pq.ParquetWriter(path, columns, compression="zstd") as writer:
        for piece in _pieces(line for result in results for line in lines(*result, told)):
            writer.write_table(pa.Table.from_pylist(piece, schema=columns))
            count += len(piece)
    return count


def _pieces(rows: Iterable[dict]) -> Iterator[list[dict]]:
    piece: list[dict] = []
    for row in rows:
        piece.append(row)
        if len(piece) == _PIECE:
            yield piece
            piece = []
    if piece:
        yield piece


def lines(source: Source, content: dict, told: Deviations) -> Iterator[dict]:
    """The lines of one log."""
    about = entry(source, content)
    same = {"arm": source.arm, "date": source.date, "log": source.path, "verdict": about.verdict}
    yield {**same, "row": "log", "reason": about.reason or None, **_whole(content)}
    if "verdict" not in content:
        return
    yield from ({**same, **row} for row in _joints(about, content))
    for kind, entries in (("effect", content["effects"]), ("changed", content["changed"])):
        for effect in entries:
            named = {**same, "row": kind, "effect": effect["effect"], "joint": effect["joint"]}
            for name, row in effect["parameters"].items():
                yield {**named, "parameter": name, **_numbers(row)}
    for row in content.get("base_parameters", ()):
        name = {
            "row": "parameter",
            "effect": row["effect"],
            "joint": joint_of(row, content["joints"]),
        }
        key = parameter_key(row)
        yield {**same, **name, "parameter": key, **_numbers(row), **_beside(told, source.arm, key)}


def _whole(content: dict) -> dict:
    """Error of the whole arm, as a share of its torque."""
    error = content.get("error") or {}
    shares = {f"error_{when}": error.get(when) for when in ("before", "after")}
    return {k: v.get("relative_global") for k, v in shares.items() if v} | {"unit": "1"}


def _joints(about: Entry, content: dict) -> Iterator[dict]:
    error = content.get("error") or {}
    for j, joint in enumerate(content["joints"]):
        row = {"row": "joint", "joint": joint, "unit": content["torque_units"][j]}
        for when in ("before", "after"):
            if error.get(when):
                row[f"error_{when}"] = error[when]["rms"][j]
        if about.over_noise:
            row["residual_over_noise"] = about.over_noise[j]
        yield row


def _numbers(row: dict) -> dict:
    lower, upper = interval(row) or (None, None)
    numbers = {"value": row["value"], "std_error": row.get("std_error")}
    return {**numbers, "lower": lower, "upper": upper, "unit": row["unit"]}


def _beside(told: Deviations, arm: str, key: str) -> dict:
    one = told.get((arm, key))
    if one is None:
        return {}
    return {
        "fleet_value": one.center,
        "fleet_spread": one.spread,
        "q_value": one.q_value,
        "differs": one.differs,
    }
