"""The BBOB benchmark: what is recorded of a run, cells that are there whole, tables."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))  # the benchmarks are not installed

from benchmarks.bbob import tables  # noqa: E402
from benchmarks.bbob.problems import TARGETS, Record, Single, Spent  # noqa: E402


class Bowl:
    """Stands for a function of ioh: lowest value 7 at the origin."""

    class optimum:  # noqa: N801
        y = 7.0

    def __call__(self, x):
        return np.sum(np.atleast_2d(x) ** 2, axis=1) + 7.0


def test_targets_are_those_of_coco():
    assert TARGETS.size == 51 and TARGETS[0] == 100.0
    assert TARGETS[-1] == pytest.approx(1e-8) and TARGETS[5] == pytest.approx(10.0)


def test_hits_are_counted_in_evaluations():
    record = Record([Bowl(), Bowl()], 5)
    x = np.array([[[11.0], [9.0], [5.0]], [[0.0], [9.0], [9.0]]])
    record.evaluate(x)  # distances 121, 81, 25; and 0: solved at once
    record.evaluate(np.array([[[1.0], [0.1], [0.0]], [[3.0], [3.0], [3.0]]]))
    first, second = record.hits
    assert first[0] == 2 and first[TARGETS >= 25.0][-1] == 3 and first[TARGETS >= 1.0][-1] == 4
    assert first[TARGETS >= 0.011][-1] == 5 and first[-1] == 0  # the sixth is beyond the budget
    assert (second == 1).all() and record.solved.tolist() == [False, True] and record.spent == 6


def test_a_single_run_ends_with_its_budget_or_with_the_last_target():
    single = Single(Bowl(), 3)
    assert single(np.array([2.0])) == pytest.approx(11.0)
    np.testing.assert_allclose(single(np.array([[1.0], [3.0]])), [8.0, 16.0])
    with pytest.raises(Spent):
        single(np.array([1.0]))
    solved = Single(Bowl(), 100)
    solved(np.array([0.0]))
    with pytest.raises(Spent):
        solved(np.array([1.0]))


def cell(solver, function, hits):
    return dict(solver=solver, dims=2, budget=100, function=function, instances=[1], hits=[hits])


def test_shares_by_group(tmp_path):
    half = [3] * 25 + [150] + [0] * 25
    cells = [cell("a", 1, half), cell("a", 6, [1] * 51), cell("b", 1, [0] * 51)]
    assert tables.share(cells[:1]) == pytest.approx(26 / 51)
    assert tables.share(cells[:1], 100) == pytest.approx(25 / 51)
    text = tables.table(cells)
    assert "2-D, 100 D evaluations, 1 instances" in text
    assert "| a | 0.755 | 0.510 | 1.000 |" in text and text.index("| a |") < text.index("| b |")
    assert tables.picture(cells, tmp_path / "ecdf.png").stat().st_size > 10_000


def test_cells_are_computed_once(tmp_path, capsys):
    pytest.importorskip("ioh")
    from benchmarks.bbob.__main__ import main

    options = ["--dims", "2", "--budgets", "50", "--instances", "1-2", "--functions", "1", "5-6"]
    options += ["--only", r"jaxswarm (cma_es|ipop_cma_es)$", "--out", str(tmp_path)]
    main(options)
    files = {p: p.read_text() for p in tmp_path.glob("*/*.json")}
    assert len(files) == 6 and not list(tmp_path.glob("*/*.part"))
    stored = json.loads(next(iter(files.values())))
    assert np.shape(stored["hits"]) == (2, 51) and max(map(max, stored["hits"])) <= 100
    capsys.readouterr()
    main(options)
    assert "jaxswarm cma_es, 2-D" not in capsys.readouterr().err  # nothing is left to do
    next(iter(files)).unlink()
    main(options)
    assert {p: p.read_text() for p in tmp_path.glob("*/*.json")} == files
