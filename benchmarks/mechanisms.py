"""Mechanisms that no catalog holds and no grammar was written from: each is simulated as what it is.

A mechanism gives the torque that the motors have to supply, by its geometry and its springs, along a motion.
Forces that store energy are the slope of that energy, taken by differences, so that no closed form is copied.
What a law about such a mechanism has to be about is told beside it: its variables, and its parity under
reversal of the joint's velocity.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

# Step of the differences by which energies are turned into torques [rad].
_STEP = 1e-5


@dataclass(frozen=True)
class Mechanism:
    """A mechanism on a joint, or between a joint and a partner.

    Attributes:
        draw: ``draw(rng) -> parameters``; a place ``q0`` is a share of the half range of the joint's motion,
            counted from its middle: what a joint never comes near is no matter of its log.
        torque: ``torque(p, q, dq, q_other, dq_other) -> (T,)`` on the joint, of unit size.
        variables: Fields that a law about it is about.
        parity: ``odd`` or ``even`` under reversal of the joint's velocity.
        also_on_other: Torque of the partner by the same mechanism; None: it feels nothing.
        place_on_other: Whether ``q0`` is a place on the partner's way.
        known: Law of the catalog that is the same, under which name it is told right as well.
    """

    draw: Callable[[np.random.Generator], dict]
    torque: Callable[..., np.ndarray]
    variables: frozenset[str]
    parity: str
    also_on_other: Callable[..., np.ndarray] | None = None
    place_on_other: bool = False
    known: str | None = None


def stored(energy: Callable, place: int = 0) -> Callable:
    """The torque against a store ``energy(p, q, q_other)``, along the joint (0) or its partner (1)."""

    def torque(p, q, dq, q_other, dq_other):
        step = _STEP * (np.arange(2) == place)
        ahead = energy(p, q + step[0], q_other + step[1])
        behind = energy(p, q - step[0], q_other - step[1])
        return (ahead - behind) / (2.0 * _STEP)

    return torque


def _magnets(p, q, _):
    """Two dipoles on a lever that swings past a fixed one: narrow wells, once every pole."""
    angle = (q - p["q0"] + np.pi / p["poles"]) % (2 * np.pi / p["poles"]) - np.pi / p["poles"]
    far = p["gap"] ** 2 + np.sin(angle) ** 2
    return -1.0 / far**1.5


def _pulley(p, q, q_other):
    """An elastic cable from the second link, by a pulley on the base: slack when the link is near."""
    x = np.cos(q) + p["arm"] * np.cos(q + q_other) - p["x"]
    y = np.sin(q) + p["arm"] * np.sin(q + q_other) - p["y"]
    return 0.5 * np.maximum(np.hypot(x, y) - p["free"], 0.0) ** 2


def _four_bar(p, q, _):
    """A spring on the rocker of a four-bar linkage whose crank is the joint: balancer of a heavy arm."""
    px, py = p["crank"] * np.cos(q - p["q0"]), p["crank"] * np.sin(q - p["q0"])
    dx, dy = px - 1.0, py
    d = np.hypot(dx, dy)
    inner = (p["rocker"] ** 2 + d**2 - p["coupler"] ** 2) / (2 * p["rocker"] * d)
    rocker = np.arctan2(dy, dx) - np.arccos(inner)
    end = 1.0 + p["rocker"] * np.cos(rocker), p["rocker"] * np.sin(rocker)
    return 0.5 * (np.hypot(end[0] - p["x"], end[1] - p["y"]) - p["free"]) ** 2


def _belt(p, q, q_other):
    """A belt that stiffens as it stretches between the joint and its partner."""
    stretch = q - p["ratio"] * q_other
    return 0.5 * stretch**2 + 0.25 * (stretch / p["hard"]) ** 2 * stretch**2


def _dead_zone(p, q, _):
    beyond = np.maximum(np.abs(q - p["q0"]) - p["gap"], 0.0)
    return 0.5 * beyond**2


def _buffer(p, q, _):
    """A rubber buffer that the joint runs into from one side."""
    return np.maximum(p["side"] * (q - p["q0"]), 0.0) ** 2.5


def _sinking(p, q, dq, *_):
    """Drag of a polynomial odd in the velocity."""
    return dq**3 - p["fifth"] * dq**5


def _seal(p, q, dq, *_):
    """Viscous drag of a grease that gathers towards one side."""
    return (1.0 + p["part"] * np.sin(p["order"] * q + p["phase"])) * dq


def _eddy(p, q, dq, *_):
    """An eddy-current brake: strongest at its critical speed."""
    return dq / (1.0 + (dq / p["speed"]) ** 2)


def _clutch(p, q, dq, *_):
    """A centrifugal brake whose shoes engage beyond a speed."""
    return np.maximum(np.abs(dq) - p["speed"], 0.0) * np.sign(dq)


def _rub(p, q, dq, q_other, dq_other):
    """A hose pressed against the joint as its partner bends it."""
    return np.maximum(np.sin(q_other - p["q0"]), 0.0) * np.tanh(dq / 0.01)


def _fan(p, q, dq, q_other, dq_other):
    """A drag by what two joints do together."""
    return dq * np.abs(dq_other)


_ALONE, _BOTH = frozenset({"q"}), frozenset({"q", "q_other"})
_VELOCITY, _MOVING = frozenset({"dq"}), frozenset({"q", "dq"})
MECHANISMS = {
    "magnets": Mechanism(
        lambda r: {
            "q0": r.uniform(-0.6, 0.6),
            "poles": r.integers(2, 5),
            "gap": r.uniform(0.15, 0.4),
        },
        stored(_magnets),
        _ALONE,
        "even",
    ),
    "cable over a pulley": Mechanism(
        lambda r: {
            "arm": r.uniform(0.5, 1.0),
            "x": r.uniform(-1, 0),
            "y": r.uniform(-1, 1),
            "free": r.uniform(0.6, 1.2),
        },
        stored(_pulley),
        _BOTH,
        "even",
        stored(_pulley, 1),
    ),
    "four-bar balancer": Mechanism(
        lambda r: {
            "q0": r.uniform(-np.pi, np.pi),
            "crank": r.uniform(0.2, 0.35),
            "rocker": r.uniform(0.6, 0.8),
            "coupler": r.uniform(0.9, 1.1),
            "x": r.uniform(0.0, 1.0),
            "y": -1.2,
            "free": 0.3,
        },
        stored(_four_bar),
        _ALONE,
        "even",
    ),
    "stiffening belt": Mechanism(
        lambda r: {"ratio": r.uniform(0.5, 1.5), "hard": r.uniform(0.2, 0.6)},
        stored(_belt),
        _BOTH,
        "even",
        stored(_belt, 1),
    ),
    "spring with a dead zone": Mechanism(
        lambda r: {"q0": r.uniform(-0.4, 0.4), "gap": r.uniform(0.2, 0.5)},
        stored(_dead_zone),
        _ALONE,
        "even",
        known="dead_zone_spring",
    ),
    "buffer": Mechanism(
        lambda r: {"q0": r.uniform(-0.4, 0.4), "side": r.choice([-1, 1])},
        stored(_buffer),
        _ALONE,
        "even",
    ),
    "odd polynomial": Mechanism(
        lambda r: {"fifth": r.uniform(0.05, 0.15)}, _sinking, _VELOCITY, "odd"
    ),
    "grease to one side": Mechanism(
        lambda r: {
            "part": r.uniform(0.5, 1.0),
            "order": r.uniform(1, 3),
            "phase": r.uniform(0, 2 * np.pi),
        },
        _seal,
        _MOVING,
        "odd",
    ),
    "eddy brake": Mechanism(lambda r: {"speed": r.uniform(0.2, 0.6)}, _eddy, _VELOCITY, "odd"),
    "centrifugal brake": Mechanism(
        lambda r: {"speed": r.uniform(0.5, 1.0)}, _clutch, _VELOCITY, "odd"
    ),
    "pressed hose": Mechanism(
        lambda r: {"q0": r.uniform(-0.5, 0.5)},
        _rub,
        frozenset({"q_other", "dq"}),
        "odd",
        place_on_other=True,
    ),
    "drag of two": Mechanism(lambda r: {}, _fan, frozenset({"dq", "dq_other"}), "odd"),
}
