"""Whether torques are logged in another unit than N m and N: by the masses that they would move."""

import numpy as np

from jaxswarm.identify.checks.samples import Samples
from jaxswarm.logs.finding import Finding
from jaxswarm.robot.logged import rigid_columns
from jaxswarm.robot.model import Robot

__all__ = ["wrong_unit"]

# Mass [kg] of every link, all alike, that would need the logged torques, over the square of the reach [m]: 60
# clean logs of 40 arms lie between 0.11 and 72. Below the least reach that is known (a slide alone has none)
# another one is taken, and the limits are wider by the last number.
_LIGHTEST, _LIGHT, _HEAVY, _HEAVIEST = 1e-2, 0.1, 100.0, 300.0
_LEAST_REACH, _SLIDE, _WIDER = 0.5, 1.0, 10.0
# Where the masses are known, friction and motors make up to ten times their torque; another unit a thousand.
_OTHER_UNIT = 300.0
_UNIT = "Log torques in N m and forces in N, or name the unit"


def wrong_unit(robot: Robot, samples: Samples) -> Finding | None:
    """Whether the torques need a mass that no arm of this reach carries, or far other ones than the robot's."""
    rigid = rigid_columns(robot, samples.q, samples.dq, samples.ddq)
    torque = np.sqrt(np.mean(samples.tau**2, axis=0))
    known = np.sqrt(np.mean((rigid @ np.asarray(robot.parameters).ravel()) ** 2, axis=0))
    ratio = float(np.median(torque[known > 0.0] / known[known > 0.0])) if known.any() else 1.0
    if not 1.0 / _OTHER_UNIT < ratio < _OTHER_UNIT:
        what = f"the torques are {ratio:.3g} times those of the masses in the robot's file"
        return Finding("torque_unit", what, _UNIT)
    length = robot.length
    unit = _of_a_kilogram(rigid, 0.5 * length / robot.num_joints)
    if unit == 0.0:
        return None
    mass = float(np.linalg.norm(samples.tau)) / unit
    wider = 1.0
    if length < _LEAST_REACH:
        length, wider = (_SLIDE if "prismatic" in robot.kinds else _LEAST_REACH), _WIDER
    size = mass / length**2
    what = f"the torques would move links of {mass:.3g} kg each on an arm of {length:.2g} m"
    if size < _LIGHTEST / wider or size > _HEAVIEST * wider:
        return Finding("torque_unit", f"{what}, which is out of reach of any", _UNIT)
    if size < _LIGHT / wider or size > _HEAVY * wider:
        unit_of = "kN m" if size < 1.0 else "mN m"
        remedy = f"If they are in {unit_of}, say so: --columns tau:{unit_of.replace(' ', '')}"
        return Finding("torque_unit", what, remedy, refused=False)
    return None


def _of_a_kilogram(rigid: np.ndarray, lever: float) -> float:
    """Size of the torque that moves a kilogram in every link, at a lever [m], whatever its direction.

    In the joints themselves some arms have no lever: two links whose axes meet, of 1 to 5 kg, were told to
    weigh two tons.
    """
    mass, *moments = (float(np.linalg.norm(rigid[:, :, k::10].sum(axis=2))) for k in range(4))
    return float(np.hypot(mass, lever * np.linalg.norm(moments) / np.sqrt(3.0)))
