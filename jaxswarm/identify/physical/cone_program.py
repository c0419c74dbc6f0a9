r"""The rigid bodies that explain base parameters best, as a convex program.

A body is a positive semidefinite pseudo-inertia P (4, 4), and P is linear in the ten parameters: least
squares over bodies is a cone program with one minimum. The prior pulls with the divergence

.. math:: D(P, P_0) = \mathrm{tr}(P_0^{-1} P) - \log\det(P_0^{-1} P) - 4 ,

zero at :math:`P = P_0`, convex, infinite at the edge of what is a body, and the same in every frame and
unit. With :math:`P = U Q U^T` and :math:`P_0 = U U^T` the unknowns are Q, the identity for the prior.
Its logarithm is bounded through a triangle Z with :math:`\log\det Q \ge \sum_i \log Z_{ii}` where

.. math:: \begin{pmatrix} Q & Z \\ Z^T & \mathrm{diag}(Z) \end{pmatrix} \succeq 0 ,

so that a solver needs matrices and exponentials only.

References: P. Wensing, S. Kim, J.-J. Slotine, IEEE RA-L 3(1), 2018 (matrix inequalities); T. Lee,
P. Wensing, F. Park, IEEE T-RO 36(2), 2020 (the divergence); P. Goulart, Y. Chen, "Clarabel: an
interior-point solver for conic programs with quadratic objectives", 2024.
"""

from typing import NamedTuple

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.identify.physical.consistency import parameters_of

# Entries of a symmetric matrix as coordinates whose plain norm is the matrix' own; the solver wants the
# upper triangle column by column.
_PAIRS = [(i, j) for j in range(4) for i in range(j + 1)]
_UNITS = np.array(
    [[[(1.0 if i == j else 0.5**0.5) * ({i, j} == {r, c}) for c in range(4)] for r in range(4)]
     for i, j in _PAIRS]
)  # fmt: skip
_TRACE = np.array([float(i == j) for i, j in _PAIRS])
_LOWER = [(i, j) for i in range(4) for j in range(i + 1)]
_PLACE = {pair: k for k, pair in enumerate((i, j) for j in range(8) for i in range(j + 1))}
# Distance to the minimum by the solver's own gap: with 1e-8, its default, the costs of eight logs agreed to
# six digits with those of 1e-11, which takes a third longer.
_GAP = 1e-11
# Errors count in units of themselves, where the prior is met to its own last digits; the solver gives up
# there on three of ten random problems whose values no body explains. In larger units, by the size of the
# values, it does not, and what it leaves of the prior is nothing beside the error.
_UNITS_OF_ERROR = (0.0, 1e-4, 1e-2, 1.0, 1e2)
# No body is thinner than this, in squares of the prior's extent: rounding must not take it over the edge.
_THINNEST = 1e-9


class Problem(NamedTuple):
    """Least squares over n bodies and k further parameters.

    Attributes:
        matrix: (p, 10 n + k), weighted; the further columns in units in which 1 is a change that counts.
        values: (p,).
        factors: (n, 4, 4), upper triangles U of the prior bodies, P0 = U U^T.
        start, lower, upper: (k,), of the further parameters in those units.
        pull: Strength of the prior.
    """

    matrix: np.ndarray
    values: np.ndarray
    factors: np.ndarray
    start: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    pull: float


class _Rows:
    """Rows ``matrix @ x + slack = right`` with the cones of the slack, as they are put together."""

    def __init__(self) -> None:
        self.rows: list[np.ndarray] = []
        self.columns: list[np.ndarray] = []
        self.values: list[np.ndarray] = []
        self.right: list[np.ndarray] = []
        self.cones: list = []
        self.size = 0

    def add(self, cone, right, rows, columns, values) -> None:
        """Add the rows of one cone; ``rows`` count from its first."""
        right = np.asarray(right, float)
        rows, columns = np.asarray(rows, int), np.asarray(columns, int)
        self.rows.append(rows + self.size)
        self.columns.append(columns)
        self.values.append(np.broadcast_to(np.asarray(values, float), rows.shape))
        self.right.append(right)
        self.cones.append(cone)
        self.size += len(right)


def nearest_bodies(problem: Problem) -> tuple[np.ndarray, np.ndarray]:
    """Return the bodies' parameters (n, 10) and the further ones (k,) at the minimum of

    ``|matrix @ x - values|^2 + pull^2 (sum of D(P, P0) + |further - start|^2)``.

    Raises:
        InputError: If the solver finds none.
    """
    factors, bodies = problem.factors, 10 * len(problem.factors)
    size = float(np.linalg.norm(problem.values))
    for unit in np.maximum(1.0, np.multiply(_UNITS_OF_ERROR, size)):
        found = _solved(problem, unit)
        if found is not None:
            break
    else:
        raise InputError(
            "the rigid bodies nearest to the base parameters were not found: check the units of the "
            "log, or give a --prior of the arm's own size."
        )
    q = np.einsum("lk,kij->lij", found[:bodies].reshape(-1, 10), _UNITS)
    thinner = np.maximum(_THINNEST - np.linalg.eigvalsh(q)[:, 0], 0.0)
    q = q + thinner[:, None, None] * np.eye(4)
    own = np.clip(found[bodies:], problem.lower, problem.upper)
    return parameters_of(factors @ q @ factors.swapaxes(-1, -2)), own


