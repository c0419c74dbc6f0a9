"""Pages in a headless browser: two widths, light, dark, on paper; no table that scrolls, a silent console."""

import re
import shutil
import subprocess
from html import escape
from pathlib import Path

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
_VIEWS = [(w, mode) for w in (390, 1280) for mode in ("light", "dark")]
# Everything is opened; then the width of the window, of the page, and what the widest table scrolls by.
_MEASURE = (
    "<script>document.querySelectorAll('details').forEach(function(d){d.open=true});"
    "parent.document.documentElement.dataset.seen=innerWidth+' '+document.documentElement.scrollWidth+' '+"
    "Math.max(0,...Array.from(document.querySelectorAll('table'),"
    "function(t){return t.scrollWidth-t.parentElement.clientWidth}))</script></body>"
)


def browser() -> str | None:
    """A browser on the path."""
    return next((found for name in BROWSERS if (found := shutil.which(name))), None)


def _run(folder: Path, *words: str) -> subprocess.CompletedProcess:
    options = ("--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder / 'user'}")
    command = [str(browser()), *options, *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def printed(page: Path, paper: Path) -> str:
    """How many sheets a page takes; leaves them as PDF."""
    _run(paper.parent, f"--print-to-pdf={paper}", page.resolve().as_uri())
    sheets = len(re.findall(rb"/Type ?/Page\b", paper.read_bytes())) if paper.exists() else 0
    return f"{sheets} sheets" if sheets else "not printed"


def look(page: Path, frame: Path, width: int, mode: str) -> str:
    """What is wrong with a page at a width; ``fits`` where nothing is. Leaves a picture beside the frame."""
    inside = escape(page.read_text(encoding="utf-8").replace("</body>", _MEASURE))
    # A window is no narrower than 500 pixels: the page stands in a frame of this width.
    style = f"width:{width}px;height:2400px;border:0"
    frame.write_text(
        '<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">'
        f'<iframe srcdoc="{inside}" style="{style}"></iframe>',
        encoding="utf-8",
    )
    dark = ["--blink-settings=preferredColorScheme=0"] if mode == "dark" else []
    run = _run(
        frame.parent, "--hide-scrollbars", f"--window-size={width + 20},2400", "--enable-logging=stderr",
        *dark, f"--screenshot={frame.with_suffix('.png')}", "--dump-dom", frame.resolve().as_uri(),
    )  # fmt: skip
    seen = re.search(r'data-seen="(\d+) (\d+) (\d+)"', run.stdout)
    said = [line for line in run.stderr.splitlines() if "CONSOLE" in line]
    if seen is None:
        return "not drawn"
    if int(seen[2]) > width:
        return f"{seen[2]} pixels wide"
    if int(seen[3]):
        return f"a table scrolls by {seen[3]} pixels"
    return f"console: {said[0][-60:]}" if said else "fits"


def table(pages: list[Path], folder: Path) -> str:
    """A row a page with the outcome of every view."""
    if browser() is None:
        return "no browser on the PATH: pages were not looked at"
    lines = [
        "| page | " + " | ".join(f"{w} px, {mode}" for w, mode in _VIEWS) + " | on paper |",
        "|---|" + "---|" * (len(_VIEWS) + 1),
    ]
    for number, page in enumerate(pages):
        name = f"{number}_{page.parent.name}_{page.stem}"
        seen = [look(page, folder / f"{name}_{w}_{mode}.html", w, mode) for w, mode in _VIEWS]
        seen.append(printed(page, folder / f"{name}.pdf"))
        lines.append(f"| {page.parent.name}/{page.name} | {' | '.join(seen)} |")
    return "\n".join(lines)
