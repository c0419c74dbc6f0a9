"""The edit test: delete only the named term, and predict a log of the world without that effect, no refit.

What is asked is bounded by what the fitted log can tell. A term and its neighbors may each be known far worse
than their sum: on eight seconds of a cycle an offset of 42 N m and gravity are told apart to 1 N m, their sum
to a hundredth of that. So the error is compared with that of an oracle as well, which knows the form of the
effect, all others, the widths and the lag, fits the numbers of the one effect beside the declared model, and
deletes it.
"""

from dataclasses import replace

import numpy as np

from benchmarks.worlds import plain
from benchmarks.worlds.along import law_torque
from benchmarks.worlds.laws import LAWS
from benchmarks.worlds.rigid import rms
from benchmarks.worlds.world import World

# Passed: an error no larger than this many times what the whole model, or the floor, has on the same motion
# with the effect, or the oracle without it.
EDIT = 1.5
# Step of a parameter by which a column is differenced, in its own size.
_STEP = 1e-3


def without(term: dict) -> dict | None:
    """What a term of ``model.json`` leaves when the effect is taken away; None: nothing.

    A law that holds the declared friction of its joint loses what the effect put there: in these worlds more
    friction forward.
    """
    if term["effect"] != "asymmetric_friction":
        return None
    values = term["values"]
    even = {"fc_pos": values["fc_neg"], "b_pos": values["b_neg"]}
    return {**term, "values": {**values, **even}}


def edit_oracle(world: World, logs: dict[str, tuple]) -> np.ndarray:
    """Error per joint of the oracle on ``edit_ptp``, below the band, (n,).

    ``logs``: ``train`` and ``edit_ptp`` as ``(log, hidden)``.
    """
    cutoff = plain.best_cutoff(world, *logs["train"], known=True)
    train = plain.prepare(world, *logs["train"], cutoff)
    oracle = _Beside(world, train, train.effect, _slopes(world, train))
    log, hidden = logs["edit_ptp"]
    clean = plain.prepare(world, {**log, "tau": hidden["tau_clean"]}, hidden, cutoff)
    declared = plain.Plain.raw(oracle, clean)
    rest = clean.tau - clean.effect - declared @ oracle.values[: declared.shape[2]]
    return rms(plain.inner(plain.low_pass(rest, clean.rate, plain.BAND), clean.rate))


class _Beside(plain.Plain):
    """The declared model with further columns along its training log, (T, n, p)."""

    def __init__(self, world: World, train: plain.Prepared, known: np.ndarray, beside: np.ndarray):
        self.beside = beside
        super().__init__(world, train, known)

    def raw(self, log: plain.Prepared) -> np.ndarray:
        return np.concatenate([super().raw(log), self.beside], axis=2)


def _slopes(world: World, log: plain.Prepared) -> np.ndarray:
    """What the torque of the edited effect gains along a log by each of its numbers, (T, n, p).

    Of a structure, which is no law of the motion, by its size.
    """
    edited = world.edited
    assert edited is not None
    if LAWS[edited.kind].torque is None:
        others = [law_torque(world.arm, log, e) for e in world.effects if e is not edited]
        return (log.effect - sum(others))[:, :, None]
    there = law_torque(world.arm, log, edited)
    slopes = []
    for name, value in edited.params.items():
        if value:
            more = replace(edited, params={**edited.params, name: value * (1.0 + _STEP)})
            slopes.append((law_torque(world.arm, log, more) - there) / _STEP)
    return np.stack(slopes, axis=2)