def _solved(problem: Problem, unit: float) -> np.ndarray | None:
    """Coordinates of all Q and the further parameters at the minimum, None if the solver ends elsewhere.

    ``unit``: what counts as an error of one.
    """
    import clarabel
    from scipy.sparse import csc_matrix, diags

    u = problem.factors
    units = parameters_of(u[:, None] @ _UNITS @ u[:, None].swapaxes(-1, -2)).swapaxes(-1, -2)
    links, bodies, further = len(u), 10 * len(u), len(problem.start)
    of_links = problem.matrix[:, :bodies].reshape(-1, links, 10)
    by_link = np.einsum("blp,lpc->blc", of_links, units).reshape(-1, bodies)
    matrix = np.column_stack([by_link, problem.matrix[:, bodies:]]) / unit

    # Unknowns: Q of each link, the further parameters, Z and the logarithms of its diagonal, the residual.
    ends = np.cumsum([bodies, further, bodies, 4 * links, len(matrix)])
    rows = _rows(problem, matrix, problem.values / unit, ends)
    weight = (problem.pull / unit) ** 2
    quadratic, linear = np.zeros(ends[-1]), np.zeros(ends[-1])
    quadratic[ends[0] : ends[1]], quadratic[ends[3] :] = 2.0 * weight, 2.0
    linear[:bodies] = weight * np.tile(_TRACE, links)
    linear[ends[0] : ends[1]] = -2.0 * weight * problem.start
    linear[ends[2] : ends[3]] = -weight
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads, settings.direct_solve_method = False, 1, "qdldl"
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = _GAP
    places = np.concatenate(rows.rows), np.concatenate(rows.columns)
    constraints = csc_matrix(
        (np.concatenate(rows.values), places), shape=(rows.size, int(ends[-1]))
    )
    right = np.concatenate(rows.right)
    found = clarabel.DefaultSolver(
        csc_matrix(diags(quadratic)), linear, constraints, right, rows.cones, settings
    ).solve()
    status = clarabel.SolverStatus
    if found.status not in (status.Solved, status.AlmostSolved):
        return None
    return np.asarray(found.x)[: ends[1]]


def _rows(problem: Problem, matrix: np.ndarray, values: np.ndarray, ends: np.ndarray) -> _Rows:
    """What the unknowns must keep: the residual's meaning, bounds, and that Q and Z are as above."""
    import clarabel

    rows, size = _Rows(), matrix.shape[1]
    at, columns = np.nonzero(matrix)
    count = np.arange(len(matrix))
    rows.add(
        clarabel.ZeroConeT(len(matrix)),
        values,
        np.concatenate([at, count]),
        np.concatenate([columns, ends[3] + count]),
        np.concatenate([matrix[at, columns], -np.ones(len(matrix))]),
    )
    for sign, bound in ((-1.0, problem.lower), (1.0, problem.upper)):
        given = np.flatnonzero(np.isfinite(bound))
        if given.size:
            cone = clarabel.NonnegativeConeT(given.size)
            own = np.arange(given.size)
            rows.add(cone, sign * bound[given], own, ends[0] + given, sign)
    for link in range(len(problem.factors)):
        _add_body(rows, 10 * link, size + 10 * link, int(ends[2]) + 4 * link)
    return rows


def _add_body(rows: _Rows, q: int, z: int, logarithm: int) -> None:
    """Add the cones of one body whose Q, Z and logarithms begin at these unknowns."""
    import clarabel

    corner = [_PLACE[pair] for pair in _PAIRS]
    beside = [_PLACE[i, 4 + j] for i, j in _LOWER]
    diagonal = [k for k, (i, j) in enumerate(_LOWER) if i == j]
    below = [_PLACE[4 + i, 4 + i] for i in range(4)]
    columns = [q + k for k in range(10)] + [z + k for k in range(10)] + [z + k for k in diagonal]
    values = -np.repeat([1.0, 2.0**0.5, 1.0], [10, 10, 4])
    rows.add(clarabel.PSDTriangleConeT(8), np.zeros(36), corner + beside + below, columns, values)
    for i, k in enumerate(diagonal):
        cone = clarabel.ExponentialConeT()
        rows.add(cone, [0.0, 1.0, 0.0], [0, 2], [logarithm + i, z + k], -1.0)
