"""From a log as read to the motions that may be fitted: what cannot be right is mended, told or refused."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cache

from jaxswarm.errors import InputError, nearest
from jaxswarm.identify.checks.channels import enough, wrong_channels
from jaxswarm.identify.checks.conventions import CONVENTION
from jaxswarm.identify.checks.dead_encoder import dead_encoders
from jaxswarm.identify.checks.dead_torque import dead_torque
from jaxswarm.identify.checks.guesses import ENCODER_ZERO
from jaxswarm.identify.checks.late import late_torque
from jaxswarm.identify.checks.mounting import MOUNTING
from jaxswarm.identify.checks.relation import NO_RELATION, Relation, relation_of, unrelated_by_few
from jaxswarm.identify.checks.rough import Rough
from jaxswarm.identify.checks.samples import fine_samples, samples_of
from jaxswarm.identify.checks.torque_unit import wrong_unit
from jaxswarm.identify.checks.weak import WEAK, all_rest
from jaxswarm.logs import frozen, lost, pace, spikes
from jaxswarm.logs.consistency import refuse_dead_torque
from jaxswarm.logs.finding import Finding
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import Filtering, Motion
from jaxswarm.logs.segments import prepare_segments
from jaxswarm.robot.model import Robot

CHECKS = {
    "spikes": "single samples far off their neighbors",
    "stuck": "a position that stands in the midst of a motion",
    "lost_samples": "samples missing while time goes on evenly",
    "saturation": "torques at the limit of their channel",
    "torque_sign": "friction that drives, torques of the wrong sign",
    "position_sign": "positions of the wrong sign",
    "swapped_channels": "columns of joints exchanged, or in another order",
    "encoder_scale": "positions in another unit than rad or m, or a multiple of what is logged",
    ENCODER_ZERO: "positions that read too large or too small by a constant",
    CONVENTION: "joints that turn the other way, or from another zero, than in the robot's file",
    MOUNTING: "a base on a wall, under a ceiling or on its edge that is declared otherwise",
    "torque_scale": "torques that are a multiple of what is logged",
    "time_scale": "time that is a multiple of what is logged",
    "late_torque": "torques that are late or early against the motion, all or one joint's",
    "torque_unit": "torques out of reach of any arm of that geometry",
    WEAK: "motion that is too short or too little for what is asked",
    NO_RELATION: "torque that has nothing to do with the motion",
}


def checked(
    log: Log,
    robot: Robot,
    filtering: Filtering,
    accept: Sequence[str] = (),
    *,
    refuse_dead: bool = True,
) -> tuple[Log, list[Motion]]:
    """Mend and check a log, and prepare its stretches between gaps.

    Args:
        log: As read.
        robot: Kinematics.
        filtering: Frequencies; those that are None come from this log.
        accept: Names of :data:`CHECKS` whose findings are told only.
        refuse_dead: Whether a torque of one value is refused.

    Returns:
        The log with what was found as notes, and its motions.

    Raises:
        InputError: On a finding that is not accepted, or a log that cannot be filtered.
    """
    for name in accept:
        if name not in CHECKS:
            raise InputError(f"unknown check {name!r} to accept. {nearest(name, CHECKS)}")
    if refuse_dead:
        refuse_dead_torque(log)
    log = _with_findings(log, pace.slow_clock(log), accept)
    log, found = spikes.bridged(log)
    found += lost.lost_samples(log)
    log, saturated = frozen.without_saturated(log)
    log, stuck = frozen.without_stuck(log)
    mended = [*found, *saturated, *stuck]
    log = _with_findings(log, mended, accept)
    log, motions = prepare_segments(log, filtering)
    return _with_findings(log, against_robot(robot, motions), accept, mended), motions


def _with_findings(
    log: Log, findings: Iterable[Finding], accept: Iterable[str], known: Iterable[Finding] = ()
) -> Log:
    """The log with its findings, and their sentences as notes, unless one of them forbids to go on.

    Args:
        log: With notes of its own.
        findings: What is new about it.
        accept: Names of checks whose findings are told only.
        known: What was found before: a refusal names it too, for it may be the cause.

    Raises:
        InputError: Naming all findings that are refused and not accepted.
    """
    findings, accepted = tuple(findings), set(accept)
    bad = [f for f in findings if f.refused and f.check not in accepted]
    if bad:
        names = " ".join(f"--accept {name}" for name in dict.fromkeys(f.check for f in bad))
        told = " ".join(f.note for f in bad)
        if before := " ".join(f.note for f in (*known, *findings) if f not in bad):
            told = f"{told} Besides, {before}"
        raise InputError(f"{log.source}: {told} To fit the log as it is, pass {names}")
    notes = (*log.notes, *(f.note for f in findings))
    return replace(log, notes=notes, findings=(*log.findings, *findings))


def against_robot(robot: Robot, motions: Sequence[Motion]) -> list[Finding]:
    """What is wrong with the motions and torques of a log of this robot."""
    if motions[0].tau is None or all_rest(motions):
        return []
    samples = samples_of(motions)
    if not enough(robot, samples):
        return dead_encoders(robot, samples) or unrelated_by_few(robot, samples)
    rough = Rough(robot, samples)
    fine = cache(lambda: Rough(robot, fine_samples(motions)))
    dead = dead_torque(robot, rough)
    contradicted = dead is not None and dead.refused
    channels = wrong_channels(robot, rough, fine, every_joint=contradicted)
    if dead is not None and contradicted and channels is None:
        return [dead]
    told_only = channels is not None and not channels.refused  # what is left goes on with it
    related = Relation(None, samples) if told_only else relation_of(robot, rough)
    relation = related.found
    # Torques that do not go with the masses say nothing of their unit where the motion is known to be wrong,
    # nor do those of a push.
    belongs = samples if related.belongs is None else related.belongs
    unit = None if channels else wrong_unit(robot, belongs)
    told = dead if relation is None and (channels is None or told_only) else None
    found = [one for one in (channels, unit, relation, told) if one is not None]
    # A unit that may be another one says nothing of the clocks; where more is wrong, nothing is known of them.
    if channels is None and relation is None and (unit is None or not unit.refused):
        interval = max(m.interval for m in motions)
        late = late_torque(robot, rough, fine(), interval)
        found += [] if late is None else [late]
    return found
