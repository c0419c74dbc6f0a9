"""How certain the linear parameters of a model are, by the names of their columns."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from jaxswarm.errors import InputError


class Uncertainty(NamedTuple):
    """Covariance of those columns' parameters that the data determined; the others were held at zero.

    Attributes:
        columns: Names of the columns, b of them.
        covariance: Shape (b, b), in the products of their units.
    """

    columns: tuple[str, ...]
    covariance: np.ndarray

    def on(self, names: Sequence[str]) -> np.ndarray:
        """The covariance on a model's columns (p, p): zero for columns that are not known of."""
        place = {name: k for k, name in enumerate(names)}
        own = [k for k, name in enumerate(self.columns) if name in place]
        at = [place[self.columns[k]] for k in own]
        whole = np.zeros((len(place), len(place)))
        whole[np.ix_(at, at)] = self.covariance[np.ix_(own, own)]
        return whole


def to_json(one: Uncertainty | None) -> dict | None:
    """The covariance as ``model.json`` holds it."""
    if one is None:
        return None
    return {"columns": list(one.columns), "covariance": np.asarray(one.covariance).tolist()}


def from_json(content: dict | None) -> Uncertainty | None:
    """Read what :func:`to_json` wrote; None for a file without.

    Raises:
        InputError: If names and numbers do not fit together, or it is the covariance of nothing.
        KeyError, TypeError, ValueError: If something is missing or no number.
    """
    if content is None:
        return None
    columns, covariance = content["columns"], np.asarray(content["covariance"], float)
    named = isinstance(columns, list) and all(isinstance(c, str) for c in columns)
    if not named or covariance.shape != (len(columns), len(columns)):
        raise InputError("uncertainty is no square covariance of named columns; identify it again")
    if not np.isfinite(covariance).all() or (np.diag(covariance) < 0).any():
        raise InputError("uncertainty holds what no covariance can be; identify it again")
    return Uncertainty(tuple(columns), covariance)
