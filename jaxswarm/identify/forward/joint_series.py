"""What laws on a joint see along a log, and what was seen last, ready for their programs.

A fit of 20 terms on a log of 5000 samples asks for the columns of the same few laws hundreds of times, a
diagnosis 36,000 times: of 0.2 ms each the law itself took 0.03, signs of velocities and filling up the rest.
"""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from threading import Lock
from typing import NamedTuple

import numpy as np

from jaxswarm.effects.sample import Sample
from jaxswarm.identify.forward.direction import direction
from jaxswarm.identify.forward.lengths import filled
from jaxswarm.logs.motion import Motion

# Numbers that the series which are kept may hold: of a log of seconds some fifty joints and pairs, 32 MB.
_MOST = 2**22
# The arrays that a series was made of, which keep their places in memory as long as it is kept, and the series.
_kept: OrderedDict[tuple, tuple[tuple, Sample[np.ndarray]]] = OrderedDict()
_keeping = Lock()


class Load(NamedTuple):
    """Torque of a model along a log [N m or N], (T, n).

    Attributes:
        full: Of the rigid body.
        static: Of the rigid body without acceleration.
        whole: Of the rigid body and of all effects that supply a torque; None where no law asks.
    """

    full: np.ndarray
    static: np.ndarray
    whole: np.ndarray | None = None


def joint_series(
    motion: Motion,
    width: Sequence[float],
    load: Load | None,
    joint: int,
    other: int | None = None,
) -> Sample[np.ndarray]:
    """What a law on ``joint`` (with partner ``other``) sees along a log: a Sample of (T,) NumPy arrays.

    ``width`` is that of every joint's smooth sign, (n,); those of two velocities take the joint's own.
    """
    own = _of_motion(motion, joint, other)._replace(**_signs(motion, width, joint, other))
    return own if load is None else own._replace(**load_series(load, joint))


def _of_motion(motion: Motion, joint: int, other: int | None) -> Sample[np.ndarray]:
    """What of :func:`joint_series` follows from the motion alone, all else zero."""
    zero = np.zeros(len(motion.t))
    temperature = motion.channels.get("temperature")
    own = Sample(
        t=motion.t,
        q=motion.q[:, joint],
        dq=motion.dq[:, joint],
        ddq=motion.ddq[:, joint],
        direction=zero,
        load=zero,
        static_load=zero,
        temperature=zero + np.nan if temperature is None else temperature[:, joint],
        dq_other=zero,
        ddq_other=zero,
        direction_sum=zero,
        direction_difference=zero,
        state=zero,
        q_other=zero,
    )
    return own if other is None else own._replace(**_of_partner(motion, other))


def _of_partner(motion: Motion, other: int) -> dict:
    """The fields (T,) of :func:`joint_series` that follow from a partner's motion, by name."""
    x = {"dq_other": motion.dq, "ddq_other": motion.ddq, "q_other": motion.q}
    return {name: column[:, other] for name, column in x.items()}


def _signs(motion: Motion, width: Sequence[float], joint: int, other: int | None) -> dict:
    """The smooth signs (T,) of :func:`joint_series` by name, those of both where there is a partner."""
    own = {"direction": direction(motion.dq[:, joint], width[joint], motion.driven)}
    return own if other is None else own | _signs_of_both(motion, width, joint, other)


def _signs_of_both(motion: Motion, width: Sequence[float], joint: int, other: int) -> dict:
    own, partner = motion.dq[:, joint], motion.dq[:, other]
    both = {"direction_sum": own + partner, "direction_difference": own - partner}
    return {name: direction(dq, width[joint], motion.driven) for name, dq in both.items()}


def partner_series(motion: Motion, width: Sequence[float], joint: int, other: int) -> dict:
    """The fields (T,) of :func:`joint_series` that a partner fills, by name."""
    return _of_partner(motion, other) | _signs_of_both(motion, width, joint, other)


def load_series(load: Load, joint: int) -> dict:
    """The fields (T,) of :func:`joint_series` that a load fills, by name."""
    return {"load": load.full[:, joint], "static_load": load.static[:, joint]}


def filled_series(
    motion: Motion, width: Sequence[float], joint: int, other: int | None = None
) -> Sample[np.ndarray]:
    """:func:`joint_series` without a load, of a length that has a program; what was asked for last is kept.

    A log that is given another noise or other rows is the same motion, and finds what is kept of it. Of the
    many widths that a fit tries each finds what was made for the first, but for the sign.
    """
    made_of = (motion.t, motion.q, motion.dq, motion.ddq, motion.channels.get("temperature"))
    place = (*map(id, made_of), motion.driven, joint, other)

    def plain() -> Sample[np.ndarray]:
        return filled(_of_motion(motion, joint, other))

    def signed() -> Sample[np.ndarray]:
        signs = filled(_signs(motion, width, joint, other))
        return _last((*place, None), made_of, plain)._replace(**signs)

    return _last((*place, float(width[joint])), made_of, signed)


def _last(
    place: tuple, made_of: tuple, make: Callable[[], Sample[np.ndarray]]
) -> Sample[np.ndarray]:
    """The series that is kept of a place, or is made of arrays and kept with these."""
    with _keeping:
        if place in _kept:
            _kept.move_to_end(place)
            return _kept[place][1]
    series = make()
    with _keeping:
        _kept[place] = made_of, series
        most = _MOST // (len(Sample._fields) * len(series.t))
        while len(_kept) > most:
            _kept.popitem(last=False)
    return series
