"""Joints that are searched for a formula: those that no law explains."""

from typing import NamedTuple

from jaxswarm.diagnose.decision.remainder import find_material, remainders
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
    """Joints that no law explains: those whose structure was found, then those only far from the noise."""
    final = diagnosis.final
    remains = remainders(final)
    found = find_material(final, diagnosis.crossfit, seed)
    told = [Open(u.joint, u.depends_on, u.share) for u in sorted(found, key=lambda u: -u.share)]
    known = {one.joint for one in told}
    far = [r for r in remains if not r.near and r.joint not in known]
    return told + [Open(r.joint, (), 0.0) for r in sorted(far, key=lambda r: -r.over_noise)]
