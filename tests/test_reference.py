"""The reference printed by ``python -m jaxswarm.reference`` names everything there is."""

import re
import subprocess
import sys

import pytest
import typer

import jaxswarm
from jaxswarm.cli import app
from jaxswarm.effects import REGISTRY
from jaxswarm.reference import main, markdown
from jaxswarm.swarm import OPTIMIZERS


@pytest.fixture(scope="module")
def text():
    return markdown()


def test_how_to_go_on_comes_first_and_its_examples_are_run(text):
    chapters = text.split("\n## ")[1].split("\n### ")
    titles = [chapter.splitlines()[0] for chapter in chapters[1:]]
    assert titles[:3] == ["Your robot", "Your log", "Your effect"] and len(titles) == 7
    for chapter in chapters[1:]:
        assert "```python\n>>> " in chapter, chapter.splitlines()[0]
        assert chapter.count("```") % 2 == 0 and "``" not in chapter.replace("```", "")
    options = {o for o in re.findall(r"`?(--[a-z-]+)", "".join(chapters))}
    known = {
        o for c in typer.main.get_command(app).commands.values() for p in c.params for o in p.opts
    }
    assert options <= known, options - known


def test_every_effect_with_its_parameters_and_source(text):
    for law in REGISTRY.values():
        part = text.split(f"### `{law.name}`\n")[1].split("\n### ")[0]
        assert law.reference.split("|")[0].split("\n")[0][:30] in part
        for p in law.parameters:
            assert f"| `{p.name}` | {p.unit} |" in part


def test_every_optimizer(text):
    for name in OPTIMIZERS:
        assert f"| `{name}` |" in text


def test_every_command_with_its_options_and_an_example(text):
    for name, command in typer.main.get_command(app).commands.items():
        part = text.split(f"### `jaxswarm {name}`\n")[1].split("\n### ")[0]
        assert f"Example: `jaxswarm {name}" in part, name
        for parameter in command.params:
            for option in parameter.opts if parameter.param_type_name == "option" else []:
                assert option in part, (name, option)


def test_every_public_name_says_what_it_is(text):
    for name in jaxswarm.__all__:
        row = re.search(rf"^\| `jaxswarm\.{name}\b.*\| (.*) \|$", text, re.MULTILINE)
        assert row and len(row[1]) > 10, name


def test_it_is_the_same_every_time_and_its_tables_are_whole(text, capsys):
    main()
    assert capsys.readouterr().out == text + "\n"
    assert " at 0x" not in text
    for block in re.findall(r"(?:^\|.*\n)+", text + "\n", re.MULTILINE):
        counts = {len(re.findall(r"(?<!\\)\|", line)) for line in block.splitlines()}
        assert len(counts) == 1, block[:200]


def test_a_reader_that_leaves_and_a_full_disk_end_in_no_traceback():
    words = [sys.executable, "-m", "jaxswarm.reference"]
    pipe = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    pipe.stdout.close()
    assert pipe.stderr.read() == "" and pipe.wait() != 0
    with open("/dev/full", "wb") as full:
        done = subprocess.run(words, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 2 and done.stderr.startswith("error: cannot print")
