r"""Which parameters a rigid body can have.

Ten parameters (m, h, I) belong to a body of non-negative density exactly if the pseudo-inertia

.. math:: P = \begin{pmatrix} \Sigma & h \\ h^T & m \end{pmatrix}, \qquad
          \Sigma = \tfrac12 \mathrm{tr}(I)\, 1 - I

is positive semidefinite; positive mass, positive principal moments and their triangle inequality all
follow.

References: P. Wensing, S. Kim, J.-J. Slotine, "Linear matrix inequalities for physically consistent
inertial parameter identification", IEEE RA-L 3(1), 2018; C. Rucker, P. Wensing, "Smooth parameterization
of rigid-body inertia", IEEE RA-L 7(2), 2022.
"""

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot.model import Robot
from jaxswarm.robot.placements import inertia_matrix

TOLERANCE = 1e-9  # relative to the size of the body, for rounding in files


def pseudo_inertia(parameters: np.ndarray) -> np.ndarray:
    """Return the pseudo-inertia (4, 4) of ten link parameters.

    >>> pseudo_inertia(np.array([2.0, 0, 0, 0, 1.0, 0, 1.0, 0, 0, 1.0])).diagonal().tolist()
    [0.5, 0.5, 0.5, 2.0]
    """
    m, hx, hy, hz, xx, xy, yy, xz, yz, zz = parameters
    half = 0.5 * (xx + yy + zz)
    return np.array(
        [
            [half - xx, -xy, -xz, hx],
            [-xy, half - yy, -yz, hy],
            [-xz, -yz, half - zz, hz],
            [hx, hy, hz, m],
        ]
    )


def parameters_of(pseudo: np.ndarray) -> np.ndarray:
    """Return the ten link parameters (..., 10) of pseudo-inertias (..., 4, 4)."""
    p = np.moveaxis(pseudo, (-2, -1), (0, 1))
    return np.stack(
        [
            p[3, 3],
            p[0, 3],
            p[1, 3],
            p[2, 3],
            p[1, 1] + p[2, 2],
            -p[0, 1],
            p[0, 0] + p[2, 2],
            -p[0, 2],
            -p[1, 2],
            p[0, 0] + p[1, 1],
        ],
        axis=-1,
    )


def factor_of(parameters: np.ndarray) -> np.ndarray:
    """Return the upper triangle U (4, 4), its diagonal positive, with U U^T the pseudo-inertia of a body.

    Args:
        parameters: (10,), of a body of positive extent.

    Raises:
        InputError: If the parameters belong to no body of positive extent.

    >>> factor_of(np.array([4.0, 0, 0, 0, 2.0, 0, 2.0, 0, 0, 2.0])).diagonal().tolist()
    [1.0, 1.0, 1.0, 2.0]
    """
    pseudo = pseudo_inertia(np.asarray(parameters, float))
    try:
        # U U^T with U upper: factor the matrix read backwards.
        return np.linalg.cholesky(pseudo[::-1, ::-1])[::-1, ::-1]
    except np.linalg.LinAlgError:
        reasons = "; ".join(body_violations(parameters)) or "it has no extent in some direction"
        raise InputError(f"parameters of no rigid body: {reasons}.") from None


def body_violations(parameters: np.ndarray, *, inertia_only: bool = False) -> tuple[str, ...]:
    """Return why ten link parameters belong to no rigid body; empty if they belong to one.

    Args:
        parameters: (10,), in kg, kg m, kg m^2, about the frame's origin.
        inertia_only: Whether mass and first moment are unknown (zero in a base-parameter set) and
            only the inertia counts.
    """
    parameters = np.asarray(parameters, float)
    if not np.isfinite(parameters).all():
        return ("not all parameters are finite numbers",)
    reasons = []
    mass, inertia = parameters[0], inertia_matrix(parameters)
    size = np.abs(inertia).max() + 1e-300
    if not inertia_only and mass <= 0.0:
        reasons.append(f"mass {mass:.4g} kg is not positive")
    a, b, c = np.diag(inertia)
    for names, x, y, z in (("xyz", a, b, c), ("yzx", b, c, a), ("zxy", c, a, b)):
        i, j, k = (f"I{n}{n}" for n in names)
        if abs(x - y) > z + TOLERANCE * size:
            reasons.append(f"abs({i} - {j}) = {abs(x - y):.4g} > {k} = {z:.4g} kg m^2")
    if not reasons:
        low, middle, high = np.linalg.eigvalsh(inertia)
        if low < -TOLERANCE * size:
            reasons.append(f"a principal moment of inertia is negative: {low:.4g} kg m^2")
        elif high > low + middle + TOLERANCE * size:
            reasons.append(
                f"the largest principal moment {high:.4g} exceeds the sum {low + middle:.4g} kg m^2 "
                "of the others"
            )
    if not reasons and not inertia_only:
        h = parameters[1:4]
        about_center = inertia - (h @ h * np.eye(3) - np.outer(h, h)) / mass
        spread = 0.5 * np.trace(about_center) * np.eye(3) - about_center
        low = np.linalg.eigvalsh(spread)[0]
        if low < -TOLERANCE * size:
            reasons.append(
                f"about the center of mass (at {np.round(h / mass, 4).tolist()} m) the inertia is "
                f"that of no body: second moment {low:.4g} kg m^2"
            )
    return tuple(reasons)


def violations(robot: Robot, *, inertia_only: bool = False) -> tuple[str, ...]:
    """Return why a robot's link parameters are not physical, one sentence for each link.

    With ``inertia_only`` a link of which nothing but Izz is given (the first one of a base-parameter
    set) passes.

    >>> from jaxswarm.robot import rx60
    >>> violations(rx60(), inertia_only=True)[1].split(";")[0]
    'link 3 (joint3): abs(Ixx - Iyy) = 1.073 > Izz = 0.5472 kg m^2'
    """
    told = []
    for link, (name, row) in enumerate(
        zip(robot.joints, np.asarray(robot.parameters), strict=True)
    ):
        reasons = body_violations(row, inertia_only=inertia_only)
        if reasons and not (inertia_only and np.count_nonzero(row) <= 1 and row[9] >= 0.0):
            told.append(f"link {link + 1} ({name}): {'; '.join(reasons)}")
    return tuple(told)


def are_bodies(robot: Robot) -> bool:
    """Whether every link is a body with mass and extent in all directions, as simulators want it."""
    rows = np.asarray(robot.parameters, float)
    values = [np.linalg.eigvalsh(pseudo_inertia(row)) for row in rows]
    return all(v[0] > TOLERANCE * v[-1] for v in values)


def check_physical(robot: Robot, *, inertia_only: bool = False) -> None:
    """Raise if a link's parameters belong to no rigid body.

    Raises:
        InputError: With the reasons and the remedy.
    """
    told = violations(robot, inertia_only=inertia_only)
    if told:
        raise InputError(
            f"the parameters of robot {robot.name!r} are not physical: {' | '.join(told)}. "
            "Project them with nearest_physical first."
        )


def distance(parameters: np.ndarray) -> float:
    """Return how far ten link parameters are from a physical body, 0 for one.

    The Frobenius distance of the pseudo-inertia (kg, m) to the positive semidefinite matrices.
    """
    values = np.linalg.eigvalsh(pseudo_inertia(np.asarray(parameters, float)))
    return float(np.linalg.norm(np.minimum(values, 0.0)))
