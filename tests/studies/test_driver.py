"""What both studies share: nothing is run for a folder that cannot be written, nothing drawn for none."""

import json

import pytest

from jaxswarm.errors import InputError
from jaxswarm.plots import panels
from jaxswarm.studies.driver import Study, run_study
from jaxswarm.studies.page import page, picture


def _study(calls):
    def experiment(fast, seed, progress):
        calls.append(("run", fast, seed))
        progress("counting")

        def figures():
            calls.append("drawn")
            return {"one.png": panels(1, 1, 1.0, 1.0)[0]}

        return {"number": 3.0}, figures

    def render(content, images):
        return page("Trial", [picture(name, data, "a picture") for name, data in images.items()])

    return Study(
        "trial",
        ("a guess",),
        experiment,
        lambda c: [f"It is {c['number']:g}, {c['seed']}."],
        render,
    )


def test_a_bad_folder_is_told_first(tmp_path):
    calls = []
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is not a folder"):
        run_study(_study(calls), tmp_path / "file")
    assert not calls


def test_without_a_folder_nothing_is_drawn():
    calls, told = [], []
    result = run_study(_study(calls), None, fast=True, seed=4, progress=told.append)
    assert calls == [("run", True, 4)] and told == ["counting"]
    assert result["findings"] == ["It is 3, 4."] and result["reconstructions"] == ["a guess"]


def test_files(tmp_path):
    result = run_study(_study([]), tmp_path / "new")
    assert {p.name for p in (tmp_path / "new").glob("[!.]*")} == {
        "trial.json",
        "report.html",
        "one.png",
    }
    assert json.loads((tmp_path / "new" / "trial.json").read_text()) == result
    assert (tmp_path / "new" / "one.png").read_bytes()[1:4] == b"PNG"
