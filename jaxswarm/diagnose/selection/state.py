"""A selection under way: the model so far, how it came about, and what it no longer asks."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

from jaxswarm.diagnose.candidates.cache import Memory
from jaxswarm.diagnose.decision.rules import Rules
from jaxswarm.diagnose.decision.worth import Score
from jaxswarm.diagnose.folds.noise import with_motion_noise
from jaxswarm.diagnose.folds.partial_out import CrossFit, cross_fit
from jaxswarm.diagnose.selection.budget import Budget, Spent
from jaxswarm.diagnose.selection.diagnosis import Outdone
from jaxswarm.diagnose.selection.step import Step
from jaxswarm.effects.term import Term
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.logs.motion import Motion


@dataclass
class Search:
    """A selection under way.

    Attributes:
        current: The model so far.
        declared: The declared model, with the clocks as they were found.
        steps: What was added, in order.
        banned: Identities of terms that were refused on the model as it is.
        unproven: Those of them that were refused by what every joint tells: on other motion, or by noisy rows.
        gone: Kinds of terms of a joint that were taken back once.
        barred: Those that were so twice, or for another law's, and are not asked any more.
        lost: Joints from which a law was taken back since very much was left there, see :mod:`.shadow`.
        kept_out: Joints where a law was refused for one that is there, beside which it might imitate any.
        unseen: By joint, waves that were refused beside its model as no whole period of them is seen.
        outdone: Laws that were refused for them.
        pairs: Places of two laws that were added at once, and are not once more.
        asked: Candidates scored in the first round.
        crossfit: The current model on all folds.
        scores: Of all candidates in the latest round.
        spent: The budget that ended the search; None: none has.
        left: Rounds that may come after the present one.
        ended: Whether it ended by its number of rounds, and more might be added.
        given_up: Whether it was left since it cannot lead to what it was made for.
        skews: Clock skews that were allowed for.
        everyday, everyday_again: Whether what every drive has was asked already, and beside what was added.
        settled: Whether every choice was made again already.
        sticking: Joints whose rows are left out where friction holds them for a moment.
        unheld: The model beside which friction was found to hold no further joint for moments; None: none.
        of_all_rows: Whether that was found of a model of all rows: a search with all of them comes no further.
        lent: The logs as they were before a law was asked for without some of their rows, which come back;
            None: that was not done yet; none: they came back.
        withdrawn, refused: As :class:`Diagnosis` tells them.
    """

    current: Estimate
    declared: Estimate
    rules: Rules
    seed: int
    memory: Memory
    other: Sequence[Motion]
    progress: Callable[[str], None]
    budget: Budget
    steps: list[Step] = field(default_factory=list)
    banned: set = field(default_factory=set)
    unproven: set = field(default_factory=set)
    gone: set = field(default_factory=set)
    barred: set = field(default_factory=set)
    lost: set[int] = field(default_factory=set)
    kept_out: set = field(default_factory=set)
    unseen: dict[int | None, Score] = field(default_factory=dict)
    outdone: list[Outdone] = field(default_factory=list)
    pairs: set[frozenset] = field(default_factory=set)
    asked: int = 0
    crossfit: CrossFit | None = None
    scores: list[Score] = field(default_factory=list)
    spent: Spent | None = None
    left: int = 0
    ended: bool = False
    given_up: bool = False
    skews: list[float] = field(default_factory=list)
    everyday: bool = False
    everyday_again: bool = False
    settled: bool = False
    sticking: set[int] = field(default_factory=set)
    unheld: Estimate | None = None
    of_all_rows: bool = False
    lent: Sequence[Motion] | None = None
    withdrawn: tuple[Term, ...] = ()
    refused: list[tuple[Term, str]] = field(default_factory=list)

    @property
    def folds(self) -> CrossFit:
        """The current model on all folds, made at the begin of every round.

        Raises:
            ValueError: If no round has begun.
        """
        if self.crossfit is None:
            raise ValueError("no round has begun: there are no folds yet")
        return self.crossfit

    def go_on(self, found: Estimate) -> None:
        """Go on from a fit, with the noise of its rows and its own folds."""
        self.current = with_motion_noise(found, self.seed)
        self.crossfit = cross_fit(self.current)

    @property
    def added(self) -> list[Term]:
        """What was added and took nothing's place: what extends it is asked with its like alone."""
        return [step.added for step in self.steps if not step.removed]

    def refuse(self, term: Term, why: str = "", *, by_all: bool = False) -> None:
        """Leave a term out until its joint's model changes; told if it had been found worth adding.

        ``by_all``: by what all joints tell, so until any joint's model changes.
        """
        key = kind_of(term)
        self.banned.add(key)
        if by_all:
            self.unproven.add(key)
        if why and (term.identity, why) not in {(t.identity, w) for t, w in self.refused}:
            self.refused.append((term, why))

    def is_refused(self, term: Term) -> bool:
        """Whether a term of this kind was refused on the model as it is."""
        return kind_of(term) in self.banned

    def ask_again(self, joint: int | None) -> None:
        """Ask again what was refused beside less: on this joint and of the whole arm, anywhere if None.

        A filter of the torque was refused as it raised by chance what a spring explained in the next round, and
        was not asked again: a delay in its place left unseen motion with 5 to 68 times the floor. What other
        motion refused is asked again whatever changes: a backlash of joint 5 was not shown there by the sum of
        all joints while joint 3 lacked a drag of 33 times its noise, which was found next. So is what the noise
        of every row refused: a drag of joint 2, of p = 4e-5, fell to chance by quiet rows while joint 3 lacked
        the Stribeck friction that was added next, and both ended as unexplained.
        """
        if joint is None:
            self.banned, self.unseen = set(), {}
        self.unseen.pop(joint, None)
        again = self.unproven | {key for key in self.banned if key[1] in (None, joint)}
        self.banned, self.unproven = self.banned - again, set()


def kind_of(term: Term) -> tuple:
    """What a term is whatever its values: of events, all of a kind."""
    return replace(term, values={}).identity
