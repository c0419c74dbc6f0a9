"""A study's report as one self-contained HTML page: headings, sentences, tables, pictures."""

from collections.abc import Iterable, Sequence
from html import escape

from jaxswarm.diagnose.report import markup
from jaxswarm.diagnose.report.grids import Grid
from jaxswarm.diagnose.report.style import STYLE

# Beside the style of every page: what rests on a reconstruction, light and dark.
_OWN = """
.verdict li{margin:.3rem 0}.verdict{max-width:none;padding-left:2rem}
.reconstruction{background:var(--box);border-left:6px solid #edae49;padding:.5rem 1rem .5rem 2rem;
max-width:none}
"""


def number(value: float | None, digits: int = 3) -> str:
    """A number as the tables show it; an absent one is a dash.

    >>> number(0.012345), number(None), number(2.5e-9)
    ('0.0123', '–', '2.5e-09')
    """
    return "–" if value is None or value != value else f"{value:.{digits}g}"


def heading(text: str) -> str:
    """A section's heading."""
    return markup.text("h2", text)


def sentence(text: str) -> str:
    """A paragraph."""
    return markup.text("p", text)


def verdicts(texts: Iterable[str]) -> str:
    """The findings, first thing on the page."""
    return "<ul class=verdict>" + "".join(f"<li>{escape(t)}</li>" for t in texts) + "</ul>"


def reconstructions(texts: Iterable[str]) -> str:
    """What rests on a reconstruction, in the color that marks it everywhere on the page.

    >>> reconstructions(["bounds"])
    '<ul class=reconstruction><li>Reconstruction: bounds</li></ul>'
    """
    items = "".join(f"<li>Reconstruction: {escape(t)}</li>" for t in texts)
    return f"<ul class=reconstruction>{items}</ul>"


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table; floats are shown with three digits."""
    told = [tuple(_cell(value) for value in row) for row in rows]
    return markup.table(Grid(tuple(head), told), f"table of {', '.join(filter(None, head))}")


def picture(name: str, data: bytes, words: str) -> str:
    """A PNG inside the page, with its content in words, which also stand below it."""
    return markup.image({name: data}, name, words)


def page(title: str, parts: Iterable[str]) -> str:
    """The whole page."""
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        f'<link rel="icon" href="data:,"><title>{escape(title)}</title><style>{STYLE}{_OWN}</style></head>'
        f"<body><main><h1>{escape(title)}</h1>{''.join(parts)}</main></body></html>\n"
    )


def _cell(value: object) -> str:
    if value is None or isinstance(value, float):
        return number(value)
    return str(value)
