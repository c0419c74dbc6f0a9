"""Values that deserve a second look: at a bound, against physics, not told from zero, or assumed."""

import math

from jaxswarm.diagnose.report.numbers import estimate, interval, unit_text
from jaxswarm.diagnose.report.text import where
from jaxswarm.effects import REGISTRY
from jaxswarm.effects.parameter import Parameter

# Share of a searched range that counts as its end: searches stop exactly there.
_END = 1e-6


def flagged(result: dict) -> list[str]:
    """Sentences on values of a diagnosis that are at a bound, implausible or not known, all in one list."""
    told = []
    for effect in [*result["effects"], *result["changed"]]:
        law = REGISTRY.get(effect["effect"])
        known = {p.name: p for p in law.parameters} if law else {}
        for name, row in effect["parameters"].items():
            remark = parameter_remark(row, known.get(name))
            if remark:
                told.append(f"{name} of {where(effect)} {remark}")
    return told + _base_flags(result)


def parameter_remark(row: dict, known: Parameter | None) -> str:
    """What is wrong with a parameter of an effect; empty: nothing.

    Args:
        row: Value, error and unit.
        known: What the law knows of it; None: a derived number.
    """
    value = row["value"]
    if value is None or not math.isfinite(value):
        return "has no value"
    if known is not None:
        remark = _against_bounds(value, known, unit_text(row["unit"]))
        if remark:
            return remark
    pair = interval(row)
    if known is not None and known.linear and pair is not None and pair[0] < 0.0 < pair[1]:
        return f"is not told from zero (95 %: {estimate(row)[1]}{unit_text(row['unit'])})"
    # A missing error is an error nobody computes; one that is no number says that the log is silent.
    error = row.get("std_error", 0.0)
    if error is not None and not math.isfinite(error):
        return "is assumed: the log does not tell it"
    return ""


def _slack(value: float) -> float:
    """What rounding makes of a value."""
    return 1e-9 * max(abs(value), 1e-9)


def bound_reached(value: float, known: Parameter) -> str:
    """Which end of its range a fitted value sits at, ``"lower"`` or ``"upper"``; empty: neither.

    No interval about such a value means anything: the data would go beyond.
    """
    if not known.fitted:
        return ""
    slack = _slack(value)
    place = 0.5 if known.linear else known.encode(value)
    if place < _END or value - known.lower <= slack:
        return "lower"
    if place > 1.0 - _END or known.upper - value <= slack:
        return "upper"
    return ""


def _against_bounds(value: float, known: Parameter, unit: str) -> str:
    span = (known.lower, known.upper)
    if not known.fitted:
        return ""
    slack = _slack(value)
    if value < known.lower - slack or value > known.upper + slack:
        return f"= {value:.4g} is outside of what physics allows ({span[0]:.4g} to {span[1]:.4g}{unit})"
    side = bound_reached(value, known)
    return f"is at its {side} bound, {span[side == 'upper']:.4g}{unit}" if side else ""


def _base_flags(result: dict) -> list[str]:
    """Parameters of the rigid body and of declared effects that physics holds, or that are weakly known."""
    rows = result.get("base_parameters", ())
    told = [
        f"{row['name']} of {row['effect']} is held at its bound: the data would go beyond"
        for row in rows
        if row["verdict"] == "at bound"
    ]
    told += [
        f"{row['name']} of {row['effect']} = {row['value']:.4g}{unit_text(row['unit'])}: no body has "
        "that, nor has its interval; look for what the model lacks"
        for row in rows
        if row["verdict"] == "impossible"
    ]
    weak = [row["name"] for row in rows if row["verdict"] == "weak"]
    if weak:
        told.append(f"weakly determined by this motion: {', '.join(weak)}")
    return told
