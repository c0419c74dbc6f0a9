"""A formula as a Python file with a ready law, and the way back: effects from a file that the user names."""

import importlib.util
import json
import re
import sys
from pathlib import Path

from jaxswarm.effects.base import REGISTRY, Effect, register
from jaxswarm.effects.formula import Formula, formula_law
from jaxswarm.effects.formula_text import python
from jaxswarm.errors import InputError, printable

# Where the effects came from that were registered from files: the same file may be read again after an edit.
_FROM: dict[str, Path] = {}


def law_name(joint: str) -> str:
    """Name of a law that was found on a joint, and of its file.

    >>> law_name("joint 2")
    'discovered_joint_2'
    """
    return re.sub(r"\W", "_", f"discovered_{joint}")


def law_file(formula: Formula, joint: str, other: str | None = None) -> str:
    """The text of a Python file that holds a formula as a law, its nominal values those of the formula.

    Args:
        formula: What was found.
        joint: Name of its joint.
        other: Name of the partner joint, where it reads that joint's motion.
    """
    name, law = law_name(joint), formula_law(formula)
    place = f"{name}@{joint}" + (f":{other}" if other else "")
    terms = " + ".join(
        f'p["{p.name}"] * ({python(term)})'
        for p, term in zip(formula.parameters, formula.terms, strict=False)
    )
    valid = "\n".join(f"    {n}: {low:.6g} to {high:.6g}" for n, low, high in formula.valid)
    table = "\n".join(
        f"        Parameter({_quoted(p.name)}, {_quoted(p.unit)}, {p.lower!r}, {p.upper!r}, {p.linear}, "
        f"{p.nominal!r}, {_quoted(p.description)}, {_quoted(p.scale)}),"
        for p in formula.parameters
    )
    facts = f"    shown_against={_quoted(law.shown_against)},\n"
    facts += "".join(
        f"    {field}={getattr(law, field)!r},\n"
        for field in ("uses_direction", "uses_load", "requires")
        if getattr(law, field)
    )
    return f'''"""{law.summary}: a law found on a log, on {printable(joint)}.

It was seen only where

{valid}

and is a guess elsewhere. Read it, edit it, and declare it by name:

    jaxswarm identify LOG --robot R --effects {printable(place)} --effects-from {name}.py --out DIR
"""

import jax.numpy as jnp

from jaxswarm.effects import Law, Parameter


def torque(p, s):
    """Torque [N m or N] of one sample: see jaxswarm.effects.Sample for what it holds."""
    return {terms}


law = Law(
    name={_quoted(name)},
    scope={_quoted(law.scope)},
    parameters=(
{table}
    ),
    summary={_quoted(law.summary)},
    reference="found on a log by jaxswarm diagnose --discover",
    torque=torque,
{facts})
'''


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def register_from(path: Path) -> tuple[str, ...]:
    """Import a Python file and register every effect it holds; return their names.

    The file is run as a program: pass only what you have read.

    Raises:
        InputError: If it cannot be imported, holds no effect, or one whose name is taken.
    """
    path = Path(path)
    if path.suffix != ".py" or not path.is_file():
        raise InputError(f"--effects-from {path}: is no Python file; pass one that holds a Law")
    module = _imported(path)
    found = {id(x): x for x in vars(module).values() if isinstance(x, Effect)}
    if not found:
        raise InputError(
            f"--effects-from {path}: holds no effect; make one with jaxswarm.effects.Law(...)"
        )
    for effect in found.values():
        if REGISTRY.get(effect.name) is effect:
            _FROM[effect.name] = path.resolve()  # it registered itself
            continue
        try:
            register(effect)
        except ValueError as error:
            raise InputError(f"--effects-from {path}: {error}") from None
        _FROM[effect.name] = path.resolve()
    return tuple(effect.name for effect in found.values())


def _imported(path: Path):
    for name in [n for n, source in _FROM.items() if source == path.resolve()]:
        # A file that registers its law itself can do so again.
        REGISTRY.pop(name, None)
    spec = importlib.util.spec_from_file_location(f"_effects_{path.stem}", path)
    assert spec is not None and spec.loader is not None  # it ends in .py
    module = importlib.util.module_from_spec(spec)
    kept, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:  # a file that ends the program would end it in silence
        raise InputError(
            f"--effects-from {path}: cannot be run ({type(error).__name__}: {error}); mend the file"
        ) from None
    finally:
        sys.dont_write_bytecode = kept
    return module
