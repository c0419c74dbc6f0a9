"""The page of a diagnosis in a browser: it fits a telephone and a desk, and says nothing on the console."""

import re
import shutil
import subprocess
from html import escape

import pytest
from results import RESULTS, explained, pictures

from jaxswarm.diagnose.report.html import render

CHROMIUM = (
    shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
)
MEASURE = (
    "<script>parent.document.documentElement.dataset.seen="
    "innerWidth+' '+document.documentElement.scrollWidth</script></body>"
)


def page_of(told):
    return render(told, pictures(told))


def browse(page, path, width, *options):
    """Inner width, width of the content and what a browser says on its console.

    The page stands in a frame of this width: a window of a browser is no narrower than 500 pixels.
    """
    inside = escape(page.replace("</body>", MEASURE))
    frame = f'<iframe srcdoc="{inside}" style="width:{width}px;height:900px;border:0"></iframe>'
    outside = f'<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">{frame}'
    (path / "frame.html").write_text(outside, encoding="utf-8")
    run = subprocess.run(
        [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
         f"--user-data-dir={path / 'user'}", f"--window-size={width + 100},1000",
         "--enable-logging=stderr", *options, "--dump-dom", (path / "frame.html").as_uri()],
        capture_output=True, text=True, check=True, timeout=60,
    )  # fmt: skip
    inner, content = re.search(r'data-seen="(\d+) (\d+)"', run.stdout).groups()
    said = [line for line in run.stderr.splitlines() if "CONSOLE" in line]
    return int(inner), int(content), said


needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="no chromium on the PATH")


@needs_browser
@pytest.mark.parametrize("kind", RESULTS)
@pytest.mark.parametrize(("width", "options"), [(390, ()), (1280, ("--force-dark-mode",))])
def test_page_fits_a_telephone_and_a_desk_without_an_error(kind, width, options, tmp_path):
    inner, content, said = browse(page_of(RESULTS[kind]()), tmp_path, width, *options)
    assert inner == width
    assert content <= width
    assert said == []


@needs_browser
def test_the_browser_would_tell(tmp_path):
    """A page that is too wide and one that fails are seen."""
    bad = '<div style="width:900px">x</div><script>nothing.at.all</script></body>'
    _, content, said = browse(page_of(explained()).replace("</body>", bad), tmp_path, 390)
    assert content >= 900 and "nothing is not defined" in said[0]
