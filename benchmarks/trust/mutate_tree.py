"""Documents changed by structure: XML elements and attributes, values of JSON and TOML."""

import copy
import json
import tomllib
from collections.abc import Iterator
from xml.etree import ElementTree

import numpy as np

from benchmarks.trust.mutate_numbers import value, word

_TAGS = (
    "joint",
    "link",
    "robot",
    "mass",
    "origin",
    "mimic",
    "axis",
    "inertial",
    "body",
    "geom",
    "include",
)


def spoil_xml(rng: np.random.Generator, text: str) -> str:
    """The document with one to three of its elements or attributes changed."""
    root = ElementTree.fromstring(text)
    for _ in range(1 + rng.binomial(2, 0.25)):
        elements = list(root.iter())
        one = elements[rng.integers(len(elements))]
        action = rng.integers(7)
        if action == 0 and len(one):
            one.remove(one[rng.integers(len(one))])
        elif action == 1 and len(one):
            one.append(copy.deepcopy(one[rng.integers(len(one))]))
        elif action == 2:
            one.tag = str(rng.choice(_TAGS))
        elif action == 3:
            one.text = _fit(word(rng))
        elif one.attrib:
            key = str(rng.choice(list(one.attrib)))
            if action == 4:
                del one.attrib[key]
            else:
                one.set(key, _fit(word(rng)))
    return ElementTree.tostring(root, encoding="unicode")


def spoil_json(rng: np.random.Generator, text: str) -> str:
    """The document with one to three of its values changed, doubled or taken away."""
    return json.dumps(_spoiled(rng, json.loads(text)))


def spoil_toml(rng: np.random.Generator, text: str) -> str:
    """The same of a TOML file; what TOML cannot say is left as it was."""
    content = _spoiled(rng, tomllib.loads(text))
    return "\n".join(_toml(content)) + "\n"


def _spoiled(rng: np.random.Generator, content):
    for _ in range(1 + rng.binomial(2, 0.25)):
        places = list(_places(content))
        if not places:
            return content
        inside, key = places[rng.integers(len(places))]
        action = rng.integers(5)
        if action == 0:
            del inside[key]
        elif action == 1 and isinstance(inside, list):
            inside.append(copy.deepcopy(inside[key]))
        elif action == 2 and isinstance(inside, dict):
            inside[word(rng)] = copy.deepcopy(inside[key])
        elif action == 3:
            other, there = places[rng.integers(len(places))]
            inside[key] = copy.deepcopy(other[there])
        else:
            inside[key] = value(rng)
    return content


def _places(content) -> Iterator[tuple]:
    """Every value of a document, as what it stands in and its key there."""
    items = content.items() if isinstance(content, dict) else enumerate(content)
    for key, inner in list(items):
        yield content, key
        if isinstance(inner, dict | list):
            yield from _places(inner)


def _fit(text: str) -> str:
    """Characters that XML can hold."""
    return "".join(
        c for c in text if c in "\t\n" or " " <= c < "\ud800" or "\ue000" <= c < "\ufffe"
    )


def _toml(content: dict) -> Iterator[str]:
    tables = {k: v for k, v in content.items() if isinstance(v, dict)}
    blocks = {
        k: v
        for k, v in content.items()
        if isinstance(v, list) and v and all(isinstance(x, dict) for x in v)
    }
    for key, inner in content.items():
        if key not in tables and key not in blocks and inner is not None:
            yield f"{_key(key)} = {_inline(inner)}"
    for key, table in tables.items():
        yield f"[{_key(key)}]"
        yield from (f"{_key(k)} = {_inline(v)}" for k, v in table.items() if v is not None)
    for key, several in blocks.items():
        for table in several:
            yield f"[[{_key(key)}]]"
            yield from (f"{_key(k)} = {_inline(v)}" for k, v in table.items() if v is not None)


def _key(text: str) -> str:
    return json.dumps(text.encode("utf-8", "replace").decode())


def _inline(inner) -> str:
    if isinstance(inner, bool):
        return str(inner).lower()
    if isinstance(inner, dict):
        parts = (f"{_key(k)} = {_inline(v)}" for k, v in inner.items() if v is not None)
        return "{" + ", ".join(parts) + "}"
    if isinstance(inner, list):
        return "[" + ", ".join(_inline(v) for v in inner if v is not None) + "]"
    return _key(inner) if isinstance(inner, str) else repr(inner)
