"""A selection without some of what it added."""

from collections.abc import Sequence

from jaxswarm.diagnose.selection.refit import refit_once
from jaxswarm.diagnose.selection.state import Search
from jaxswarm.diagnose.selection.step import Step, chain, terms_before
from jaxswarm.effects.alike import has
from jaxswarm.effects.term import Term


def terms_without(gone: Sequence[Step], terms: Sequence[Term]) -> tuple[Term, ...]:
    """The terms of a model without additions, and with what they took the place of."""
    left = tuple(terms)
    for step in gone:
        left = terms_before(step, left) if has(step.added, left) else left
    return left


def go_on_without(search: Search, gone: Sequence[Step]) -> None:
    """Go on without some additions, by what is told before and after the others as it is without them."""
    terms = terms_without(gone, search.current.model.terms)
    kept = [s for s in search.steps if not any(s is one for one in gone)]
    search.go_on(refit_once(search.current, terms))
    search.steps = chain(kept) if kept else []
