"""The words of whole commands: right and odd options, in any combination."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.trust.command_files import Files
from benchmarks.trust.mutate_numbers import INTEGERS, number, word

# Share of values of options that are odd, and of files that are spoiled: of all right ones every combination
# has to work or be refused for a reason; of many wrong ones the first ends the command.
_MOODS = ((0.0, 0.0), (0.05, 0.1), (0.25, 0.5))
# Share of the options of a command that are given.
_GIVEN = 0.25
_EFFECTS = (
    "none", "viscous_friction", "coulomb_friction,viscous_friction", "joint_spring@joint1", "payload",
    "contact,payload", "viscous_friction,viscous_friction", "hysteresis@joint2", "temperature_friction",
    "time_delay", "backlash@joint2", "transmission_coupling@joint1", "stribeck_friction", "base_tilt",
)  # fmt: skip
_ARM = {
    "--joints": ("joint1", "joint1,joint2", "joint2"),
    "--lock": ("joint2", "joint1=0.3"),
    "--tool": ("1,0,0,0.1", "1,0,0,0.1,1,0,1,0,0,1"),
    "--gravity": ("0,0,-9.81", "0,0,0"),
}
_READ = {
    "--columns": ("t:s", "q=q_{joint}:deg,tau=tau_joint{k}", "temperature_joint1=temperature_joint2"),
    "--topic": ("/joint_states", "a"),
    "--side": ("motor", "link"),
    "--effort": ("torque", "current"),
}  # fmt: skip
_FIT = {
    **_ARM,
    "--seed": (0, 3),
    "--motion-cutoff": (8, 20),
    "--torque-cutoff": (5, 10),
    "--accept": ("no_relation", "spikes", "saturation"),
    "--json": (),
    "--plain": (),
    "--quiet": (),
}
_MODES = {"--json": (), "--plain": (), "--quiet": ()}
_LAW = """from jaxswarm.effects import examples
raise_nothing = examples
"""


class Words:
    """What one command is made of: random numbers, a share of odd values, its files and its output."""

    def __init__(self, rng: np.random.Generator, folder: Path):
        self.rng, self.out, self.folder = rng, folder / "out", folder
        self.odd, spoiled = _MOODS[rng.integers(len(_MOODS))]
        self.files = Files(rng, folder, spoiled)

    def value(self, *right) -> str:
        """One of the right values, or an odd one."""
        if self.rng.random() >= self.odd:
            return str(right[self.rng.integers(len(right))])
        odd = (number(self.rng), INTEGERS[self.rng.integers(len(INTEGERS))], word(self.rng))
        return str(odd[self.rng.integers(3)])

    def options(self, *tables: dict[str, tuple]) -> list[str]:
        """Some of the options of a command, a switch without a value."""
        given: list[str] = []
        for table in tables:
            for name, right in table.items():
                if self.rng.random() < _GIVEN * (0.3 if table is _READ else 1.0):
                    given += [name, self.value(*right)] if right else [name]
        return given

    def law(self) -> Path:
        """A file with laws of a user: an empty one, or one that is none."""
        path = self.folder / "law.py"
        path.write_text(_LAW if self.rng.random() >= self.odd else word(self.rng), errors="replace")
        return path


def _identify(w: Words) -> list:
    more = {
        "--optimizer": ("least_squares", "gpso"),
        "--runs": (1, 2),
        "--steps": (5,),
        "--estimator": ("least_squares", "instrumental", "output_error"),
        "--physical": (),
        "--free-base": (),
        "--raw": (),
        "--prior": (w.files.robot(),),
        "--prior-weight": (0.03, 1),
        "--validation": (w.files.log(),),
    }
    effects = w.value(*_EFFECTS)
    log, robot = w.files.log(), w.files.robot()
    given = [log, "--robot", robot, "--effects", effects, "--out", w.out]
    return [*given, *w.options(_FIT, _READ, more)]


def _diagnose(w: Words) -> list:
    more = {"--validation": (w.files.log(),), "--budget": (1, 20), "--effects-from": (w.law(),)}
    if w.rng.random() < 0.1:
        more["--discover"] = ()
    base = ["--declare", w.value(*_EFFECTS)]
    if w.rng.random() < 0.5:
        base = ["--model", w.files.model()]
    given = [w.files.log(), "--robot", w.files.robot(), *base, "--out", w.out]
    return [*given, *w.options(_FIT, _READ, more)]


def _fleet(w: Words) -> list:
    more = {"--arm-pattern": ("(?P<arm>a.)", "(?P<arm>a.)/(?P<date>.*)"), "--against": ("fleet",),
            "--declare": _EFFECTS, "--adaptive": ()}  # fmt: skip
    words = ["--fleet", w.files.logs(), "--robot", w.files.robot(), "--out", w.out]
    return [*words, "--workers", w.value(1), "--budget", "5", *w.options(more, _MODES)]


def _predict(w: Words) -> list:
    return [w.files.model(), w.files.log(), "--out", f"{w.out}.csv", *w.options(_READ, _MODES)]


def _simulate(w: Words) -> list:
    more = {"--kp": (100, "100,50"), "--kd": (10,), "--feedforward": ("rigid", "none"), "--rate": (50, 200),
            "--playback": ()}  # fmt: skip
    given = [w.files.model(), "--reference", w.files.log(), "--out", f"{w.out}.csv"]
    return [*given, *w.options(more, _READ, _MODES)]


def _export(w: Words) -> list:
    kind = w.value("urdf", "mjcf", "sdf", "yaml", "c")
    more = {
        "--log": (w.files.log(),),
        "--prior": (w.files.robot(),),
        "--prior-weight": (0.03,),
    }
    given = [w.files.model(), "--format", kind, "--out", f"{w.out}.txt"]
    return [*given, *w.options(more, _MODES)]


def _excite(w: Words) -> list:
    more = {"--effects": _EFFECTS, "--duration": (2, 10), "--seed": (1,), "--given": (w.files.model(),),
            "--separate": ("viscous_friction@joint1,coulomb_friction@joint1",)}  # fmt: skip
    given = ["--robot", w.files.robot(), "--limits", w.files.limits(), "--out", w.out]
    return [*given, *w.options(_ARM, more, _MODES)]


def _inspect(w: Words) -> list:
    more = {"--robot": (w.files.robot(),), "--out": (w.out,)}
    return [w.files.log(), w.files.log(), *w.options(more, _ARM, _READ, _MODES)]


def _compare(w: Words) -> list:
    return [w.files.model(), w.files.model(), *w.options(_MODES)]


def _show(w: Words) -> list:
    return ["show", w.files.robot(), *w.options(_ARM, {"--out": (f"{w.out}.png",)}, _MODES)]


def _odd_name(w: Words) -> list:
    """A study or a data set that there is not."""
    return [word(w.rng), "--out", w.out, *w.options({"--seed": (1,), "--fast": ()}, _MODES)]


def _nothing(w: Words) -> list:
    return w.options(_MODES)


Maker = Callable[[Words], list]
# How often a command is tried beside the others.
COMMANDS: dict[str, tuple[Maker, int]] = {
    "identify": (_identify, 8),
    "diagnose": (_diagnose, 8),
    "diagnose --fleet": (_fleet, 1),
    "predict": (_predict, 4),
    "simulate": (_simulate, 4),
    "export": (_export, 4),
    "excite": (_excite, 3),
    "inspect": (_inspect, 4),
    "compare": (_compare, 2),
    "robots": (_show, 4),
    "study": (_odd_name, 1),
    "fetch": (_odd_name, 1),
    "effects": (_nothing, 1),
    "optimizers": (_nothing, 1),
    "doctor": (_nothing, 1),
}


def words_of(rng: np.random.Generator, folder: Path) -> list[str]:
    """A command with its files in a folder; its output is ``out`` there."""
    names = [name for name, (_, often) in COMMANDS.items() for _ in range(often)]
    name = names[rng.integers(len(names))]
    words = [name.split()[0], *COMMANDS[name][0](Words(rng, folder))]
    return [str(w).replace("\x00", "").encode("utf-8", "replace").decode() for w in words]
