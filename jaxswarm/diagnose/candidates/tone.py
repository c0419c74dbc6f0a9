r"""A torque of a frequency of its own, read off the spectrum of what a model leaves on a joint.

A sine that is fitted to n rows takes off :math:`2 |X(f)|^2 / n` of their squares, X their Fourier transform:
the highest line of the spectrum is the best frequency. What follows from the motion can have a line too; a
tone is asked only where the motion has none that could carry it, and where it does not repeat itself with a
multiple of the tone's period. A force shakes the arm it acts on, as far as the controller lets it: a line of
the motion is weighed against how much of the residual the tone takes off in a refitted model, since what
follows from the motion brings the rest of the motion with it. Without the tone the model bends to take up what
it can of it by that line of the motion, and pays for it everywhere else. That bends its line as well: the
frequency is the one that takes most off a refitted model. One that is a sixteenth of a line off leaves 1.3 % of
the tone, as much as the noise is beside a force of nine times it.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.folds.partial_out import Fold
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.term import Term
from jaxswarm.logs.coverage import repeats_after, step_of_repeats
from jaxswarm.logs.motion import Motion

# Least share of a joint's squared error that a tone takes off: below, it may be the strongest of a law's lines.
# Springs, drag and ripples on a joint that swings at the tone's frequency, too, let it take 0.06 to 0.36.
_LEAST = 0.5
# Least share of it that is in the tone's line while the model is without it: a fifth, as of any effect's.
_IN_LINE = 0.2
# Periods that a log holds at least, and how much finer than its resolution frequencies are looked at.
_PERIODS, _FINER = 4, 8
# A line of a joint's position, velocity or acceleration, as power in the line to power beside it, is the
# motion's own where it is this part of the residual's. At the least share that is 3 % of the motion, where a
# tone takes 99 % it is three quarters.
_OWN_LINE = 0.03
# Part of a turn by which a tone is ahead when the motion repeats itself: then a fifth of its power at least
# does not repeat, and no function of the motion can be that part. Less of a turn does where the power that does
# not repeat is so many times what the tone leaves: a force of 46 times the noise, 0.14 of a turn ahead, was
# "unexplained at 3.6 to 3.7 Hz". Nor can one that takes more than the first
# part of its joint's squared error by one line alone, beyond so many times the frequencies in which the motion
# has nearly all of its power: there is nothing of squares and cubes of the motion, and of steeper functions a
# little in many lines. A quarter of 40 forces were in step by chance.
_OUT_OF_STEP, _UNREPEATED = 0.15, 10.0
_ALL, _BEYOND, _NEARLY = 0.9, 3.0, 0.999


class _Line(NamedTuple):
    """A line of a log's spectrum: its share of the power, where it is, the log, and how far the next one is."""

    share: float
    hertz: float
    log: int
    step: float


def tonal_candidate(lin: Linearization, term: Term) -> Candidate | None:
    """The term at the strongest line of its joint's residual, found on every fold anew; None without one."""
    held = {t.values.get("log", 0.0) for t in lin.found.model.terms if t.place == term.place}
    free = [log for log in np.unique(lin.found.regression.log) if float(log) not in held]

    def strongest(fold: Fold) -> _Line:
        return _strongest(lin, free, np.where(fold.train, fold.residual[:, term.joint], 0.0))

    whole, *others = lin.crossfit.folds
    line = strongest(whole)
    if line.share < _IN_LINE:
        return None
    told = _in_tune(lin, whole, term, line)
    share = _taken_off(lin, whole, lin.law(told), term.index, line.log)
    hertz = told.values[term.law_of(TorqueLaw).tone]
    if share < _LEAST or not _alone(lin.found.motions[line.log], hertz, share):
        return None
    placed = [told, *(_in_tune(lin, fold, term, strongest(fold)) for fold in others)]
    return Candidate(told, tuple(lin.law(one) for one in placed), len(term.law.linear) + 1)


