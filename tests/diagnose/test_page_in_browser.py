"""The page of a diagnosis in a browser: it fits a telephone and a desk, and says nothing on the console."""

import json
import re
import shutil
import subprocess
from html import escape, unescape

import numpy as np
import pytest
from results import RESULTS, explained, pictures, signals

from jaxswarm.diagnose.report.html import render
from jaxswarm.studies.page import page, table

CHROMIUM = (
    shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
)
# Width of the window, of the page, and the widest table beyond the box it stands in.
MEASURE = """<script>
document.querySelectorAll("details").forEach(function (one) { one.open = true; });
var over = Array.from(document.querySelectorAll("table"), function (one) {
  return one.scrollWidth - one.parentElement.clientWidth; });
parent.document.documentElement.dataset.seen =
  innerWidth + " " + document.documentElement.scrollWidth + " " + Math.max(0, ...over);
</script></body>"""


# Drags over the second quarter of the second panel, looks at a value there, presses keys, shows all again.
DRAG = """<script>
(function () {
  var panel = document.querySelectorAll(".signal")[1], svg = panel.querySelector("svg");
  var line = panel.querySelector("path.rest"), box = svg.getBoundingClientRect();
  var shown = document.querySelector(".window"), told = [];
  function point(kind, share) {
    svg.dispatchEvent(new PointerEvent(kind, {bubbles: true, pointerId: 1,
      clientX: box.left + share * box.width, clientY: box.top + 9}));
  }
  function key(name) { panel.dispatchEvent(new KeyboardEvent("keydown", {key: name, bubbles: true})); }
  var before = line.getAttribute("d");
  point("pointerdown", 0.25); point("pointermove", 0.4); point("pointerup", 0.5);
  told.push(shown.textContent, line.getAttribute("d") !== before);
  point("pointermove", 1 / 3);
  told.push(panel.querySelector("output").textContent);
  key("ArrowRight"); told.push(shown.textContent);
  key("0"); told.push(shown.textContent);
  parent.document.documentElement.dataset.told = JSON.stringify(told);
})();
</script>"""


def page_of(told):
    return render(told, pictures(told), signals(told) if told["error"]["before"] else None)


def browse(page, path, width, *options):
    """Inner width, width of the content, what a table scrolls by, and what a browser says on its console.

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
    inner, content, over = re.search(r'data-seen="(\d+) (\d+) (\d+)"', run.stdout).groups()
    said = [line for line in run.stderr.splitlines() if "CONSOLE" in line]
    if told := re.search(r'data-told="([^"]*)"', run.stdout):
        said.append(json.loads(unescape(told[1])))
    return int(inner), int(content), int(over), said


needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="no chromium on the PATH")


@needs_browser
@pytest.mark.parametrize("kind", RESULTS)
@pytest.mark.parametrize(("width", "options"), [(390, ()), (1280, ("--force-dark-mode",))])
def test_page_fits_a_telephone_and_a_desk_without_an_error(kind, width, options, tmp_path):
    inner, content, over, said = browse(page_of(RESULTS[kind]()), tmp_path, width, *options)
    assert inner == width and over == 0
    assert content <= width
    assert said == []


@needs_browser
def test_signals_are_zoomed_into_and_read(tmp_path):
    page = page_of(explained()).replace("</body>", DRAG + "</body>")
    *said, told = browse(page, tmp_path, 1280)[3]
    assert said == []
    zoomed, redrawn, value, moved, whole = told
    assert zoomed == "10.000 s to 20.000 s" and redrawn
    # The sample that stands out by 2.5 lies at a third of 10 s to 20 s.
    assert value.startswith("at 13.3") and "difference 2.5" in value and value.endswith("N m")
    assert moved == "12.500 s to 22.500 s" and whole == "0.0000 s to 40.000 s"


@needs_browser
def test_signals_say_where_nothing_was_measured(tmp_path):
    drawn = signals(explained())
    drawn.measured[600:720] = np.nan
    page = render(explained(), pictures(explained()), drawn).replace("</body>", DRAG + "</body>")
    *said, told = browse(page, tmp_path, 1280)[3]
    assert said == []
    assert told[2].startswith("at 13.3") and "nothing measured, model" in told[2]
    lines = r"""<script>
    parent.document.documentElement.dataset.told = JSON.stringify(["measured", "model", "rest"].map(
      function (kind) {
        return document.querySelector("path." + kind).getAttribute("d").split("M").length - 1;
      }));
    </script></body>"""
    assert browse(page.replace("</body>", lines), tmp_path, 1280)[3][-1] == [2, 1, 2]


@needs_browser
def test_a_table_of_many_columns_is_a_list_on_a_telephone(tmp_path):
    """What a study prints: fifteen numbers a row, with a name in front."""
    head = ["row", *(f"parameter {k}" for k in range(14))]
    whole = page(
        "A study", [table(head, [["GPSO noisy: mean of ten runs", *np.linspace(-1, 1, 14)]] * 3)]
    )
    assert browse(whole, tmp_path, 390)[1:] == (390, 0, [])


@needs_browser
def test_the_browser_would_tell(tmp_path):
    """A page that is too wide and one that fails are seen."""
    bad = '<div style="width:900px">x</div><script>nothing.at.all</script>'
    bad += f"<div><table><tr><td>{'x' * 90}</table></div></body>"
    whole = page_of(explained()).replace("overflow-wrap:anywhere", "")
    _, content, over, said = browse(whole.replace("</body>", bad), tmp_path, 390)
    assert content >= 900 and over > 100 and "nothing is not defined" in said[0]
