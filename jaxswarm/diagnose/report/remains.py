"""What is left on a joint without a law, in words: how much, when, at which frequencies, what it follows."""

from collections.abc import Iterable

from jaxswarm.diagnose.decision.rules import NEAR
from jaxswarm.diagnose.report.numbers import percent

# What one sentence can hold: joints that are left with something, and windows of time of each.
_MOST_JOINTS, _MOST_WINDOWS = 3, 2
# Two windows with a gap below this share of both with it are told as one: a reader looks there anyway.
_HARDLY_PARTED = 0.1
# Shares of what is beyond the noise of which hardly any, and most of it, comes back with the motion. Noise that
# lasts for a second has a correlation of 0 +- 0.3 over five periods of four: between them nothing is told.
_HARDLY, _MOSTLY = 0.2, 0.7
# A joint below so many times its noise is told to be left alone.
_DONE = 2.0


def left_of(entries: list[dict]) -> str:
    """What is left on the joints that are farthest from their noise, and on how many more."""
    far = sorted(entries, key=lambda u: -u["over_noise"])[:_MOST_JOINTS]
    told = [remaining(u, _MOST_WINDOWS) for u in entries if any(u is one for one in far)]
    more = len(entries) - len(far)
    return "; ".join(told) + (f"; and less on {more} more joint{'s'[: more > 1]}" if more else "")


def remaining(entry: dict, most: int | None = None) -> str:
    """What is left on a joint, in one clause: when and at which frequencies it is, and what it follows.

    Args:
        entry: Of ``unexplained``.
        most: Windows of time to name, the longest ones; None: all.
    """
    times = f"{entry['over_noise']:.1f} times the noise at {when(entry, most)}"
    if entry["depends_on"]:
        names = " and ".join(entry["depends_on"])
        return (
            f"{percent(entry['share'], 0)} of the remaining error of {entry['joint']} ({times}) "
            f"follows {names}{_or_states(entry)}{_elsewhere(entry)}"
        )
    return f"{entry['joint']} is left with {times}{_again(entry)}"


def _comes_back(entry: dict) -> float | None:
    """Share of what is beyond the noise that comes back with the motion; None where no motion comes back."""
    if not entry.get("again"):
        return None
    beyond = 1.0 - 1.0 / entry["over_noise"] ** 2  # what is as noise should be never does
    return min(max(entry["again"]["correlation"] / beyond, 0.0), 1.0)


def _again(entry: dict) -> str:
    """How much of it comes back with the motion, and when."""
    share = _comes_back(entry)
    if share is None or _HARDLY < share < _MOSTLY:
        return ""
    much = f"{percent(share, 0)} of which" if share >= _MOSTLY else "hardly any of which"
    return f", {much} comes back when the motion repeats, after {entry['again']['period_s']:.3g} s"


def _or_states(entry: dict) -> str:
    """States that the log does not tell from time, with what they say."""
    told = entry.get("or_states")
    if told is None:
        return ""
    names = " and ".join(told["depends_on"])
    return f", or nearly as well {names} ({percent(told['share'], 0)})"


def _elsewhere(entry: dict) -> str:
    """How much of it holds on motion that was not fitted."""
    share = entry.get("share_on_other_motion")
    if share is None:
        return ""
    if share <= 0.0:
        return ", on other motion none of it"
    return f", on other motion {percent(share, 0)}"


def when(entry: dict, most: int | None = None) -> str:
    """At which frequencies, and in which stretches of which log, a joint is far from its noise."""
    low, high = entry["band_hz"]
    several = any(w["log"] for w in entry["windows"])
    windows = _joined(entry["windows"])
    long = sorted(windows, key=lambda w: w["start"] - w["end"])[:most]
    spans = [
        f"{w['start']:.3g}-{w['end']:.3g} s" + (f" of log {w['log'] + 1}" if several else "")
        for w in windows
        if w in long
    ]
    if len(spans) < len(windows):
        spans.append("other times")
    return f"{low:.2g} to {high:.2g} Hz" + (f", mostly at {', '.join(spans)}" if spans else "")


def _joined(windows: list[dict]) -> list[dict]:
    """Windows of a log that are hardly parted, as one."""
    told: list[dict] = []
    for w in sorted(windows, key=lambda w: (w["log"], w["start"])):
        last = told[-1] if told else None
        parted = (
            float("inf") if last is None or last["log"] != w["log"] else w["start"] - last["end"]
        )
        if last is not None and parted <= _HARDLY_PARTED * (w["end"] - last["start"]):
            told[-1] = {**last, "end": w["end"]}
        else:
            told.append(w)
    return told


