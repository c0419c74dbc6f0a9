"""Terms: which law acts on which joint, and the ``name[@joint[:partner]],...`` lists that declare them."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from jaxswarm.effects.base import Effect, get_law
from jaxswarm.effects.formula import Formula, formula_law
from jaxswarm.effects.parameter import Unit
from jaxswarm.errors import InputError, nearest
from jaxswarm.nodes import node_of

K = TypeVar("K", bound=Effect)


@dataclass(frozen=True)
class Term:
    """One law on one joint of one robot, with the values of its parameters once they are known.

    Attributes:
        effect: Registered name of the law.
        joint: Index of the joint, None for a global law.
        other: Index of the partner joint of a pair law, else None.
        values: Parameter values by name; empty before a fit.
        formula: A law that no registry holds, as data; then ``effect`` only says so.
    """

    effect: str
    joint: int | None = None
    other: int | None = None
    values: dict[str, float] = field(default_factory=dict, compare=False, hash=False)
    formula: Formula | None = None

    @property
    def law(self) -> Effect:
        """The registered law, or that of the formula."""
        return get_law(self.effect) if self.formula is None else formula_law(self.formula)

    def law_of(self, kind: type[K]) -> K:
        """The law where it is known to be of a kind.

        Raises:
            TypeError: If it is of another one.
        """
        law = self.law
        if not isinstance(law, kind):
            raise TypeError(f"{self.effect} is a {type(law).__name__}, not a {kind.__name__}")
        return law

    @property
    def index(self) -> int:
        """Index of the joint of a law that has one.

        Raises:
            TypeError: If the law is one of the whole arm.
        """
        if self.joint is None:
            raise TypeError(f"{self.effect} acts on the whole arm, not on one joint")
        return self.joint

    @property
    def found_formula(self) -> Formula:
        """The formula of a law that is one.

        Raises:
            TypeError: If a registry holds the law.
        """
        if self.formula is None:
            raise TypeError(f"{self.effect} is a law of the catalog, not a formula")
        return self.formula

    def label(self, joints: tuple[str, ...]) -> str:
        """Readable name: ``viscous_friction@joint2``, ``transmission_coupling@joint5:joint6``."""
        if self.joint is None:
            return self.effect
        partner = "" if self.other is None else f":{joints[self.other]}"
        return f"{self.effect}@{joints[self.joint]}{partner}"

    def acts_in(self, log: int | None) -> bool:
        """Whether it can show in a log by its number: what happened in another one cannot; None: in any."""
        return log is None or not self.law.in_one_log or self.values.get("log", 0) == log

    @property
    def place(self) -> tuple:
        """Effect, joint and partner."""
        return self.effect, self.joint, self.other

    @property
    def identity(self) -> tuple:
        """What a term is, whatever it was fitted to: effect, joint, partner, and which of its kind.

        None stands for the event of a property of the robot, and of an event that has no place yet.
        """
        names, values = self.law.identity, {**self.law.nominal(), **self.values}
        known = any(name in self.values for name in names)
        return (*self.place, tuple(round(values[name], 1) for name in names) if known else None)

    def apart(self, other: "Term") -> float:
        """How far two terms of one place lie apart by what tells such terms apart; 0 where nothing does.

        A fit moves the begin of an event, and its identity with it.
        """
        return sum(
            abs(self.values.get(name, 0.0) - other.values.get(name, 0.0))
            for name in self.law.identity
        )

    def columns(self, joints: tuple[str, ...]) -> tuple[str, ...]:
        """Names of the columns of the linear parameters: ``b_joint2:viscous_friction``.

        Those of an event say when it begins, those of one among several what tells it from the others.
        """
        where = "" if self.joint is None else f"_{joints[self.joint]}"
        where += "" if self.other is None else f"_{joints[self.other]}"
        if self.law.recurring and "start" in self.values:
            where += f"_{self.values['start']:.1f}s"
        if "log" in self.law.identity and not self.law.recurring and self.values.get("log", 0.0):
            where += f"_log{self.values['log'] + 1:.0f}"
        if self.law.several:
            where += "".join(
                f"_{self.values[n]:.1f}" for n in self.law.identity if n in self.values
            )
        return tuple(f"{name}{where}:{self.effect}" for name in self.linear_names(joints))

    def linear_names(self, joints: tuple[str, ...]) -> list[str]:
        """Names of the values that the columns multiply, in their order."""
        return self.law.linear_names(joints)

    def with_linear(self, values: Iterable[float], joints: tuple[str, ...]) -> "Term":
        """The term with other values for its columns, in their order.

        >>> Term("viscous_friction", 0).with_linear(np.array([2.0]), ("a",)).values
        {'b': 2.0}
        """
        own = zip(self.linear_names(joints), map(float, values), strict=True)
        return replace(self, values={**self.values, **dict(own)})


# Values are data of a compiled program, the rest is its structure.
node_of(Term, leaves=["values"], fixed=["effect", "joint", "other", "formula"])


def physical_unit(unit: str, kind: str) -> str:
    """Translate a revolute joint's unit into the one of ``kind``.

    >>> physical_unit("N m s/rad", "prismatic"), physical_unit("kg m^2", "prismatic")
    ('N s/m', 'kg')
    """
    if kind != "prismatic":
        return unit
    if isinstance(unit, Unit):
        return unit.sliding
    for old, new in (("kg m^2", "kg"), ("N m", "N"), ("rad", "m")):
        unit = unit.replace(old, new)
    return unit


def parse_terms(text: str, joints: tuple[str, ...]) -> tuple[Term, ...]:
    """Read a list such as ``viscous_friction,coulomb_friction@joint2`` for a robot's joints.

    A name without a joint stands for every joint; a pair law without partner takes the next joint
    (the last joint: the one before). ``none`` is the empty list.

    Raises:
        InputError: On an unknown effect or joint, a repeated term or a misplaced ``@``.

    >>> [t.label(("a", "b")) for t in parse_terms("viscous_friction,joint_spring@b", ("a", "b"))]
    ['viscous_friction@a', 'viscous_friction@b', 'joint_spring@b']
    """
    terms: list[Term] = []
    for item in (part.strip() for part in text.split(",")):
        if item in ("", "none"):
            continue
        name, at, where = item.partition("@")
        law = get_law(name)
        if at and not where:
            raise InputError(f"{item} names no joint; write {name}@JOINT, or {name} for all")
        for term in _expand(law, where, joints):
            if term in terms:
                raise InputError(f"effect {term.label(joints)} is listed twice; name it once")
            terms.append(term)
    return tuple(terms)


def of_kind(terms: Iterable, kind: type[Effect]) -> list:
    """Those of the terms, or of whatever else has a ``law``, that are of one kind."""
    return [t for t in terms if isinstance(t.law, kind)]


def valued(terms: Iterable[Term]) -> tuple:
    """Which terms these are, and with which values: to be found again by."""
    return tuple((t, *sorted(t.values.items())) for t in terms)


def _expand(law: Effect, where: str, joints: tuple[str, ...]) -> list[Term]:
    if law.scope == "global":
        if where:
            raise InputError(f"effect {law.name} acts on the whole arm; write it without @{where}")
        return [Term(law.name)]
    if not where:
        chosen: list[tuple[int, int | None]] = [(j, None) for j in range(len(joints))]
    else:
        name, _, partner = where.partition(":")
        other = _joint(partner, joints) if partner else None
        chosen = [(_joint(name, joints), other)]
    if law.scope == "joint":
        if any(other is not None for _, other in chosen):
            raise InputError(f"effect {law.name} has no partner joint; write {law.name}@JOINT")
        return [Term(law.name, j) for j, _ in chosen]
    if len(joints) < 2:
        raise InputError(f"effect {law.name} couples two joints, and this robot has {len(joints)}")
    pairs = [(j, (j + 1 if j + 1 < len(joints) else j - 1) if o is None else o) for j, o in chosen]
    for j, other in pairs:
        if j == other:
            raise InputError(f"effect {law.name}@{joints[j]} names itself as partner; name another")
    return [Term(law.name, j, o) for j, o in pairs]


def _joint(name: str, joints: tuple[str, ...]) -> int:
    if name not in joints:
        raise InputError(f"the robot has no joint {name!r}. {nearest(name, joints)}")
    return joints.index(name)


def parameter_bounds(terms: tuple[Term, ...], joints: tuple[str, ...]) -> tuple:
    """Bounds of all columns: the rigid ones free, the laws' as their tables say."""
    rigid = 10 * len(joints)
    lower, upper = [-np.inf] * rigid, [np.inf] * rigid
    for term in terms:
        table = term.law.linear
        free = len(term.columns(joints)) - len(table)
        lower += [p.lower for p in table] + [-np.inf] * free
        upper += [p.upper for p in table] + [np.inf] * free
    return np.array(lower), np.array(upper)
