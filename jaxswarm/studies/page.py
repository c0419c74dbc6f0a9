"""A study's report as one self-contained HTML page: headings, sentences, tables, pictures."""

import base64
from collections.abc import Iterable, Sequence
from html import escape

_STYLE = """
body{font:15px/1.5 system-ui,sans-serif;max-width:66rem;margin:2rem auto;padding:0 1rem;color:#222}
h1{font-size:1.5rem;margin-bottom:.2rem}h2{font-size:1.15rem;margin-top:2.2rem}
.verdict{background:#f3f6f8;border-left:5px solid #2e6f95;padding:.8rem 1rem}
.reconstruction{background:#fdf6e3;border-left:5px solid #edae49;padding:.5rem 1rem}
.wide{overflow-x:auto}table{border-collapse:collapse;margin:.6rem 0;font-size:.86rem}
td,th{padding:.2rem .55rem;border-bottom:1px solid #ddd;text-align:right;white-space:nowrap}
td:first-child,th:first-child{text-align:left}th{background:#fafafa;font-weight:600}
img{max-width:100%;margin:.4rem 0}
"""


def number(value: float | None, digits: int = 3) -> str:
    """A number as the tables show it; an absent one is a dash.

    >>> number(0.012345), number(None), number(2.5e-9)
    ('0.0123', '–', '2.5e-09')
    """
    return "–" if value is None or value != value else f"{value:.{digits}g}"


def heading(text: str) -> str:
    """A section's heading."""
    return f"<h2>{escape(text)}</h2>"


def sentence(text: str) -> str:
    """A paragraph."""
    return f"<p>{escape(text)}</p>"


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
    top = "".join(f"<th>{escape(h)}</th>" for h in head)
    body = "".join("<tr>" + "".join(f"<td>{_cell(c)}</td>" for c in row) + "</tr>" for row in rows)
    return f"<div class=wide><table><tr>{top}</tr>{body}</table></div>"


def picture(name: str, data: bytes) -> str:
    """A PNG inside the page."""
    text = base64.b64encode(data).decode()
    return f'<img alt="{escape(name)}" src="data:image/png;base64,{text}">'


def page(title: str, parts: Iterable[str]) -> str:
    """The whole page."""
    return (
        f"<!doctype html><html lang=en><head><meta charset=utf-8><title>{escape(title)}</title>"
        f"<style>{_STYLE}</style></head><body><h1>{escape(title)}</h1>{''.join(parts)}</body></html>\n"
    )


def _cell(value: object) -> str:
    if value is None or isinstance(value, float):
        return number(value)
    return escape(str(value))