def look_at(entry: dict) -> list[str]:
    """What to do about structure that no law explains."""
    joint = entry["joint"]
    if not entry["depends_on"]:
        share = _comes_back(entry)
        causes = "a push, cables, the controller, dropped samples"
        if share is not None and share <= _HARDLY:
            causes = "not one of the motion: a push, what drifts, dropped samples, noise that lasts"
        return [
            f"Look at {joint} at {when(entry)}: what happens there happens in no known law ({causes})."
        ]
    names = " and ".join(entry["depends_on"])
    steps = [
        f"Vary {names} alone to see the shape on {joint}; a law registered with "
        "jaxswarm.effects.register becomes a candidate at once."
    ]
    if told := entry.get("or_states"):
        steps.append(
            f"Record another motion and pass both logs: in this one {' and '.join(told['depends_on'])} go "
            f"along with time, and it does not tell which of them {joint} follows."
        )
    if entry.get("in_model"):
        steps.append(
            f"model.json holds a smooth function of {names} for {joint}: it predicts what "
            "no law explains, within the range of this motion."
        )
    return steps


def left_open(result: dict) -> list[str]:
    """What to do about joints that :func:`doubted` has."""
    return [
        f"On {on} {', '.join(f'{joint} ({times:.3g} times the noise)' for joint, times in joints)} is off no "
        "further than the fitted motion leaves the parameters open: fit this log too, or a motion that "
        "excites more (jaxswarm excite)."
        for on, joints in doubted(result)
    ]


def left_in_doubt(result: dict) -> str:
    """What the fitted motion leaves open of other logs, in one sentence; nothing where it tells them."""
    told = _off(doubted(result))
    return f"{told}: no further than the fitted motion leaves open." if told else ""


def left_undecided(result: dict) -> str:
    """What other logs are off by in motion that is neither left open nor far beyond, in one sentence."""
    logs = []
    for entry in result["error"].get("validation") or ():
        rows = zip(
            result["joints"],
            entry["after"]["rms"],
            entry["after"].get("rms_moving") or (),
            result["error"]["noise_floor"]["rms"],
            entry.get("expected") or (),
            strict=False,
        )
        joints = [
            (joint, moving / noise)
            for joint, rms, moving, noise, most in rows
            if moving is not None and max(NEAR * noise, most) < min(rms, moving)
        ]
        if joints:
            logs.append((entry["on"], joints))
    told = _off(logs)
    ending = "in motion, further than the fitted motion leaves open: something may act there"
    return f"{told} {ending} that this log does not show." if told else ""


def _off(logs: Iterable[tuple[str, list[tuple[str, float]]]]) -> str:
    """By how many times the noise joints are off on other logs, the most first, as the begin of a sentence."""
    told = []
    for on, joints in logs:
        first, *others = sorted(joints, key=lambda one: -one[1])[:_MOST_JOINTS]
        parts = [f"{first[0]} is off by {first[1]:.1f} times the noise"]
        parts += [f"{joint} by {times:.1f}" for joint, times in others]
        told.append(f"on {on} {', '.join(parts)}")
    text = "; ".join(told)
    return text[:1].upper() + text[1:]


def doubted(result: dict) -> list[tuple[str, list[tuple[str, float]]]]:
    """Logs, and errors over the noise of joints that are off there by no more than the fit leaves open."""
    told = []
    for entry in result["error"].get("validation") or ():
        rows = zip(
            result["joints"],
            entry["after"]["rms"],
            result["error"]["noise_floor"]["rms"],
            entry.get("expected") or (),
            strict=False,
        )
        joints = [
            (joint, rms / noise) for joint, rms, noise, most in rows if NEAR * noise < rms <= most
        ]
        if joints:
            told.append((entry["on"], joints))
    return told


def left_beyond(result: dict) -> str:
    """What another log is left with, and the fitted motion does not leave open, in one clause."""
    told = []
    for entry in result["error"].get("validation") or ():
        if joints := entry.get("beyond"):
            first, *others = [(one["joint"], f"{one['over_noise']:.1f} times") for one in joints]
            clauses = [f"{first[1]} the noise is left on {first[0]}"]
            clauses += [f"{times} on {joint}" for joint, times in others]
            told.append(f"on {entry['on']} {', '.join(clauses)}")
    return "; ".join(told)


def fit_beyond(result: dict) -> list[str]:
    """What to do about logs that are left with more than the fitted motion leaves open."""
    told = left_beyond(result)
    if not told:
        return []
    return [
        f"{told[0].upper()}{told[1:]}, in motion and more than the fitted motion leaves open: something acts "
        "there that this log does not show. Diagnose both logs together, with another one for --validation."
    ]


def near_noise(result: dict) -> list[str]:
    """Joints whose torque has nothing more to tell, in one sentence."""
    if result["error"]["after"] is None:
        return []
    floor, after = result["error"]["noise_floor"]["rms"], result["error"]["after"]["rms"]
    fitted = result.get("residual_over_noise") or [0.0] * len(after)
    rows = zip(after, floor, fitted, strict=True)
    times = [max(rms / low, over) for rms, low, over in rows]  # of both: a fitted log may hold more
    near = [joint for joint, x in zip(result["joints"], times, strict=True) if x < _DONE]
    if not near:
        return []
    most = max(x for x in times if x < _DONE)
    named = "All joints are" if len(near) == len(times) > 1 else f"{', '.join(near)}:"
    return [f"{named} within {most:.1f} times the torque's noise: stop there."]
