"""The page of a diagnosis: everything is on it, in words too, and nothing is fetched from elsewhere."""

import base64
import json
import re
from html.parser import HTMLParser
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest
from results import JOINTS, RESULTS, changed, errors, explained, pictures, signals, unexplained

from jaxswarm.diagnose.report import figures
from jaxswarm.diagnose.report.grids import by_step, parameters
from jaxswarm.diagnose.report.html import render
from jaxswarm.diagnose.report.markup import source
from jaxswarm.diagnose.report.remains import when
from jaxswarm.diagnose.report.stages import stages
from jaxswarm.diagnose.report.text import evidence_sentence, proof_sentence, taken_out


class Words(HTMLParser):
    """The text of a page, its alternative texts, and the elements that are open at its end."""

    def __init__(self, page):
        super().__init__()
        self.told, self.alt, self.links, self.open = [], [], [], []
        self.feed(page)
        self.text = " ".join(self.told)

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        if tag not in ("meta", "img", "link"):
            self.open.append(tag)
        if tag == "img":
            self.alt.append(attrs["alt"])
        self.links += [attrs[k] for k in ("src", "href") if k in attrs]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.told.append(data)


def page_of(told):
    return render(told, pictures(told), signals(told) if told["error"]["before"] else None)


@pytest.mark.parametrize("kind", RESULTS)
def test_verdict_evidence_and_proof_come_first(kind):
    told = RESULTS[kind]()
    words = Words(page_of(told))
    assert words.open == []
    places = [
        words.text.index(part)
        for part in (
            told["verdict"].capitalize(),
            evidence_sentence(told),
            proof_sentence(told),
            "Found in the logs",
            "Where this comes from",
        )
    ]
    assert places == sorted(places)
    # What was declared is told at the end, not before the verdict.
    assert words.text.rindex("Declared:") > places[-1]
    assert all(words.text.count(reason) == 1 for reason in told["reasons"])


def test_a_published_law_leads_to_its_source_and_an_own_one_nowhere():
    assert source("") == "" and "<a" not in source("own measurement of 3 arms")
    found = source('Dahl 1968 "A solid friction model" & more')
    (link,) = Words(found).links
    assert parse_qs(urlsplit(link).query)["q"] == ['Dahl 1968 "A solid friction model" & more']
    assert "&quot;A solid" in found


def test_the_model_and_the_command_are_on_the_page():
    told = explained()
    told["provenance"]["options"]["command"] = "jaxswarm diagnose arm.csv --robot 'a b.urdf'"
    words = Words(render(told, pictures(told), None, '{"format": 1}\n'))
    saved = [link for link in words.links if link.startswith("data:application/json")]
    assert len(saved) == 2
    assert base64.b64decode(saved[1].partition(",")[2]) == b'{"format": 1}\n'
    assert "jaxswarm diagnose arm.csv --robot 'a b.urdf'" in words.told


@pytest.mark.parametrize("kind", RESULTS)
def test_page_is_whole_without_anything_from_elsewhere(kind):
    told = RESULTS[kind]()
    page = page_of(told)
    words = Words(page)
    # What a reader may follow fetches nothing: a search for the publication of a law.
    followed = [link for link in words.links if link.startswith("https://search.crossref.org/")]
    assert all(link.startswith("data:") for link in words.links if link not in followed)
    bare = re.sub(r'="data:[^"]*"|<a href="https://search[^"]*"', "", page)
    assert not re.search(r"https?:|url\(|@import|<script[^>]*src|fetch\(|XMLHttp", bare)
    assert 'name="viewport" content="width=device-width' in bare
    saved = next(link for link in words.links if link.startswith("data:application/json"))
    again = json.loads(base64.b64decode(saved.partition("base64,")[2]))
    assert again["verdict"] == told["verdict"] and again["joints"] == told["joints"]


def test_every_picture_is_told_in_words():
    words = Words(page_of(explained()))
    assert len(words.alt) == 4  # the torque is drawn as lines, which have titles
    assert all(len(alt.split()) > 8 and ".png" not in alt for alt in words.alt)
    assert "stribeck_friction on panda_finger_joint2" in words.alt[0]


def test_structure_without_a_law_is_drawn_for_its_joint():
    told = unexplained()
    told["unexplained"][0] |= {"depends_on": ["q_a", "dq_b"], "in_model": True}
    words = Words(render(told, {f"unexplained_{JOINTS[3]}.png": b"x"}))
    assert words.alt[0].startswith(f"{JOINTS[3]} against q_a and dq_b: ")
    assert "90 % of the remaining error" in words.text and "a smooth function of q_a" in words.text


