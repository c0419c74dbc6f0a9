"""Pieces of a self-contained page; every text is escaped here and nowhere else."""

import base64
import re
from collections.abc import Iterable
from html import escape
from urllib.parse import quote_plus

from jaxswarm.diagnose.report.grids import Grid

# Cells with more characters than this may wrap; shorter ones stay on one line.
_SHORT = 26
# On a telephone two cells with their heads stand on a line of a list, of so many characters each.
_HALF = 16
# Pixels that a page leaves to a table, that a character takes, and that lie between two columns: on a telephone
# of 390, where the rows of a wider table stand as lists, and on a desk, where its heads wrap.
_TELEPHONE, _DESK = (358.0, 7.5, 12.0), (1080.0, 8.5, 24.0)
# What was published tells its year.
_YEAR = r"\b(1[6-9]|20)\d\d\b"


def text(tag: str, content: str, kind: str = "") -> str:
    """An element with escaped text; nothing where there is no text."""
    attribute = f' class="{kind}"' if kind else ""
    return f"<{tag}{attribute}>{escape(content)}</{tag}>" if content else ""


def bullets(lines: Iterable[str]) -> str:
    """A list of sentences; nothing where there are none."""
    items = "".join(text("li", line) for line in lines)
    return f"<ul>{items}</ul>" if items else ""


def table(grid: Grid, label: str) -> str:
    """A table; on a telephone the rows of a wide one are lists of cells, each with the head of its column.

    Args:
        grid: Its content.
        label: What it shows, for those who hear the page.
    """
    if not grid.rows:
        return ""
    columns = range(len(grid.head))
    kinds = [_kind(grid.head[k], [row[k] for row in grid.rows]) for k in columns]
    head = "".join(_cell("th", grid.head[k], kinds[k]) for k in columns)
    body = "".join(
        f"<tr{' class=far' if number in grid.flagged else ''}>"
        + "".join(_cell("td", row[k], kinds[k], grid.head[k]) for k in columns)
        + "</tr>"
        for number, row in enumerate(grid.rows)
    )
    wide = " wide" * _exceeds(grid, *_TELEPHONE) + " heads" * _exceeds(grid, *_DESK)
    return (
        f'<div class="scroll{wide}" role="region" tabindex="0" aria-label="{escape(label)}">'
        f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _kind(head: str, cells: list[str]) -> str:
    """How a column is set: ``n`` numbers, ``w`` words that wrap, ``l`` a line of its own in a list."""
    longest = max(map(len, cells))
    if longest > _SHORT:
        return "w"
    number = any(cell.lstrip("-")[:1].isdigit() for cell in cells)
    return " ".join(["n"] * number + ["l"] * (longest + len(head) > _HALF))


def _exceeds(grid: Grid, width: float, character: float, room: float) -> bool:
    """Whether a table is wider than that with every cell on one line."""
    longest = (max(map(len, cells)) for cells in zip(grid.head, *grid.rows, strict=True))
    return sum(character * most + room for most in longest) > width


def _cell(tag: str, content: str, kind: str, head: str = "") -> str:
    attributes = f' class="{kind}"' if kind else ""
    attributes += f' data-head="{escape(head)}"' if head else ""
    return f"<{tag}{attributes}>{escape(content)}</{tag}>"


def source(reference: str) -> str:
    """Where a law comes from; of what was published a search that finds it, opened by whoever wants."""
    if not re.search(_YEAR, reference):
        return text("small", f"Law: {reference}" if reference else "")
    address = f"https://search.crossref.org/search/works?q={quote_plus(reference)}&from_ui=yes"
    return f'<small>Law: <a href="{escape(address)}">{escape(reference)}</a></small>'


def image(images: dict[str, bytes], name: str, words: str) -> str:
    """A picture with its content in words, which also stand below it; nothing where it was not drawn."""
    if name not in images:
        return ""
    data = base64.b64encode(images[name]).decode()
    told = escape(words)
    return (
        f'<figure><div class="scroll" tabindex="0"><img alt="{told}" '
        f'src="data:image/png;base64,{data}"></div><figcaption>{told}</figcaption></figure>'
    )


def folded(title: str, content: str) -> str:
    """Content behind its title, to be opened; nothing where there is no content."""
    if not content:
        return ""
    return f"<details><summary>{escape(title)}</summary>{content}</details>"


def download(name: str, content: str, kind: str) -> str:
    """A link that saves text as a file, without anything outside of the page."""
    data = base64.b64encode(content.encode("utf-8", "backslashreplace")).decode()
    return (
        f'<p class="download"><a download="{escape(name)}" href="data:{kind};base64,{data}">'
        f"Download {escape(name)}</a> ({len(content) / 1024:.0f} KiB)</p>"
    )
