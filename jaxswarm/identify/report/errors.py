"""Errors of an identification, one row a log: the terminal and the tables show the same."""

from collections.abc import Sequence


def error_rows(report: dict) -> dict[str, dict]:
    """Errors by the name of their row: of every fitted log, of held-out time and of the validation log.

    Args:
        report: Content of ``identification.json``.
    """
    told = report["error"]
    train = told["train"] if isinstance(told["train"], list) else [told["train"]]
    rows = {}
    for errors in train:
        name = f"fitted: {errors['log']}" if len(train) > 1 else "fitted log"
        number = sum(row == name or row.startswith(f"{name}, part ") for row in rows)
        rows[f"{name}, part {number + 1}" if number else name] = errors
    rows["held-out blocks"] = told["held_out_blocks"]
    if told["validation"] is not None:
        rows["validation log"] = told["validation"]
    return rows


def error_cells(errors: dict, units: Sequence[str]) -> list[str]:
    """The errors of every joint in its unit and in percent, and of all joints together."""
    cells = [
        f"{rms:.4g} {unit} ({100 * share:.2f} %)"
        for rms, share, unit in zip(errors["rms"], errors["relative"], units, strict=True)
    ]
    return [*cells, f"{100 * errors['relative_global']:.3f} %"]
