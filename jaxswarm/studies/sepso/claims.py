"""The paper's claim, SEPSO more accurate than SPSO and GA, decided for every reading and setting."""

from jaxswarm.studies.sepso.search import GENETIC, SEPSO, SPSO


def claims(section: dict) -> list[dict]:
    """One row a variant: what it is against every rival, and for which pairs of readings the claim holds.

    Args:
        section: With the rows of :func:`jaxswarm.studies.sepso.search.comparisons`.

    >>> rows = [{"sepso": "SEPSO R1", "rival": rival, "on": "accuracy", "effect": effect,
    ...          "sepso_is": word} for rival, effect, word in (("SPSO", 0.5, "not told apart"),
    ...          ("SPSO (w falls)", 0.9, "better"), ("GA", 0.9, "better"))]
    >>> claims({"comparisons": rows})[0]["holds_against"]
    [['SPSO (w falls)', 'GA']]
    """
    rows = [c for c in section["comparisons"] if c["on"] == "accuracy"]
    found = []
    for variant in (v for v in SEPSO if any(c["sepso"] == v for c in rows)):
        against = {c["rival"]: c for c in rows if c["sepso"] == variant}
        won = [name for name, c in against.items() if c["sepso_is"] == "better"]
        pairs = [[s, g] for s in SPSO for g in GENETIC if s in won and g in won]
        found.append(
            {
                "variant": variant,
                "against": {
                    name: {"is": c["sepso_is"], "effect": c["effect"]}
                    for name, c in against.items()
                },
                "holds_against": pairs,
                "readings": sum(s in against and g in against for s in SPSO for g in GENETIC),
            }
        )
    return found


def sentences(sections: list[dict]) -> list[str]:
    """Where the claim holds, one sentence a variant, and a last one for all of them."""
    texts = []
    variants = dict.fromkeys(c["variant"] for s in sections for c in s["claims"])
    anywhere = False
    for variant in variants:
        own = [(s, c) for s in sections for c in s["claims"] if c["variant"] == variant]
        held = [(s, c) for s, c in own if c["holds_against"]]
        anywhere |= bool(held)
        counts = [
            f"{word} than {rival} in {told.count(word)}"
            for rival in own[0][1]["against"]
            for told in ([c["against"][rival]["is"] for _, c in own],)
            for word in ("better", "worse")
            if word in told
        ]
        where = "; ".join(
            f"{s['plant']}, {s['case']}, {s['budget']} budget ({_readings(c)})" for s, c in held
        )
        texts.append(
            f"{variant} [reconstruction], parameter accuracy over {len(own)} settings: "
            f"{', '.join(counts) or 'no difference'}; the rest not told apart. More accurate than SPSO and "
            f"GA: {where or 'nowhere'}."
        )
    if not anywhere:
        texts.append(
            "The paper's claim, SEPSO more accurate than SPSO and GA, holds in none of these settings."
        )
    return texts


def _readings(claim: dict) -> str:
    if len(claim["holds_against"]) == claim["readings"]:
        return "every reading of SPSO and GA"
    return " and ".join(f"{s} with {g}" for s, g in claim["holds_against"])
