r"""The columns a candidate term would add to the model, for the whole log and for each half.

A law's torque is linear in its linear parameters, so its columns are exact. An effect that moves the
links, the clock or the scale is taken to first order about the current model: the difference it makes to
the model's torque, or the derivative of that by its parameter. Once added, it is refitted exactly.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial, singledispatch

import jax
import numpy as np

from jaxswarm import cores
from jaxswarm.diagnose.candidates.candidate import Candidate
from jaxswarm.diagnose.candidates.contact import external_candidate
from jaxswarm.diagnose.candidates.hardening import extended_candidate
from jaxswarm.diagnose.candidates.linearization import Linearization
from jaxswarm.diagnose.candidates.own_load import with_own_load
from jaxswarm.diagnose.candidates.refine import refined
from jaxswarm.diagnose.candidates.search import searching
from jaxswarm.diagnose.candidates.tone import tonal_candidate
from jaxswarm.diagnose.candidates.transmission import lagging_candidate
from jaxswarm.diagnose.candidates.whole_model import body_candidate, measurement_candidate
from jaxswarm.diagnose.folds.fold_data import FoldData
from jaxswarm.effects.base import Effect
from jaxswarm.effects.kinds import (
    BodyChange,
    ExternalTorque,
    MeasurementLaw,
    TorqueLaw,
    TransmissionLaw,
)
from jaxswarm.effects.term import Term
from jaxswarm.identify.forward.columns import is_kept
from jaxswarm.identify.forward.written_down import lateness
from jaxswarm.logs.motion import Motion

# Basis columns are filled up to a multiple, so that a model that grows does not recompile the search.
_MULTIPLE = 16


def propose_all(lin: Linearization, terms: tuple[Term, ...], key: jax.Array) -> list[Candidate]:
    """All terms as candidates; nonlinear parameters are searched where memory does not know them."""
    searched = [t for t in terms if t.law.searched]
    others = [t for t in terms if not t.law.searched]
    apart = _by_joint(t for t in others if _goes_apart(lin, t))
    # The compiled searches run while the other candidates are built, and their ends are refined as they come.
    with _searched(lin, searched, key) as found:
        with cores.beside_each(partial(_proposed, lin), apart) as told:
            own = _by_joint(t for t in others if t not in apart)
            done = {t: _with_load(lin, _proposed(lin, t)) for t in own}
            done |= {t: _with_load(lin, _refined(lin, t, values)) for t, values in found()}
            done |= zip(apart, told(), strict=True)
    return [one for one in (done[t] for t in terms) if one is not None]


def _refined(lin: Linearization, term: Term, values: list[dict[str, float]]) -> Candidate:
    """A term whose values were searched on every fold, at the best values near them."""
    best = [
        refined(lin, term, fold, v, lin.memory.least)
        for fold, v in zip(lin.crossfit.folds, values, strict=True)
    ]
    placed = replace(term, values=best[0][0])
    return Candidate(placed, tuple(own for _, own in best), len(term.law.parameters))


def _with_load(lin: Linearization, one: Candidate | None) -> Candidate | None:
    """The candidate, with the load that it has beside it where it goes by the load."""
    return one if one is None or not _goes_by_load(one.term) else _loaded(lin, one)


def _goes_by_load(term: Term) -> bool:
    return term.law.uses_load and isinstance(term.law, TorqueLaw | MeasurementLaw)


def _loaded(lin: Linearization, one: Candidate) -> Candidate:
    """A law that goes by the load of its joint, on every fold with the load that it has beside it."""
    term, least = one.term, lin.memory.least

    def made(k: int, at: Linearization) -> np.ndarray:
        if not term.law.searched:
            found = propose(term.law, at, term)
            assert found is not None  # a law of the load has columns on any
            return found.columns[k]
        return refined(at, term, lin.crossfit.folds[k], term.values, least)[1]

    begin = None if isinstance(term.law, TorqueLaw) else propose(term.law, lin.by_measured(), term)
    columns = (
        with_own_load(
            lin, fold, term.index, own, partial(made, k), begin.columns[k] if begin else None
        )
        for k, (fold, own) in enumerate(zip(lin.crossfit.folds, one.columns, strict=True))
    )
    return replace(one, columns=tuple(columns))


def _goes_apart(lin: Linearization, term: Term) -> bool:
    """Whether a term is proposed in a thread of its own: many values at once, in operations on large arrays.

    What is found out about a log for that is kept; of a long log it is not, and threads would take it from
    each other.
    """
    return isinstance(term.law, TransmissionLaw) and all(map(is_kept, lin.found.motions))


def _by_joint(terms: Iterable[Term]) -> list[Term]:
    """Joint by joint: of a long log what one joint's motion does is kept until the next one is asked for."""
    return sorted(terms, key=lambda t: -1 if t.joint is None else t.joint)


