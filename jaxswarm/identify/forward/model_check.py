"""What a ``model.json`` must hold, checked value by value before a model is built from it."""

from dataclasses import fields

import numpy as np

from jaxswarm.effects.base import REGISTRY, Effect, get_law
from jaxswarm.effects.formula import formula_law, from_json
from jaxswarm.effects.parameter import assumed
from jaxswarm.errors import InputError, nearest
from jaxswarm.logs.motion import Filtering
from jaxswarm.robot.checks import LARGEST, shown

_KINDS = ("revolute", "prismatic")


def check_content(content: dict) -> None:
    """Refuse content that is incomplete, of the wrong shape or without a meaning.

    Raises:
        InputError: Naming the place and what was expected there.
    """
    robot = _get(content, "robot", dict, "")
    _get(robot, "name", str, "robot.")
    joints = _get(robot, "joints", list, "robot.")
    n = len(joints)
    if not n or not all(isinstance(j, str) for j in joints) or len(set(joints)) < n:
        raise InputError("robot.joints is no list of different names; identify it again")
    _each(robot, "kinds", n, lambda kind, _: kind in _KINDS, f"one of {', '.join(_KINDS)}")
    _each(robot, "parents", n, _is_earlier, "the index of an earlier joint, or -1")
    shapes = {"rotation": (n, 3, 3), "translation": (n, 3), "axis": (n, 3), "gravity": (3,)}
    for name, shape in {**shapes, "parameters": (n, 10)}.items():
        _check_array(_get(robot, name, list, "robot."), shape, f"robot.{name}")
    _each(robot, "drive_gain", n, lambda g, _: g is None or _is_number(g), "a number or null")
    for k, term in enumerate(_get(content, "terms", list, "")):
        _check_term(term, joints, f"terms[{k}]")
    width = content.get("width")
    if not isinstance(width, list):  # older files hold one for all joints
        content = {**content, "width": [width] * n}
    _each(content, "width", n, lambda w, _: _is_number(w) and w > 0, "a positive number", "")
    _check_filtering(_get(content, "filtering", dict, ""))
    _each(content, "sigma", n, lambda s, _: _is_number(s) and s >= 0, "a number not below 0", "")


def _check_filtering(filtering: dict) -> None:
    names = {field.name for field in fields(Filtering)}
    older = set(filtering) | {"weight_skew"}  # files written before the weight had a clock lack it
    if older != names:
        raise InputError(f"filtering has {sorted(filtering)}, not {sorted(names)}; identify again")
    for name, value in filtering.items():
        if name == "use_logged_velocity":
            holds, expected = isinstance(value, bool), "true, false or null"
        elif name.endswith("_cutoff"):
            holds, expected = _is_number(value) and value > 0, "a positive number or null"
        else:
            holds, expected = _is_number(value), "a number or null"
        if value is not None and not holds:
            raise InputError(f"filtering.{name} is {value!r}, not {expected}")


def _check_term(term, joints: list[str], place: str) -> None:
    if not isinstance(term, dict):
        raise InputError(f"{place} is no object; identify it again")
    law = _law_of(term, place)
    wanted = {"joint": law.scope != "global", "other": law.scope == "pair"}
    for name, needed in wanted.items():
        joint = term.get(name)
        if needed and joint not in joints:
            hint = nearest(joint, joints) if isinstance(joint, str) else f"Known: {joints}."
            raise InputError(f"{place}.{name} is {joint!r}, no joint of this robot. {hint}")
        if not needed and joint is not None:
            raise InputError(f"{place}.{name} is {joint!r}, but {law.name} takes none")
    if law.scope == "pair" and term["joint"] == term["other"]:
        raise InputError(f"{place}: {law.name} couples {term['joint']} with itself")
    given = _get(term, "values", dict, f"{place}.")
    values = {**assumed(law.parameters), **given}
    names = [p.name for p in law.parameters]
    for name in dict.fromkeys([*names, *law.linear_names(tuple(joints))]):
        if not _is_number(values.get(name)):
            raise InputError(
                f"{place} ({law.name}) lacks a number up to {LARGEST:g} for {name}, it has "
                f"{shown(values.get(name))}"
            )
    for p in law.parameters:
        if p.scale == "log" and values[p.name] <= 0:
            raise InputError(f"{place} ({law.name}): {p.name} is {values[p.name]}, not above zero")


def _law_of(term: dict, place: str) -> Effect:
    name = _get(term, "effect", str, f"{place}.")
    if "formula" not in term:
        if name not in REGISTRY:
            raise InputError(
                f"{place}: unknown effect {name!r}. {nearest(name, REGISTRY)} A law of yours needs "
                "--effects-from FILE (jaxswarm.effects.register_from)"
            )
        return get_law(name)
    try:
        return formula_law(from_json(_get(term, "formula", dict, f"{place}.")))
    except ValueError as error:
        raise InputError(f"{place}.formula: {error}; diagnose it again") from None


def _get(content: dict, name: str, kind: type, place: str):
    value = content.get(name)
    if not isinstance(value, kind):
        words: dict[type, str] = {dict: "object", list: "list", str: "text"}
        word = words[kind]
        found = "missing" if name not in content else f"no {word}"
        raise InputError(f"{place}{name} is {found}; pass a model.json as identify wrote it")
    return value


def _each(content, name, count, holds, expected, place="robot."):
    values = _get(content, name, list, place)
    if len(values) != count:
        raise InputError(f"{place}{name} has {len(values)} entries, the robot {count} joints")
    for k, value in enumerate(values):
        if not holds(value, k):
            raise InputError(f"{place}{name}[{k}] is {value!r}, not {expected}")


def _is_number(x) -> bool:
    # False for NaN, too, and for integers of any length.
    return isinstance(x, int | float) and not isinstance(x, bool) and abs(x) <= LARGEST


def _is_earlier(parent, k: int) -> bool:
    return isinstance(parent, int) and not isinstance(parent, bool) and -1 <= parent < k


def _check_array(values: list, shape: tuple[int, ...], place: str) -> None:
    try:
        array = np.asarray(values)
    except (TypeError, ValueError, OverflowError):
        array = np.asarray(None)
    if array.size and array.dtype.kind not in "iuf":  # "1.0" would pass for the number it spells
        raise InputError(f"{place} holds something that is no number")
    if array.shape != shape or not (np.abs(array) <= LARGEST).all():  # false for NaN, too
        raise InputError(
            f"{place} is no array of {' x '.join(map(str, shape))} finite numbers up to {LARGEST:g}"
        )