def _in_tune(lin: Linearization, fold: Fold, term: Term, line: _Line) -> Term:
    """The term where it takes most off a refitted model: the top of a parabola through a line and its next."""
    name = term.law_of(TorqueLaw).tone

    def at(hertz: float) -> Term:
        return replace(term, values={name: hertz, "log": float(line.log)})

    low, here, high = (
        _taken_off(lin, fold, lin.law(at(line.hertz + k * line.step)), term.index, line.log)
        for k in (-1, 0, 1)
    )
    bend = 2.0 * here - low - high
    shift = 0.5 * (high - low) / bend if bend > 0.0 else 0.0
    return at(line.hertz + line.step * min(max(shift, -1.0), 1.0))


def _taken_off(lin: Linearization, fold: Fold, columns: np.ndarray, joint: int, log: int) -> float:
    """Share of a joint's squared error in a log that weighted columns (T', n, k) take off, all refitted."""
    rows = fold.train & (lin.found.regression.log == log)
    before, after = (f.residual[rows, joint] for f in (fold, fold.with_columns(columns)))
    return 1.0 - float(after @ after) / max(float(before @ before), 1e-300)


def _strongest(lin: Linearization, logs: Sequence[int], left: np.ndarray) -> _Line:
    """The strongest line in logs of a residual (T',) that is zero off its rows, as a share of its log's."""
    regression, best, most = lin.found.regression, _Line(0.0, 1.0, 0, 0.0), 0.0
    for log in logs:
        own = left[regression.log == log]
        used = max(int((own != 0.0).sum()), 1)
        step = regression.step[log]
        size = _FINER * len(own)
        gain = 2.0 * np.abs(np.fft.rfft(own, size)) ** 2 / used
        hertz = np.fft.rfftfreq(size, step)
        motion = lin.found.motions[log]
        inside = (hertz >= _PERIODS / (len(own) * step)) & (hertz <= motion.torque_cutoff)
        if not inside.any():
            continue
        pick = int(np.argmax(np.where(inside, gain, 0.0)))
        if gain[pick] > most:
            most, share = float(gain[pick]), gain[pick] / max(float((own**2).sum()), 1e-300)
            best = _Line(float(share), float(hertz[pick]), int(log), float(hertz[1]))
    return best


def _alone(motion: Motion, hertz: float, share: float) -> bool:
    """Whether nothing that follows from the motion can have its line [Hz] take that share of a residual."""
    most = _OWN_LINE * share / max(1.0 - share, 1e-300)
    turn = np.exp(-2j * np.pi * hertz * motion.t)
    for x in (motion.q, motion.dq, motion.ddq):
        own = x - x.mean(axis=0)
        line = 2.0 * np.abs(turn @ own) ** 2 / len(own)
        whole = (own**2).sum(axis=0)
        if (line > most * np.maximum(whole - line, 0.0)).any():
            return False
    period = repeats_after(motion.t, motion.q)
    if period is None:
        return True
    ahead = abs(hertz * period - round(hertz * period))
    # The period is known to a step.
    at_least = max(ahead - hertz * step_of_repeats(motion.t), 0.0)
    unrepeated = np.sin(np.pi * at_least) ** 2 * share
    out_of_step = ahead > _OUT_OF_STEP or unrepeated > _UNREPEATED * (1.0 - share)
    return out_of_step or (share > _ALL and hertz > _BEYOND * _highest(motion))


def _highest(motion: Motion) -> float:
    """The frequency [Hz] below which every joint's velocity has nearly all of its power."""
    dq = motion.dq - motion.dq.mean(axis=0)
    power = np.cumsum(np.abs(np.fft.rfft(dq, axis=0)) ** 2, axis=0)
    above = power >= _NEARLY * power[-1]
    hertz = np.fft.rfftfreq(len(dq), 1.0 / motion.rate)
    return float(max(hertz[np.argmax(above, axis=0)]))
