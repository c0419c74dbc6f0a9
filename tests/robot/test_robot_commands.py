"""The commands about robots, and the options of those that take one."""

import json
import subprocess
import sys

import numpy as np
import pytest
from matplotlib.image import imread
from robot_files import gripper_arm, joint, link

from jaxswarm.catalog import BUILTIN
from jaxswarm.cli import main
from jaxswarm.robot import BUILTIN_ROBOTS


@pytest.fixture
def run(monkeypatch, capsys):
    """Exit code, stdout and stderr of a command, in this process."""

    def command(*arguments):
        monkeypatch.setattr(sys, "argv", ["jaxswarm", *map(str, arguments)])
        monkeypatch.setenv("COLUMNS", "200")
        try:
            main()
            code = 0
        except SystemExit as end:
            code = end.code or 0
        return code, *capsys.readouterr()

    return command


@pytest.fixture
def arm(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(gripper_arm("<gazebo/>"))
    return path


def test_the_list_is_that_of_the_robots_and_needs_no_compiler():
    assert {name: make().joints for name, make in BUILTIN_ROBOTS.items()} == {
        name: joints for name, (joints, _) in BUILTIN.items()
    }
    program = (
        "import sys; sys.argv = ['jaxswarm', 'robots', '--json']; from jaxswarm.cli import main; main()"
        "; assert not {'jax', 'numpy'} & set(sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert [row["robot"] for row in json.loads(done.stdout)] == sorted(BUILTIN_ROBOTS)


def test_show_tells_what_was_read(run, arm):
    code, out, err = run("robots", "show", arm, "--lock", "j7=0.5", "--json")
    assert code == 0, err
    result = json.loads(out)
    rows = {row["joint"]: row for row in result["joints"]}
    assert list(rows) == [*(f"j{j}" for j in range(1, 7)), "finger1"]
    assert rows["finger1"]["kind"] == "prismatic" and rows["finger1"]["parent"] == "j6"
    np.testing.assert_allclose(rows["j2"]["axis"], [-np.sin(0.1), np.cos(0.1), 0], atol=1e-6)
    np.testing.assert_allclose(rows["j2"]["origin"], [0, 0, 0.6], atol=1e-12)
    assert (rows["j1"]["lower"], rows["j1"]["upper"], rows["j1"]["effort"]) == (-2.5, 2.5, 80.0)
    # The sixth link carries the seventh, the hand and the second finger.
    assert rows["j6"]["mass"] == pytest.approx(3 / 6 + 3 / 7 + 0.7 + 0.1)
    for note in ("not read: 1 <gazebo>", "joint 'j7' is locked at 0.5"):
        assert note in result["notes"] and note in err


def test_show_prints_a_table_and_draws_a_picture(run, arm, tmp_path):
    picture = tmp_path / "new" / "arm.png"
    code, out, err = run(
        "robots", "show", arm, "--tool", "1.5,0,0,0.1", "--joints", "j1,j2", "--out", picture
    )
    assert code == 0, err
    assert "mass [kg]" in out and "2 moving joints, gravity 0 0 -9.81" in out
    assert "-2.5 .. 2.5 rad" in out
    assert "note: " in err and "tool of 1.5 kg on the link of joint 'j2'" in err
    image = imread(picture)[..., :3]
    reddish = (image[..., 0] > 0.7) & (image[..., 1] < 0.5) & (image[..., 2] < 0.5)
    assert reddish.sum() > 100  # the axes of motion


def test_a_name_cannot_start_a_formula_in_the_picture(run, tmp_path):
    path = tmp_path / "odd.urdf"
    text = gripper_arm().replace('"j1"', '"$x_{$ [/b]"').replace('"gripper_arm"', '"a$b$^"')
    path.write_text(text)
    code, out, err = run("robots", "show", path, "--out", tmp_path / "odd.png")
    assert code == 0, err
    assert "$x_{$ [/b]" in out


def test_a_picture_does_not_replace_a_log(run, tmp_path):
    log = tmp_path / "log.npz"
    log.write_bytes(b"a log")
    code, _, err = run("robots", "show", "rx60", "--out", log)
    assert code == 2 and "ends in .png" in err and log.read_bytes() == b"a log"


@pytest.mark.parametrize(
    ("options", "word"),
    [
        (("--lock", "elbow"), "elbow"),
        (("--tool", "1"), "--tool"),
        (("--gravity", "0,0"), "--gravity"),
        (("--out", "/proc/nowhere/arm.png"), "/proc/nowhere/arm.png"),
    ],
)
def test_bad_options_end_in_one_line(run, arm, options, word):
    code, out, err = run("robots", "show", arm, *options)
    assert code == 2 and out == ""
    assert len(err.splitlines()) == 1 and err.startswith("error: ") and word in err


def test_commands_use_the_chain_of_interest(run, tmp_path):
    """A slide on a column of which nothing was logged: locked, the slide is identified as before."""
    column = joint("column", "base", "post")
    slide = joint("slide", "post", "cart", "prismatic", axis="1 0 0")
    links = link("base") + link("post") + link("cart")
    (tmp_path / "arm.urdf").write_text(f'<robot name="r">{links}{column}{slide}</robot>')
    t = np.arange(400) * 0.01
    phase = 2 * np.pi * np.outer([0.4, 1.1], t)
    amplitude, rate = np.array([[0.2], [0.05]]), 2 * np.pi * np.array([[0.4], [1.1]])
    q = (amplitude * np.sin(phase)).sum(0)
    force = -20 * (amplitude * rate**2 * np.sin(phase)).sum(0)
    table = np.column_stack([t, q, force])
    np.savetxt(tmp_path / "log.csv", table, "%.9g", ",", header="t,q_slide,tau_slide", comments="")
    code, out, err = run(
        "identify", tmp_path / "log.csv", "--robot", tmp_path / "arm.urdf", "--joints", "slide",
        "--effects", "none", "--out", tmp_path / "out", "--json",
    )  # fmt: skip
    assert code == 0, err
    values = {row["name"]: row["value"] for row in json.loads(out)["base_parameters"]}
    assert values["m1"] == pytest.approx(20, rel=0.01)
    assert "locked at 0: column" in err
