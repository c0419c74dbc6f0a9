"""The table of what people bring: its logs end as they should, and its robots are compared."""

import pytest

from benchmarks.brought import urdfs, variants

EXPECTED = {
    "semicolons and decimal commas": variants.SAME,
    "q [deg] in the header": variants.SAME,
    "kN m, nothing said": variants.REFUSED,
    "N mm, nothing said": variants.REFUSED,
    "NPZ, both sides of a gear": variants.REFUSED,
}


@pytest.fixture(scope="module")
def made():
    return variants.made()


@pytest.mark.parametrize("name", EXPECTED)
def test_a_way_to_write_a_log_ends_as_it_should(made, name, tmp_path):
    robot, log = made
    given = variants.variants(log, tmp_path)[name]()
    assert variants.outcome(name, given, robot, log).outcome == EXPECTED[name]


def test_there_are_as_many_ways_as_promised(made, tmp_path):
    assert len(variants.variants(made[1], tmp_path)) >= 49


def test_robots_are_compared_with_pinocchio(tmp_path):
    pytest.importorskip("pinocchio")
    link = '<link name="{0}"><inertial><mass value="2"/><origin xyz="0.1 0 0.2"/></inertial></link>'
    joint = (
        '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{3}"/><axis xyz="0 1 0"/>'
        '<limit lower="-1" upper="1" effort="9" velocity="9"/>{4}</joint>'
    )
    text = (
        '<robot name="r">'
        + "".join(map(link.format, "abc"))
        + joint.format("p", "revolute", "a", "b", "")
    )
    (tmp_path / "arm.urdf").write_text(
        text + joint.format("s", "prismatic", "b", "c", "") + "</robot>"
    )
    (tmp_path / "mimic.urdf").write_text(
        text + joint.format("s", "prismatic", "b", "c", '<mimic joint="p"/>') + "</robot>"
    )
    rows = list(urdfs.compare(sorted(tmp_path.glob("*.urdf"))))
    assert [row.file for row in rows] == ["arm.urdf", "mimic.urdf"]
    assert all(row.read and row.pinocchio and row.apart < 1e-9 for row in rows)
