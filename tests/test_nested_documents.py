"""Documents nested deeper than a parser can follow are refused, or count as nothing, as damaged ones do."""

import pytest

from jaxswarm import compare
from jaxswarm.diagnose.candidates.journal import FILE, Journal
from jaxswarm.errors import InputError
from jaxswarm.identify.excitation.limits import read_limits
from jaxswarm.identify.forward.model import load_model
from jaxswarm.manifest import MANIFEST
from jaxswarm.outputs import write_results

DEEP = "[" * 20_000


@pytest.mark.parametrize(
    ("name", "read"),
    [
        ("limits.toml", lambda path: read_limits(path, ("slide",))),
        ("model.json", load_model),
        ("result.json", lambda path: compare(path, path)),
    ],
)
def test_what_a_user_gives_is_refused_by_name(tmp_path, name, read):
    path = tmp_path / name
    path.write_text(f"a = {DEEP}" if name.endswith("toml") else DEEP)
    with pytest.raises(InputError, match=name):
        read(path)


def test_what_we_left_behind_counts_as_nothing(tmp_path):
    (tmp_path / FILE).write_text(DEEP)
    assert Journal(tmp_path, "a").rounds == {}
    (tmp_path / MANIFEST).write_text(DEEP)
    (done,) = write_results(tmp_path, {"model.json": "1"})
    assert done.read_text() == "1"