def test_an_effect_has_formula_meaning_intervals_and_rivals():
    told = explained()
    text = Words(page_of(told)).text
    effect = told["effects"][0]
    assert effect["law"] in text and effect["meaning"] in text and effect["reference"] in text
    assert "3.191 to 3.297" in text
    assert "quadratic_drag on panda_finger_joint2 1.42" in text and "142 %" not in text


def test_a_change_stands_beside_what_was():
    text = Words(page_of(changed())).text
    assert "1. stribeck_friction on panda_finger_joint2 changed" in text
    assert "df 3.200 3.161 to 3.239 2.1 1.100 1.041 to 1.159 N m" in text
    assert "vs 0.100 0.080 to 0.120 - - - rad/s" in text
    assert "Against the earlier model earlier.json." in text


def test_values_that_need_a_look_stand_in_one_list():
    text = Words(page_of(explained())).text
    part = text[text.index("Values to be looked at") : text.index("1. stribeck_friction")]
    for said in (
        "vs of stribeck_friction on panda_finger_joint2 is at its lower bound",
        "delta of stribeck_friction on panda_finger_joint2 is assumed",
        "fc_1 of coulomb_friction is held at its bound",
        "weakly determined by this motion: mx1",
    ):
        assert said in part


def test_all_that_was_decided_is_on_the_page():
    text = Words(page_of(explained())).text
    assert "backlash on panda_finger_joint4 raises the error of joint4" in text
    assert "a gap of 2 s at row 118" in text and "a" * 64 in text
    assert "zz1 1.50 1.30 to 1.70 kg m^2 determined zz1 + 0.1 m2" in text
    assert "first.csv panda_finger_joint2" in text and "second.csv panda_finger_joint3" in text
    assert "grew" in text and "No longer in the model torque_offset" in text
    assert "the worst of them, second.csv, leads" in text


def test_what_left_the_model_says_whether_it_was_declared_and_what_holds_it_now():
    told = explained()
    gone = [{"effect": "coulomb_friction", "joint": JOINTS[1]}]
    told["steps"][0]["removed"] = gone
    told["removed"] = [*gone, *told["removed"]]
    assert taken_out(told) == [
        "coulomb_friction on panda_finger_joint2 (declared; now part of stribeck_friction on "
        "panda_finger_joint2)",
        "torque_offset on panda_finger_joint5 (added; without it nothing is worse)",
    ]


def test_the_last_model_of_the_steps_has_the_error_under_the_verdict():
    told = explained()
    told["error"]["after"] = {**told["error"]["after"], "relative_global": 0.0087}
    assert "(error 12.00 % before, 0.87 % after" in evidence_sentence(told)
    assert by_step(told).rows[-1] == ("final model, all fitted again", "", "0.87 %")
    assert [name for name, *_ in by_step(explained()).rows] == [
        "declared model",
        "+ stribeck_friction on panda_finger_joint2",
    ]


def test_a_value_at_its_bound_has_no_interval_around_it():
    rows = {row[0]: row[2] for row in parameters(explained()["effects"][0]).rows}
    assert rows["vs"] == "at lower bound" and rows["df"] == "3.191 to 3.297"


def test_windows_that_are_hardly_parted_are_one():
    entry = {"band_hz": [0.16, 50.0], "windows": [
        {"log": 0, "start": 0.077, "end": 1.58}, {"log": 0, "start": 2.08, "end": 24.8},
    ]}  # fmt: skip
    assert when(entry) == "0.16 to 50 Hz, mostly at 0.077-24.8 s"


def test_a_joint_far_from_its_noise_is_marked_and_told_with_times_and_frequencies():
    page = page_of(unexplained())
    marked = re.findall(r"<tr class=far>(.*?)</tr>", page)
    assert JOINTS[3] in marked[0] and not any(JOINTS[2] in row for row in marked)
    text = Words(page).text
    assert (
        "3.3 times the noise at 0.5 to 4 Hz, mostly at 2.5-3.5 s of log 1, 11-12 s of log 2" in text
    )


def test_what_was_declared_is_told_once_an_effect():
    told = explained()
    assert "Declared: coulomb_friction on every joint." in Words(page_of(told)).text
    told["declared"] = [
        {"effect": "transmission_coupling", "joint": "a", "other": "b"},
        {"effect": "time_delay", "joint": None},
    ]
    said = "Declared: transmission_coupling on a (driven by b); time_delay."
    assert said in Words(page_of(told)).text
    assert "rigid body only" in Words(page_of(told | {"declared": []})).text


