"""True parameters of a world's effects in the catalog's names, and whether intervals hold them."""

import numpy as np

from benchmarks.worlds.effect import Effect
from benchmarks.worlds.world import World


def true_values(effect: Effect, world: World) -> dict[str, float]:
    """An effect's parameters as the catalog names them."""
    p = effect.params
    if effect.kind == "asymmetric_friction":
        fc, b = world.arm.coulomb[effect.joint], world.arm.viscous[effect.joint]
        return {"fc_pos": fc + p["fc_more"], "fc_neg": fc, "b_pos": b + p["b_more"], "b_neg": b}
    if effect.kind == "coulomb_friction":  # with what a law that takes of it needs there
        return {"fc": p["fc"] + world.arm.coulomb[effect.joint]}
    if effect.kind == "contact":
        return {"start": p["start"], "end": p["end"]}
    if effect.kind == "time_delay":  # with what the filter adds and the hold of a tick takes off
        return {"seconds": p["seconds"] + world.logging.lag - 0.5 / world.control.rate}
    return {k: v for k, v in p.items() if isinstance(v, (int, float))}


def interval_hits(entry: dict, true: dict) -> list[dict]:
    """Each parameter of an entry of ``diagnosis.json`` that has a 95 % interval and a true value."""
    rows = []
    for name, found in entry["parameters"].items():
        low, high = found.get("interval_95") or (None, None)
        if name in true and low is not None and np.isfinite(low) and high > low:
            hit = bool(low <= true[name] <= high)
            span = {"true": float(true[name]), "low": low, "high": high}
            rows.append({"parameter": name, **span, "hit": hit})
    return rows
