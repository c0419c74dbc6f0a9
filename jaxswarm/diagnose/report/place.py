"""A term in ``diagnosis.json``: what it is, and where."""

from jaxswarm.effects.term import Term


def place(term: Term, joints: tuple[str, ...]) -> dict:
    """Effect and joint (null for a global effect, partner where there is one)."""
    entry = {"effect": term.effect, "joint": None if term.joint is None else joints[term.joint]}
    if term.other is not None:
        entry["other"] = joints[term.other]
    return entry
