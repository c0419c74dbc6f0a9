"""The page of a diagnosis in a headless browser: two widths, light and dark, without a word on the console."""

import re
import shutil
import subprocess
from html import escape
from pathlib import Path

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
_VIEWS = [(w, mode) for w in (390, 1280) for mode in ("light", "dark")]
_MEASURE = (
    "<script>parent.document.documentElement.dataset.seen="
    "innerWidth+' '+document.documentElement.scrollWidth</script></body>"
)


def browser() -> str | None:
    """A browser on the path."""
    return next((found for name in BROWSERS if (found := shutil.which(name))), None)


def look(page: Path, folder: Path, width: int, mode: str) -> str:
    """What is wrong with a page at a width; ``fits`` where nothing is. Leaves a picture in the folder."""
    inside = escape(page.read_text(encoding="utf-8").replace("</body>", _MEASURE))
    frame = folder / f"{page.stem}_{width}_{mode}.html"
    # A window is no narrower than 500 pixels: the page stands in a frame of this width.
    style = f"width:{width}px;height:2400px;border:0"
    frame.write_text(
        '<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">'
        f'<iframe srcdoc="{inside}" style="{style}"></iframe>',
        encoding="utf-8",
    )
    dark = ["--blink-settings=preferredColorScheme=0"] if mode == "dark" else []
    run = subprocess.run(
        [str(browser()), "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
         f"--user-data-dir={folder / 'user'}", f"--window-size={width + 20},2400",
         "--enable-logging=stderr", *dark, f"--screenshot={frame.with_suffix('.png')}", "--dump-dom",
         frame.resolve().as_uri()],
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    seen = re.search(r'data-seen="(\d+) (\d+)"', run.stdout)
    said = [line for line in run.stderr.splitlines() if "CONSOLE" in line]
    if seen is None:
        return "not drawn"
    if int(seen[2]) > width:
        return f"{seen[2]} pixels wide"
    return f"console: {said[0][-60:]}" if said else "fits"


def table(pages: list[Path], folder: Path) -> str:
    """A row a page with the outcome of every view."""
    if browser() is None:
        return "no browser on the PATH: pages were not looked at"
    lines = [
        "| page | " + " | ".join(f"{w} px, {mode}" for w, mode in _VIEWS) + " |",
        "|---|" + "---|" * len(_VIEWS),
    ]
    for page in pages:
        seen = [look(page, folder, *view) for view in _VIEWS]
        lines.append(f"| {page.parent.name}/{page.name} | {' | '.join(seen)} |")
    return "\n".join(lines)
