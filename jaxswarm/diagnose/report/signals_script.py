"""The program of the page: zoom and values of the signals, own and small, nothing fetched from elsewhere."""

SCRIPT = """
(function () {
  "use strict";
  var section = document.currentScript.parentNode;
  var told = JSON.parse(section.querySelector("script.data").textContent);
  var WIDTH = 1000, TOP = 150, LOW = 60, MIDDLE = 192, COLUMNS = 800, LEAST = 8;
  var full = told.span, shown = full.slice();
  var panels = [].map.call(section.querySelectorAll("figure.signal"), function (figure) {
    var series = told.joints[+figure.dataset.joint];
    return {
      figure: figure, svg: figure.querySelector("svg"), out: figure.querySelector("output"),
      at: figure.querySelector(".at"), chosen: figure.querySelector(".chosen"),
      lines: ["measured", "model", "rest"].map(function (k) { return figure.querySelector("path." + k); }),
      t: series[0], a: series[1].map(function (v) { return v === null ? NaN : v; }), b: series[2]
    };
  });
  section.querySelector(".zooming").hidden = false;
  section.classList.add("live");

  function first(t, time) {
    var low = 0, high = t.length;
    while (low < high) {
      var middle = (low + high) >> 1;
      if (t[middle] < time) { low = middle + 1; } else { high = middle; }
    }
    return low;
  }
  function x(time) { return (time - shown[0]) / (shown[1] - shown[0]) * WIDTH; }
  // What is not a number is neither: in a gap of the log nothing was measured.
  function below(one, other) { return one < other || (one === one && other !== other); }
  // Of every column of the picture the two samples that are its extremes, in the order of time.
  function picked(panel, value) {
    var from = Math.max(0, first(panel.t, shown[0]) - 1);
    var to = Math.min(panel.t.length, first(panel.t, shown[1]) + 2);
    var step = Math.max(1, Math.floor((to - from) / COLUMNS)), found = [];
    for (var k = from; k < to; k += step) {
      var low = k, high = k;
      for (var i = k + 1; i < Math.min(k + step, to); i += 1) {
        if (below(value(i), value(low))) { low = i; }
        if (below(-value(i), -value(high))) { high = i; }
      }
      found.push(Math.min(low, high));
      if (low !== high) { found.push(Math.max(low, high)); }
    }
    return found;
  }
  function draw(panel) {
    var values = [
      function (i) { return panel.a[i]; },
      function (i) { return panel.b[i]; },
      function (i) { return panel.a[i] - panel.b[i]; }
    ];
    var rows = values.map(function (value) { return picked(panel, value); });
    var low = Infinity, high = -Infinity, most = 0;
    [0, 1].forEach(function (k) {
      rows[k].forEach(function (i) {
        if (below(values[k](i), low)) { low = values[k](i); }
        if (below(-values[k](i), -high)) { high = values[k](i); }
      });
    });
    rows[2].forEach(function (i) { most = Math.max(most, Math.abs(values[2](i)) || 0); });
    var span = (high - low) || 1;
    most = most || 1;
    panel.lines.forEach(function (line, k) {
      var pen = "M";
      line.setAttribute("d", rows[k].map(function (i) {
        var y = k < 2 ? (high - values[k](i)) / span * TOP : MIDDLE - values[k](i) / most * LOW / 2;
        if (y !== y) { pen = "M"; return ""; }
        var point = pen + x(panel.t[i]).toFixed(1) + "," + y.toFixed(1);
        pen = "L";
        return point;
      }).join(" "));
    });
  }
  function show(low, high) {
    var least = (full[1] - full[0]) / 1e5;
    var span = Math.min(full[1] - full[0], Math.max(high - low, least));
    low = Math.min(Math.max(low, full[0]), full[1] - span);
    shown = [low, low + span];
    panels.forEach(draw);
    section.querySelector(".window").textContent =
      shown[0].toPrecision(5) + " s to " + shown[1].toPrecision(5) + " s";
  }
  function zoom(factor, middle) {
    var centre = middle === undefined ? (shown[0] + shown[1]) / 2 : middle;
    show(centre - (centre - shown[0]) * factor, centre + (shown[1] - centre) * factor);
  }
  function move(share) {
    var by = share * (shown[1] - shown[0]);
    show(shown[0] + by, shown[1] + by);
  }
  function go(where) {
    if (where === "in") { zoom(0.5); } else if (where === "out") { zoom(2); } else { show(full[0], full[1]); }
  }
  function place(panel, event) {
    var box = panel.svg.getBoundingClientRect();
    return Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)) * WIDTH;
  }
  function hover(at) {
    var time = shown[0] + at / WIDTH * (shown[1] - shown[0]);
    panels.forEach(function (panel) {
      var i = Math.min(panel.t.length - 1, first(panel.t, time));
      if (i > 0 && time - panel.t[i - 1] < panel.t[i] - time) { i -= 1; }
      panel.at.setAttribute("x1", x(panel.t[i]));
      panel.at.setAttribute("x2", x(panel.t[i]));
      panel.at.setAttribute("visibility", "visible");
      var unit = " " + panel.out.dataset.unit, model = ", model " + panel.b[i].toPrecision(4);
      panel.out.textContent = "at " + panel.t[i].toPrecision(5) + " s: " + (panel.a[i] === panel.a[i]
        ? "measured " + panel.a[i].toPrecision(4) + model + ", difference "
          + (panel.a[i] - panel.b[i]).toPrecision(3)
        : "nothing measured" + model) + unit;
    });
  }
  function leave() {
    panels.forEach(function (panel) {
      panel.at.setAttribute("visibility", "hidden");
      panel.out.textContent = "";
    });
  }
  panels.forEach(function (panel) {
    var start = null;
    function end() { start = null; panel.chosen.setAttribute("visibility", "hidden"); }
    panel.svg.addEventListener("pointerdown", function (event) {
      start = place(panel, event);
      try { panel.svg.setPointerCapture(event.pointerId); } catch (ignored) { start = start; }
    });
    panel.svg.addEventListener("pointermove", function (event) {
      var at = place(panel, event);
      hover(at);
      if (start === null) { return; }
      panel.chosen.setAttribute("x", Math.min(start, at));
      panel.chosen.setAttribute("width", Math.abs(at - start));
      panel.chosen.setAttribute("visibility", "visible");
    });
    panel.svg.addEventListener("pointerup", function (event) {
      var at = place(panel, event), low = Math.min(start, at), high = Math.max(start, at);
      if (start !== null && high - low >= LEAST) {
        var width = shown[1] - shown[0], begin = shown[0];
        show(begin + low / WIDTH * width, begin + high / WIDTH * width);
      }
      end();
    });
    panel.svg.addEventListener("pointercancel", end);
    panel.svg.addEventListener("pointerleave", leave);
    panel.svg.addEventListener("dblclick", function () { go("all"); });
    panel.figure.addEventListener("keydown", function (event) {
      var known = { ArrowLeft: -0.25, ArrowRight: 0.25 };
      if (event.key in known) { move(known[event.key]); }
      else if (event.key === "+") { go("in"); }
      else if (event.key === "-") { go("out"); }
      else if (event.key === "0") { go("all"); }
      else { return; }
      event.preventDefault();
    });
  });
  [].forEach.call(section.querySelectorAll("button"), function (button) {
    button.addEventListener("click", function () { go(button.dataset.go); });
  });
})();
"""
