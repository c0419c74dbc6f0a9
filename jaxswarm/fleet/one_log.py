"""One log of a fleet, in a worker: fetched, diagnosed, and told as plain data, whatever comes of it."""

import traceback
from dataclasses import dataclass

from jaxswarm.errors import InputError
from jaxswarm.fleet.sources import at_hand, stamp
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs import LogChoice
from jaxswarm.logs.reading import Reading
from jaxswarm.robot import Robot

# Lines of a traceback that are kept: enough to find the place.
_LINES = 30


# Why a log has no diagnosis: something is wrong with it, or with us, a worker, the store.
REFUSED, FAILED = "refused", "failed"


@dataclass(frozen=True, eq=False)
class Settings:
    """What is asked of every log.

    Attributes:
        robot: The kind of the arms.
        declare: What is known to be there.
        model: A model identified before, in place of ``declare``.
        seed: Seed of the searches.
        motion_cutoff, torque_cutoff: Low-passes [Hz]; None: found from the data.
        accept: Findings in spite of which a log is fitted.
        budget: Seconds after which no further round of a log begins; None: as many as it takes.
        reading: What the logs do not say about themselves.
    """

    robot: Robot
    declare: str | None = None
    model: Model | None = None
    seed: int = 0
    motion_cutoff: float | None = None
    torque_cutoff: float | None = None
    accept: tuple[str, ...] = ()
    budget: float | None = None
    reading: Reading = Reading()


def examine(address: str, settings: Settings) -> dict:
    """Diagnose a log.

    Args:
        address: Of the log, see :class:`jaxswarm.fleet.sources.Source`.
        settings: What is asked.

    Returns:
        The ``stamp`` of what was read, and one of: ``result``, the content of ``diagnosis.json``;
        ``unused``, ``refused`` for what is wrong with the log or ``failed`` for anything else, with the
        ``reason``, and of a failure its ``trace``.
    """
    from jaxswarm.tasks.diagnosis import diagnose

    mark = None
    try:
        mark = stamp(address)
        with at_hand(address) as path:
            found = diagnose(
                [LogChoice(path, settings.reading)],
                settings.robot,
                settings.declare,
                model=settings.model,
                seed=settings.seed,
                motion_cutoff=settings.motion_cutoff,
                torque_cutoff=settings.torque_cutoff,
                accept=settings.accept,
                budget=settings.budget,
            )
        return {"stamp": mark, "result": dict(found.content)}
    except InputError as error:
        return {"stamp": mark, **unused(REFUSED, str(error))}
    except Exception as error:  # one log must not end the others, whatever is wrong with it
        told = (str(error).splitlines() or [""])[0]
        trace = traceback.format_exc().splitlines()[-_LINES:]
        reason = f"{type(error).__name__}: {told}"
        return {"stamp": mark, **unused(FAILED, reason), "trace": trace}


def unused(word: str, reason: str) -> dict:
    """What stands in place of a diagnosis: ``refused`` or ``failed``, and why."""
    return {"unused": word, "reason": reason}