def _proposed(lin: Linearization, term: Term) -> Candidate | None:
    with jax.enable_x64(True):  # a thread has settings of its own
        return propose(term.law, lin, term)


@singledispatch
def propose(law: Effect, lin: Linearization, term: Term) -> Candidate | None:
    """A term as a candidate for the present model; None where there is nothing to say.

    Terms whose nonlinear parameters are searched (``law.searched``) are proposed by :func:`propose_all`.
    """
    raise NotImplementedError(f"no candidates of kind {type(law).__name__}")


@propose.register
def _(law: TorqueLaw, lin, term):
    if law.tone:
        return tonal_candidate(lin, term)
    return Candidate(term, lin.on_all(lin.law(term)), len(law.linear))


@propose.register
def _(law: TransmissionLaw, lin, term):
    return extended_candidate(lin, term) if law.extends else lagging_candidate(lin, term)


@propose.register
def _(law: BodyChange, lin, term):
    return body_candidate(lin, term)


@propose.register
def _(law: ExternalTorque, lin, term):
    return external_candidate(lin, term)


@propose.register
def _(law: MeasurementLaw, lin, term):
    return measurement_candidate(lin, term)


@contextmanager
def _searched(
    lin: Linearization, terms: list[Term], key: jax.Array
) -> Iterator[Callable[[], Iterable[tuple[Term, list[dict]]]]]:
    """Find nonlinear parameters of laws per fold where they are unknown, in the background.

    Yields:
        A function that gives every term with its values per fold, those that are known first.
    """
    if not terms:
        yield list
        return
    memory = lin.memory
    memory.round += 1
    found = {t: memory.recall(t, lin.residuals(t.index)) for t in terms}
    kept = [(t, values) for t, values in found.items() if values is not None]
    unknown = [t for t in terms if found[t] is None]
    recall = memory.journal.recall if memory.journal else lambda number, term: None
    known = [(t, own) for t in unknown if (own := recall(memory.round, t))]
    if len(known) == len(unknown):
        yield lambda: [*kept, *_keep(lin, known)]
        return
    motions = lin.found.motions
    chosen = _comparable(motions)
    search = searching(
        [(t.law_of(TorqueLaw), t.index, t.other) for t in unknown],
        [motions[k] for k in chosen],
        lin.found.model.width,
        [lin.loads[k] for k in chosen],
        [_folds(lin, lin.found.regression.log == k) for k in chosen],
        key,
        lateness(lin.found.model.terms),
    )

    with search as finished:

        def values() -> Iterator[tuple[Term, list[dict]]]:
            yield from kept
            searched = {}
            for term, own in _keep(lin, zip(unknown, finished(), strict=True)):
                searched[term] = own
                yield term, own
            if memory.journal:
                memory.journal.keep(memory.round, searched)

        yield values


def _comparable(motions: Sequence[Motion]) -> list[int]:
    """The logs that are searched together: those decimated as the longest one."""
    most = max(motions, key=lambda m: len(m.t)).decimator
    return [
        k
        for k, m in enumerate(motions)
        if m.decimator.factor == most.factor
        and m.decimator.taps.shape == most.taps.shape
        and np.allclose(m.decimator.taps, most.taps, atol=1e-4 * most.taps.max())
    ]


def _keep(
    lin: Linearization, found: Iterable[tuple[Term, list[dict]]]
) -> Iterator[tuple[Term, list[dict]]]:
    """The same terms with their values per fold, each remembered as it comes."""
    for term, per_fold in found:
        lin.memory.keep(term, lin.residuals(term.index), per_fold)
        yield term, per_fold


def _folds(lin: Linearization, rows: np.ndarray) -> FoldData:
    """The rows of one log as folds of the search, (joints, folds, ...)."""
    folds = lin.crossfit.folds
    width = -(-max(f.basis.shape[2] for f in folds) // _MULTIPLE) * _MULTIPLE
    used = lin.crossfit.weight[rows].any(axis=1)
    # Of a long log the largest there is: written once, where it stays. Columns of zeros fill it up.
    basis = np.zeros((lin.crossfit.weight.shape[1], len(folds), len(used), width))
    for k, fold in enumerate(folds):
        basis[:, k, :, : fold.basis.shape[2]] = fold.basis[rows].transpose(1, 0, 2)
    train = np.stack([f.train[rows] & used for f in folds])
    residual = np.stack([np.where(f.train[rows, None], f.residual[rows], 0.0) for f in folds])
    joints = basis.shape[0]
    return FoldData(
        basis,
        residual.transpose(2, 0, 1),
        np.repeat(train[None].astype(float), joints, axis=0),
        np.repeat(lin.crossfit.weight[rows].T[:, None], len(folds), axis=1),
    )
