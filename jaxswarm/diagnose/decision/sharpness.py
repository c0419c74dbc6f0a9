r"""Whether a law shows where motion and torque are as smooth as the samples tell.

A joint that reverses or stops moves more sharply than 50 samples a second show, and what is left there repeats
at every reversal: it looks like friction at low speed, like a coupling to whatever else reverses, and time that
is held out repeats it too. A law that acts elsewhere as well stays when such rows count by their noise
(:func:`jaxswarm.diagnose.folds.noise.row_noise`); what stood for the reversals alone goes.

Nor does a law stay that stands for where a joint hardly moves, but for friction, which is seldom not there: it
may be held at any torque. Clean arms of another simulator whose dry friction holds were told to have Stribeck
friction, at p = 3e-8 and 1e-7, with 0.9 and 1.1 times the noise left before. Beside what holds, of the second
nothing is left (a share of 0.003 in place of 0.25); of eleven true laws of low speed on such arms all stay.
What acts at all speeds has to show beside reversals, too: of a coupling of gears that was told with a share of
0.52 of what five reversals left none did.

The clock of each joint is free in that question, too (:mod:`jaxswarm.diagnose.folds.clocks`): friction and
springs must not be read out of when, in a sample, a drive's torque was read.

On a clean joint of a world with 50 samples a second, Stribeck friction took half of the squared error at
p = 1e-9, and an eighth with these weights. Of eight false candidates that passed on that log six go; of
the laws that are true of it and of six practice logs none.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.decision.level import Tested
from jaxswarm.diagnose.decision.rules import NEAR
from jaxswarm.diagnose.decision.score import score
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.beside_rest import beside_rest, beside_reversals
from jaxswarm.diagnose.folds.clocks import clock_slopes
from jaxswarm.diagnose.folds.noise import noise_of, row_noise
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.effects.base import Effect
from jaxswarm.effects.kinds import MeasurementLaw, TorqueLaw, TransmissionLaw
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.time_slopes import friction_slopes

# The noise of every row, (T', n), and what makes the folds of a model by it.
NoiseOf = Callable[[Estimate], np.ndarray]
FoldsOf = Callable[[Estimate, NoiseOf], CrossFit]


def refitted_folds(found: Estimate, doubt_of: Callable[[Estimate], np.ndarray]) -> CrossFit:
    """The folds of a model that is refitted, by such noise."""
    return cross_fit(found, doubt_of=doubt_of)


def only_sharp(
    passed: Sequence[Score],
    found: Estimate,
    crossfit: CrossFit,
    tested: Tested,
    folds_of: FoldsOf = refitted_folds,
    elsewhere: bool = False,
) -> list[Score]:
    """Those that pass no more where rows count by all their noise, sharp or not, and clocks are free.

    Asked are joints that are near that noise so: what is left of others is more than sharpness leaves. A clean
    one at 50 samples a second was left with 2.07 times its noise, and told as a bristle which took 0.56 of that
    at p = 6e-15, and nothing of what free clocks leave. What is sharp by itself, an impact in a gear or the
    edge of a contact, is not asked. How large a law is beside the torque is no question of its rows' noise: it
    stays what it was told to be.

    Args:
        passed: Scores of candidates that passed.
        found: The model they were tried on.
        crossfit: Its folds, in whose weights their columns are.
        tested: Whether a score passes, as it did.
        folds_of: Makes folds by another noise of every row.
        elsewhere: Whether other motion decides what stays: then joints that are far from their noise but for
            clocks of their own are left to it. Hysteresis that halved the error of a UR10e's fifth joint on
            two other logs, and left it with 1.1 times the noise, was refused at 2.1 times.
    """
    asking = [s for s in passed if not _is_told(s.candidate.term.law)]
    if elsewhere:
        near = found.fit.sigma <= NEAR * noise_of(found)
        asking = [s for s in asking if near[s.joint]]
    refused = []
    for noise in (row_noise, beside_rest, beside_reversals):
        own = [s for s in asking if _noise_for(s.candidate.term.law) is noise]
        again = score_softly(own, found, crossfit, folds_of, noise)
        pairs = [(s, o) for s, o in zip(own, again, strict=True) if o is not None]
        refused += [s for s, o in pairs if not tested(replace(o, over_torque=s.over_torque))]
    return refused


def _noise_for(law: Effect) -> NoiseOf:
    """The noise of rows by which a law has to show: what acts at all speeds does so beside reversals, too.

    Dry friction, and what it is seldom without, is told by where its joint rests and reverses; so is what a
    drive does to small torques, which are those of a reversal where a joint carries no weight.
    """
    if law.everyday:
        return row_noise
    low = isinstance(law, TorqueLaw) and (law.uses_direction or law.rate is not None)
    distorts = isinstance(law, MeasurementLaw) and law.distortion is not None
    return beside_rest if low or distorts else beside_reversals


def only_friction(
    passed: Sequence[Score], found: Estimate, crossfit: CrossFit, tested: Tested
) -> list[Score]:
    """Laws of late torques that pass no more where the dry friction of each joint is early or late by itself.

    Clocks and filters move all of a torque. Friction of MuJoCo turns 6 to 17 ms before the velocity does: a
    clean arm was told as read 5.5 ms early, with p = 1e-5, where nothing but friction was so by 0.5 of 1.9 ms.

    A filter told beside a delay is tested as it was, with its like alone: two of 11 and 17 ms were refused at
    p = 4e-4 and 1e-4 for the hundred others that were asked.
    """
    late = [s for s in passed if _is_late(s.candidate.term.law)]
    if not late:
        return []
    own = crossfit.weigh(friction_slopes(found.model, found.regression))
    beside = crossfit.with_columns((own,) * len(crossfit.folds))
    interval = max(m.interval for m in found.motions)
    return [s for s in late if not tested(score(s.candidate, beside, interval))]


def score_softly(
    asking: Sequence[Score],
    found: Estimate,
    crossfit: CrossFit,
    folds_of: FoldsOf = refitted_folds,
    noise: NoiseOf = row_noise,
) -> list[Score | None]:
    """Candidates scored with every row counted by all its noise and the clock of each joint free.

    None for those on joints that so, too, are left far from their noise.
    """
    if not asking:
        return []
    softer = soft_folds(found, folds_of, noise)
    left = torque_left(softer)
    least = np.minimum(np.sqrt((left**2).mean(axis=0)), found.fit.sigma)
    near = least <= NEAR * noise_of(found)
    known = crossfit.weight > 0
    ratio = np.divide(softer.weight, crossfit.weight, out=np.zeros_like(softer.weight), where=known)
    interval = max(m.interval for m in found.motions)
    return [
        score(_weighted(s.candidate, ratio), softer, interval).judged_as(s)
        if near[s.joint]
        else None
        for s in asking
    ]


def soft_folds(
    found: Estimate, folds_of: FoldsOf = refitted_folds, noise: NoiseOf = row_noise
) -> CrossFit:
    """Folds of a model with every row counted by all its noise and the clock of each joint free."""
    softer = folds_of(found, noise)
    # By these weights a torque counts against the noise of its rows, not against that of all.
    softer = replace(softer, noise=row_noise(found).min(axis=0))
    clocks = softer.weigh(clock_slopes(found))
    return softer.with_columns((clocks,) * len(softer.folds), known=True)


def torque_left(crossfit: CrossFit) -> np.ndarray:
    """What folds leave of the torque, (T, n) [N m or N]; zero in rows that do not count."""
    counted = crossfit.weight > 0
    left, weight = crossfit.whole.residual, crossfit.weight
    return np.divide(left, weight, out=np.zeros_like(left), where=counted)


def _is_told(law: Effect) -> bool:
    """Whether a law is sharp or late itself: the impact in a gear, the edge of an event, a clock, a lag."""
    loose = isinstance(law, TransmissionLaw) and law.gap is not None
    return _is_late(law) or law.recurring or loose


def _is_late(law: Effect) -> bool:
    return isinstance(law, MeasurementLaw) and (law.clock or law.late is not None)


def _weighted(candidate: Candidate, ratio: np.ndarray) -> Candidate:
    """The candidate with its rows weighted by so much more (T, n)."""
    return replace(candidate, columns=tuple(c * ratio[:, :, None] for c in candidate.columns))
