"""Tables on a terminal of 80 columns: words fold, numbers stand whole, what does not fit follows below."""

import re

import numpy as np
import pytest
from rich.console import Console

from jaxswarm.identify.report.errors import base_table, error_table
from jaxswarm.tables import Result, Table

JOINTS = tuple(f"panda_finger_joint{k}" for k in range(1, 8))


def printed(table, width=80):
    console = Console(width=width, color_system=None)
    with console.capture() as captured:
        console.print(table)
    return captured.get()


def fits(table, width=80):
    out = printed(table, width)
    assert "…" not in out and max(map(len, out.splitlines())) <= width, out
    for row in table.rows:
        for cell in row:
            if re.match(r"-?\d", cell):
                assert cell in out, cell
    return out


def errors(rng):
    rms = rng.lognormal(size=len(JOINTS)) * 1e-2
    return {"rms": rms, "relative": 0.1 * rms, "relative_global": 0.00301}


def test_errors_of_seven_joints_stand_whole():
    rng = np.random.default_rng(0)
    parts = {name: errors(rng) for name in ("fitted log", "held-out blocks", "validation log")}
    parts |= {f"fitted: /a/long/path/of/logs/monday_{k}.csv": errors(rng) for k in range(3)}
    out = fits(error_table("panda", {**parts, "none": None}, JOINTS, ["N m"] * 7))
    assert "none" not in out.split()
    lines = out.splitlines()
    assert sum(line.startswith("torque error") for line in lines) > 1, "columns follow below"
    assert sum(line.startswith("panda ") for line in lines) == 1, "the title stands once"


def test_expressions_fold_and_values_do_not():
    expression = "Ixx2 - Iyy2 + 0.099856 m3 + 0.632 mz3 + Iyy3 + 0.10666 m4 + 0.10666 m5"
    row = {"name": "b_panda_finger_joint1", "value": -1.23456e-05, "std_error": 8.3e-06}
    row |= {"unit": "N m s/rad", "verdict": "determined", "expression": expression}
    out = fits(base_table([row, {**row, "std_error": float("inf")}]))
    assert "-1.2346e-05" in out and "8.3e-06" in out
    assert len(out.splitlines()) > 5, "the expression stands on several lines"


def test_the_name_of_a_row_stands_whole_where_there_is_a_joint_more():
    names = ("nonlinear_viscous_friction@slide", "load_dependent_friction@panda_joint7")
    rows = tuple((n, "c", "44.761 ± 3.9", "41.2 ± 4.1", "-3.56", "N (s/m)^alpha") for n in names)
    table = Table("parameters", ("of", "parameter", "a", "b", "b - a", "unit"), rows)
    out = fits(table)
    assert all(name in out for name in names)


@pytest.mark.parametrize("width", [40, 60, 80, 120])
def test_no_number_is_broken_at_any_width(width):
    rng = np.random.default_rng(1)
    cells = [[f"{x:.4g}" for x in row] for row in rng.normal(size=(3, 14))]
    heads = ("joint", *(f"quantity number {k}" for k in range(14)))
    rows = tuple((name, *row) for name, row in zip(JOINTS, cells, strict=False))
    fits(Table("many", heads, rows), width)


def test_marked_rows_stand_out_and_tables_of_a_result_are_apart():
    table = Table("t", ("joint", "value"), (("a", "1"), ("b", "2")), marked=frozenset({1}))
    console = Console(width=40, force_terminal=True, color_system="standard")
    with console.capture() as captured:
        console.print(table)
    bold = [line for line in captured.get().splitlines() if "\x1b[1m" in line]
    assert any("b" in line and "2" in line for line in bold)
    out = printed(Result({}, ("said",), (table, table)))
    assert out.split("\n").count("") >= 2
