"""Standard errors of what a law derives from its parameters: how sure the other usual ways to state it are."""

from collections.abc import Sequence

import numpy as np

from jaxswarm.effects.term import Term

# Step of a difference, as a part of a value.
_STEP = 1e-6


def derived_errors(
    term: Term, names: Sequence[str], covariance: np.ndarray, errors: dict[str, float]
) -> dict[str, float]:
    """Standard errors of the derived values of a term, to first order; NaN where one cannot be told.

    Two parameters may each be told by nothing, and a value of both by the log: of a spring with a dead zone,
    one end of which motion reached, centre and gap were told to 1.3 rad each, and that end to 0.012.

    Args:
        term: With its values.
        names: Parameters (m,) that a fit moved.
        covariance: Of these, (m, m); NaN where one is not told from others.
        errors: Standard errors of the term's parameters; NaN where one is not told.

    >>> spring = Term("dead_zone_spring", 0, values={"k": 1.0, "q0": 0.5, "gap": 0.5})
    >>> both = np.array([[1.0, -0.99], [-0.99, 1.0]])
    >>> found = derived_errors(spring, ["q0", "gap"], both, {"q0": 1.0, "gap": 1.0})
    >>> {name: round(error, 2) for name, error in found.items()}
    {'low': 1.99, 'high': 0.14}
    """
    law = term.law
    if law.derived is None:
        return {}
    slopes = [_slopes(term, name) for name in names]
    told = {}
    for name in law.derived(term.values):
        slope = np.array([own.get(name, np.nan) for own in slopes])
        untold = [p for p, s in zip(names, slope, strict=True) if s != 0.0 and not errors[p] >= 0.0]
        used = slope != 0.0
        square = slope[used] @ covariance[np.ix_(used, used)] @ slope[used]
        told[name] = float(np.nan if untold or not used.any() else np.sqrt(max(square, 0.0)))
    return told


def _slopes(term: Term, name: str) -> dict[str, float]:
    """Derivatives of a term's derived values along one of its parameters, by central differences."""
    assert term.law.derived is not None  # asked for by one that derives
    values = term.values
    step = _STEP * max(abs(values[name]), _STEP)
    ahead, behind = (
        term.law.derived({**values, name: values[name] + way * step}) for way in (1.0, -1.0)
    )
    return {n: (x - behind[n][0]) / (2.0 * step) for n, (x, _) in ahead.items() if n in behind}