def test_what_came_together_is_one_step():
    told = explained()
    step = told["steps"][0]
    for joint in JOINTS:
        told["steps"].append(step | {"added": {"effect": "viscous_friction", "joint": joint}})
    own = {"effect": "time_delay", "joint": None}
    told["steps"].append({"added": own, "before": step["after"], "after": errors(0.9)})
    told["error"]["after"] = errors(0.9)
    names = [stage.name for stage in stages(told)]
    both = f"+ stribeck_friction on {JOINTS[1]}, viscous_friction on every joint"
    assert names == ["declared model", both, "+ time_delay"]
    text = Words(page_of(told)).text
    assert f"0: declared model; 1: {both}; 2: + time_delay." in text


def test_nothing_is_minus_zero_percent():
    told = explained()
    told["error"]["after"]["relative"][0] = -1e-9
    told["effects"][0]["gain"]["share_of_error"] = -1e-9
    assert not re.search(r"-0(\.0+)? %", Words(page_of(told)).text)


def test_names_are_text():
    told = json.loads(json.dumps(explained()).replace("panda_finger_joint2", "<b onload=1>&"))
    page = page_of(told)
    assert "<b onload" not in page and "&lt;b onload=1&gt;&amp;" in page


def test_the_ladder_of_seven_joints_can_be_read():
    """At its size on the page: no text under 8 points, none over another or out of the picture."""
    told = explained()
    figure = figures.ladder(told)
    figure.draw_without_rendering()
    width = figure.get_size_inches()[0] * figure.dpi
    shrink = (
        min(1.0, 1120 / width) * figure.dpi / 96
    )  # the widest picture the page shows, in its pixels
    shown = [axis for axis in figure.axes if axis.axison]
    assert len(shown) == 7
    boxes = []
    for axis in shown:
        for item in [*axis.texts, axis.title, *axis.get_xticklabels(), *axis.get_yticklabels()]:
            if item.get_text():
                assert item.get_fontsize() * shrink >= 8.0
        boxes += [item.get_window_extent() for item in [*axis.texts, axis.title]]
    boxes += [item.get_window_extent() for item in figure.texts]
    for k, one in enumerate(boxes):
        assert one.x0 >= 0 and one.x1 <= width and one.y0 >= 0
        assert not any(one.overlaps(other) for other in boxes[k + 1 :])
    assert np.isclose(sum(axis.get_xlim()[0] for axis in shown), 0.0)


def test_signals_read_without_scripts_and_lose_no_peak():
    told = explained()
    page = re.sub(r"<script.*?</script>", "", render(told, {}, signals(told, 200_000)), flags=re.S)
    words = Words(page)
    for joint in JOINTS:
        assert f"{joint}: torque from" in words.text
    lines = re.findall(r'class="rest" d="([^"]*)"', page)
    assert len(lines) == len(JOINTS) and all(len(line.split()) <= 1600 for line in lines)
    heights = [float(point.split(",")[1]) for point in lines[1].split()]
    # One sample in 200 000 stands out by 2.5: it reaches the top of the panel of the difference.
    assert min(heights) == pytest.approx(162.0) and np.median(heights) == pytest.approx(
        192.0, abs=3
    )
    assert (
        len(re.search(r'class="data">(.*?)</script>', render(told, {}, signals(told, 200_000)))[1])
        < 3e6
    )


def test_lines_of_signals_end_where_nothing_was_measured():
    told, drawn = explained(), signals(explained())
    drawn.measured[700:900] = np.nan
    page = render(told, {}, drawn)
    assert "Where nothing was measured, lines end." in page
    pieces = {
        name: [line.count("M") for line in re.findall(rf'class="{name}" d="([^"]*)"', page)]
        for name in ("measured", "model", "rest")
    }
    assert pieces == {"measured": [2] * 7, "model": [1] * 7, "rest": [2] * 7}
    assert "NaN" not in page.partition('class="data">')[2].partition("</script>")[0]
    assert "Where nothing was measured" not in render(told, {}, signals(told))


def test_names_do_not_break_the_signals():
    told = explained()
    names = ["</script>", "<b>", "&amp;", "$x$", 'a"b', "é", "j7"]
    told["joints"] = names
    page = render(told, {}, signals(told))
    assert page.count("</script>") == 2 and "&lt;/script&gt;" in page


def test_standard_parameters_are_told_beside_the_base_form():
    words = Words(page_of(explained()))
    assert "Standard parameters of the links" in words.text and "one choice of many" in words.text
    assert "no body has these" in words.text
