"""What an undeclared effect and its law are; the laws stand in :mod:`laws` and :mod:`outside`."""

from collections.abc import Callable
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Effect:
    """One undeclared effect: its kind, where it acts (index or None), and its parameters."""

    kind: str
    joint: int | None = None
    other: int | None = None
    params: dict = field(default_factory=dict, compare=False)


@dataclass(frozen=True)
class Law:
    """How a kind acts on its joint, and what is drawn for it.

    Attributes:
        torque: ``(params, S, joint, other) -> (dry, rest)``; None where the effect is no torque.
        draw: ``(rng, slide) -> params`` with amplitudes of one.
        scaled: Names of the amplitudes.
        outside: Not in the catalog.
        pair: Acts on one joint by the motion of another.
        resists: Takes from the dry friction of its joint, which must stay positive.
        memory: ``(params, state, dq, h) -> state`` a step later; None: it has none.
    """

    torque: Callable | None
    draw: Callable
    scaled: tuple[str, ...] = ()
    outside: bool = False
    pair: bool = False
    resists: bool = False
    memory: Callable | None = None
