"""What was named and may as well be another effect: the log does not tell the two apart."""


def not_told_apart(result: dict) -> list[str]:
    """Clauses beside the names, which alone read as certain: an effect and all that it may be instead."""
    rivals: dict[tuple[str, str], list[str]] = {}
    for pair in result["undecided"]:
        named, other, place = _names(pair)
        rivals.setdefault((named, place), []).append(other)
    return [
        f"this log does not tell {named} from {' or '.join(others)}{place}"
        for (named, place), others in rivals.items()
    ]


def either_of(result: dict) -> list[str]:
    """Pairs of which neither was named, as they stand in a sentence: ``a ripple or a spring on joint3``."""
    named = (_names(pair) for pair in result["undecided"])
    return [f"{one} or {other}{place}" for one, other, place in named]


def to_tell_apart(result: dict) -> list[str]:
    """The motions that would tell them apart, in sentences."""
    told = []
    for pair in result["undecided"]:
        named, other, place = _names(pair)
        told.append(f"To tell {named} from {other} apart{place}: {pair['experiment']}.")
    return told


def _names(pair: dict) -> tuple[str, str, str]:
    """Both effects and the joint that they have in common: each with its own where they have none.

    An encoder's zero was said not to be told from a cable on its joint, where the cable was on the next one.
    """
    (named, other), rival = pair["effects"], pair["rival"]
    # Two laws of one kind are told by names that have their joints.
    if other != rival["effect"] or rival["joint"] == pair["joint"]:
        return named, other, _on(pair["joint"])
    driven = f" (driven by {rival['other']})" if rival.get("other") else ""
    return named + _on(pair["joint"]), other + _on(rival["joint"]) + driven, ""


def _on(joint: str | None) -> str:
    return f" on {joint}" if joint else ""
