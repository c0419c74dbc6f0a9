"""Joints that are searched for a formula: those that no law explains."""

from typing import NamedTuple

from jaxswarm.diagnose.decision.material import is_material
from jaxswarm.diagnose.decision.remainder import remainders
from jaxswarm.diagnose.decision.rules import LOUD, MATERIAL
from jaxswarm.diagnose.decision.unexplained import find_unexplained
from jaxswarm.diagnose.discovery.stand_ins import shows_on
from jaxswarm.diagnose.selection.diagnosis import Diagnosis


class Open(NamedTuple):
    """A joint to be searched: what its residual depends on, and how much of it a smooth function explains.

    ``named``: laws of the catalog explain it nearly, and may have been bent to do so.
    """

    joint: int
    depends_on: tuple[str, ...]
    share: float
    named: bool = False


def unlawful(diagnosis: Diagnosis, seed: int) -> list[Open]:
    """Joints that no law explains: those whose structure was found, then those only far from the noise.

    What is told as unexplained has to stand out of the noise; a formula has a proof of its own, so that less is
    enough to ask for one. Of three drawn laws that act near standstill or beyond one place a log showed 1.1 to
    1.7 times the noise, and another one 3 to 20 times.
    """
    final = diagnosis.final
    remains = remainders(final)
    over = [r.over_noise for r in remains]
    added = {shows_on(step) for step in diagnosis.kept}
    asked = [j for j, x in enumerate(over) if x > MATERIAL]
    told = []
    for u in find_unexplained(final, diagnosis.crossfit, seed, asked):
        stands_out = is_material(u, over)
        if stands_out or u.joint in added or over[u.joint] > LOUD:
            named = u.joint in added and not stands_out
            told.append(Open(u.joint, u.depends_on, u.share, named))
    told.sort(key=lambda one: (one.named, -one.share))
    known = {one.joint for one in told}
    far = [r for r in remains if not r.near and r.joint not in known]
    return told + [Open(r.joint, (), 0.0) for r in sorted(far, key=lambda r: -r.over_noise)]
