r"""What an effect is: a table of its parameters, what is known of it, and the registry that knows them all.

A rigid body does not account for everything a motor must supply. Each further cause is an
:class:`Effect`: a named table of :class:`Parameter` (units, bounds, which ones enter linearly) with facts
that every command reads. Where in the measuring chain it acts is its class, one of the five in
:mod:`jaxswarm.effects.kinds`. Everything else follows from these: columns of a regression, the search box
of nonlinear parameters, units in the report, the name on the command line.

Registering an effect with :func:`register` makes it known everywhere.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from jaxswarm.effects.parameter import Parameter, refuse_unknown
from jaxswarm.errors import InputError, nearest

SCOPES = ("joint", "pair", "global")
# What the picture of an effect can have as its horizontal axis.
AXES = (
    *("position", "velocity", "acceleration", "time", "partner position", "partner velocity"),
    *("load", "model torque", "partner torque", "torque rate"),
)


def _none_below_zero(p: Mapping) -> bool:
    return all(value >= 0.0 for value in p.values())


class Export(NamedTuple):
    """How a file format for robots holds an effect.

    Attributes:
        format: ``"urdf"`` or ``"mjcf"``.
        attributes: Attributes of the joint's element from the parameter values.
        adds: Whether several on one joint add up.
        holds: Whether the format can hold these values.
    """

    format: str
    attributes: Callable[[Mapping], dict]
    adds: bool = True
    holds: Callable[[Mapping], bool] = _none_below_zero


@dataclass(frozen=True)
class Effect:
    """A physical cause of torque beside the rigid body; its class says where it acts.

    Attributes:
        name: Name in reports, logs of changes and on the command line.
        scope: ``"joint"``, ``"pair"`` (a joint and a partner joint) or ``"global"``.
        parameters: The table; linear ones first.
        summary: The effect in one line, with its formula.
        reference: Where it comes from.
        meaning: What it means on a real arm and what to do about it, in one sentence or two.
        contains: Names of effects of the same joint that it makes redundant.
        replaces: Names of effects of the same joint that it is fitted without where the fit with them comes
            to values that cannot be.
        extends: Names of effects of the same place beside one of which alone it is asked: what it adds to that
            one has to be worth as much as any other effect.
        exclusive_with: Names of effects that cannot act on the same joint beside it.
        requires: Channels that a log must have, such as ``"temperature"``.
        rests: Time [s] that its joint has to stand still between motions for it to show.
        min_joints: Least number of joints at which it can be told from the rigid parameters.
        turning: Whether only a joint that turns can have it.
        carried: Whether only a joint on another link can have it.
        everyday: Whether every drive has it: missing on several joints, it is added to all at once.
        begins: Parameter that says when in a log it begins, for good: other logs may be of before, or of after.
        recurring: Whether it is an event of one log with a begin and an end, of which there may be several.
        several: Whether a joint may have several of it at once, told apart by ``identity``.
        mutual: Whether what a pair does to the partner is a second term of it, asked as soon as one is found.
        reference_only: Whether no fit to whole logs can hold it: it is of a part, or against an earlier model.
        shown_against: Horizontal axis of its picture, one of :data:`AXES`.
        grid_size: Points of the first look at its nonlinear parameters; None: the usual number.
        probe: Values to which the slope of a candidate is drawn, for parameters whose derivative at
            neutral is that of another effect; the refit has to tell them from neutral.
        stepwise: Whether the torque has small steps along its nonlinear parameters.
        export: How file formats for robots hold it.
        identity: Parameters by which two terms in one place are told apart, once they are known.
        uses_direction: Whether its torque depends on the smooth sign of a velocity.
        uses_load: Whether it depends on the rigid torque, whose parameters are being fitted.
        derived: ``derived(p) -> {name: (value, unit)}``: other usual ways to state the parameters.
        way: ``way(p)``: which way it went, in a word or two beside its name; None: its name says it.
    """

    name: str
    scope: str
    parameters: tuple[Parameter, ...]
    summary: str
    reference: str
    meaning: str = ""
    contains: tuple[str, ...] = ()
    replaces: tuple[str, ...] = ()
    extends: tuple[str, ...] = ()
    exclusive_with: tuple[str, ...] = ()
    requires: tuple[str, ...] = ()
    rests: float = 0.0
    min_joints: int = 1
    turning: bool = False
    carried: bool = False
    everyday: bool = False
    begins: str | None = None
    recurring: bool = False
    several: bool = False
    mutual: bool = False
    reference_only: bool = False
    shown_against: str = "velocity"
    grid_size: int | None = None
    probe: Mapping[str, float] = field(default_factory=dict, hash=False)
    stepwise: bool = False
    export: tuple[Export, ...] = ()
    identity: tuple[str, ...] = ()
    uses_direction: bool = False
    uses_load: bool = False
    derived: Callable[[dict], dict] | None = None
    way: Callable[[Mapping], str] | None = None

    @property
    def linear(self) -> tuple[Parameter, ...]:
        """The parameters in which the torque is linear."""
        return tuple(p for p in self.parameters if p.linear)

    @property
    def nonlinear(self) -> tuple[Parameter, ...]:
        """The parameters that have to be searched."""
        return tuple(p for p in self.parameters if not p.linear)

    @property
    def searched(self) -> bool:
        """Whether a candidate's nonlinear parameters are found by the compiled searches."""
        return False

    @property
    def positive(self) -> bool:
        """Whether physics wants the coefficient of a candidate's single column positive."""
        return len(self.linear) == 1 and self.linear[0].lower >= 0

    @property
    def in_one_log(self) -> bool:
        """Whether it happened in one log, told by its number, and is nothing of the robot's."""
        return any(p.name == "log" for p in self.parameters)

    @property
    def changes_rigid_columns(self) -> bool:
        """Whether the rigid-body columns of a model differ with it."""
        return False

    @property
    def shows_on_own_joint(self) -> bool:
        """Whether an effect of a joint is to be seen in the torque of that joint."""
        return True

    def nominal(self) -> dict[str, float]:
        """Return the usual value of every parameter."""
        return {p.name: p.nominal for p in self.parameters}

    def neutral(self) -> dict[str, float]:
        """Return the values at which the effect does nothing: zero of what its torque is linear in."""
        return {p.name: p.off for p in self.parameters}

    def free(self, values: Mapping[str, float]) -> tuple[Parameter, ...]:
        """The nonlinear parameters that a fit moves from these values."""
        return tuple(p for p in self.nonlinear if p.fitted and not values.get(p.hidden_by))

    def silent(self, values: Mapping[str, float]) -> tuple[str, ...]:
        """Names of parameters that do nothing at these values: a report tells of the others."""
        return ()

    def linear_names(self, joints: tuple[str, ...]) -> list[str]:
        """Names of the values that the columns of a model multiply, in their order."""
        return [p.name for p in self.linear]

    def candidate_names(self, joints: tuple[str, ...]) -> list[str]:
        """Names of the values that a candidate's first columns give, as changes from neutral."""
        return self.linear_names(joints)

    def excludes(self, other: "Effect") -> bool:
        """Whether the two cannot act on one joint together."""
        return other.name in self.exclusive_with or self.name in other.exclusive_with

    def credible(self, change: float, interval: float, doubt: float) -> bool:
        """Whether a candidate's coefficient can be a matter of the robot.

        Args:
            change: The coefficient.
            interval: Of the log's samples [s].
            doubt: What the coefficient may be off by.
        """
        return True

    def check(self) -> None:
        """Refuse a declaration that contradicts itself.

        Raises:
            ValueError: If the scope or the axis of the picture is unknown, a parameter contradicts itself,
                linear parameters do not come first, or it refers to one that it does not have.
        """
        if self.scope not in SCOPES:
            raise ValueError(f"scope of {self.name!r} is {self.scope!r}; use one of {SCOPES}")
        if self.shown_against not in AXES:
            raise ValueError(
                f"effect {self.name!r} is shown against {self.shown_against!r}; use one of {AXES}"
            )
        flags = [p.linear for p in self.parameters]
        if flags != sorted(flags, reverse=True):
            raise ValueError(f"effect {self.name!r}: list its linear parameters first")
        names = [p.name for p in self.parameters]
        for p in self.parameters:
            p.check(self.name, names)
        refuse_unknown(self.name, names, self.begins, *self.probe, *self.identity)


REGISTRY: dict[str, Effect] = {}


def register(effect: Effect) -> Effect:
    """Make ``effect`` known to every part of jaxswarm under its name, and return it.

    Raises:
        ValueError: If the name is taken or the declaration contradicts itself.
    """
    if effect.name in REGISTRY:
        raise ValueError(
            f"an effect named {effect.name!r} is registered already; choose another name"
        )
    effect.check()
    REGISTRY[effect.name] = effect
    return effect


def get_law(name: str) -> Effect:
    """Return the registered effect called ``name``.

    Raises:
        InputError: If there is none, with the nearest names.

    >>> get_law("viscous_friction").scope
    'joint'
    """
    if (law := REGISTRY.get(name)) is None:
        raise InputError(f"unknown effect {name!r}. {nearest(name, REGISTRY)}")
    return law
