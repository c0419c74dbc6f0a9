"""What was named and may as well be another effect: the log does not tell the two apart."""


def not_told_apart(result: dict) -> list[str]:
    """Clauses beside the names, which alone read as certain: an effect and all that it may be instead."""
    rivals: dict[tuple[str | None, str], list[str]] = {}
    for pair in result["undecided"]:
        named, *others = pair["effects"]
        rivals.setdefault((pair["joint"], named), []).extend(others)
    return [
        f"this log does not tell {named} from {' or '.join(others)}{_on(joint)}"
        for (joint, named), others in rivals.items()
    ]


def to_tell_apart(result: dict) -> list[str]:
    """The motions that would tell them apart, in sentences."""
    return [
        f"To tell {' from '.join(pair['effects'])} apart{_on(pair['joint'])}: {pair['experiment']}."
        for pair in result["undecided"]
    ]


def _on(joint: str | None) -> str:
    return f" on {joint}" if joint else ""
