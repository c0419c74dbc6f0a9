"""Why a candidate was not added, in sentences."""

from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.worth import Score, passes
from jaxswarm.diagnose.report.numbers import percent

# Why one that passed was not added: the refit, or the time that was given.
_UNCONFIRMED = "the refit did not confirm it"
_OUT_OF_TIME = "the budget ended the search before it was added"
_CHANCE = "may be chance, given how many candidates were asked"
# A candidate that takes off less of a joint's error than this is not worth another record.
_MOST_OF_IT = 0.5


def refusal(item: Score, rules: Rules, asked: int, spent: bool = False) -> dict:
    """What a candidate that was not added would have taken off, and each rule that it failed.

    Args:
        item: Its score.
        rules: The thresholds.
        asked: Number of candidates scored beside it.
        spent: Whether a budget ended the search.
    """
    reasons = []
    if item.gain <= 0:
        reasons.append("does not lower the error on unseen time")
    elif item.share < rules.share:
        reasons.append(
            f"takes off {percent(item.share, 1)} of the error, less than {percent(rules.share, 0)}"
        )
    if item.gain > 0 and (
        item.over_noise < rules.over_noise or item.over_torque < rules.over_torque
    ):
        reasons.append("too small to matter beside noise and torque")
    if item.p_value * asked >= rules.significance:
        reasons.append(_CHANCE)
    if not item.allowed:
        reasons.append("sign or size against physics")
    if item.repeats < rules.repeat:
        reasons.append(f"helps in only {percent(item.repeats, 0)} of the blocks")
    if not reasons and not passes(item, asked, rules):
        reasons.append("no single event that explains more than everything that lasts")
    return {
        "share_of_error": item.share,
        "p_value": item.p_value,
        "rejected_because": reasons or [_OUT_OF_TIME if spent else _UNCONFIRMED],
    }


def worth_a_longer_log(refused: list[dict], joint: str | None) -> list[str]:
    """What takes off most of a joint's error, passes all rules and would be added if more data said the same.

    Args:
        refused: Of ``not_added``.
        joint: Name of a joint that is left with structure; None asks for what acts on the whole arm.
    """
    return [
        f"{item['effect']} would take off {percent(item['share_of_error'], 0)} of the error"
        f" of {joint or 'the joint where it shows most'}, but in "
        f"a log as short as this one that may be chance (p = {item['p_value']:.2g}): record a longer log, or "
        "another motion beside it."
        for item in refused
        if item["joint"] == joint
        and item["share_of_error"] >= _MOST_OF_IT
        and item["rejected_because"] == [_CHANCE]
    ][:1]
