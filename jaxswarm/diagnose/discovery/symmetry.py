"""What the form of a formula says: conservative, dissipative, odd in the velocity, or none of these."""

from typing import NamedTuple

import numpy as np

from jaxswarm.diagnose.discovery.problem import Joint
from jaxswarm.diagnose.discovery.sums import Sum, free_columns, linear
from jaxswarm.effects.postfix import Program, evaluate, fields_of

# Share of the moving samples that may be driven by the width of the sign.
_SLIGHT = 0.01
# Relative size below which two torques are the same, and share of the top speed that is rest.
_SAME, _REST = 1e-6, 0.05
_MOVING = ("dq", "direction")
_OWN_MOTION, _LOADS = {"q", "dq", "direction", "ddq"}, {"load", "static_load"}
POTENTIAL, FRICTION = "potential force", "friction"


class Symmetry(NamedTuple):
    """The form of a formula.

    Attributes:
        kinds: Of every term ``potential force``, ``friction``, ``inertial``, ``coupling``, ``changing with
            time``, ``changing with the temperature`` or ``mixed``, each once.
        parity: ``odd``, ``even`` or ``neither``: under reversal of the joint's velocity.
        driving: Share of the moving samples in which the terms called friction drive the joint instead of
            braking it; None where there are none.
        known: Whether physics knows such a form: each term has a potential, or a parity.
    """

    kinds: tuple[str, ...]
    parity: str
    driving: float | None
    known: bool

    @property
    def text(self) -> str:
        """The form in one sentence."""
        if self.kinds == (POTENTIAL,):
            return (
                "a function of the position alone: it has a potential, stores energy and returns it"
            )
        parity = "neither odd nor even" if self.parity == "neither" else self.parity
        told = f"{' and '.join(self.kinds)}, {parity} in the velocity"
        if self.driving is None:
            return told
        if self.driving <= _SLIGHT:
            return f"{told}; it never drives on this motion: it dissipates"
        return (
            f"{told}; by itself it drives in {100 * self.driving:.0f} % of the moving samples: it can "
            "only be friction together with what brakes beside it"
        )


def symmetry_of(problem: Joint, formula: Sum) -> Symmetry:
    """Reverse the joint's velocity on all rows and see what the formula does."""
    fold = problem.lin.crossfit.whole
    a = linear(problem, formula, fold, free_columns(problem, formula, fold))
    terms = [c * _along(problem, formula, p) for c, p in zip(a, formula.programs, strict=True)]
    turned = {n: -problem.data[n] for n in _MOVING if n in problem.data}
    others = [
        c * _along(problem, formula, p, turned) for c, p in zip(a, formula.programs, strict=True)
    ]
    parities = [_parity(one, two) for one, two in zip(terms, others, strict=True)]
    kinds = [_kind(p, parity) for p, parity in zip(formula.programs, parities, strict=True)]
    braking = [x for x, kind in zip(terms, kinds, strict=True) if kind == FRICTION]
    known = all(
        kind == POTENTIAL or (kind != "mixed" and parity != "neither")
        for kind, parity in zip(kinds, parities, strict=True)
    )
    return Symmetry(
        tuple(dict.fromkeys(kinds)),
        _parity(sum(terms), sum(others)),
        _driving(sum(braking), problem.data["dq"]) if braking else None,
        known,
    )


def _along(problem: Joint, formula: Sum, program: Program, changed=()) -> np.ndarray:
    known = {**problem.data, **formula.values, **dict(changed)}
    return evaluate(program, known, np) + np.zeros(len(problem.rows))


def _parity(here: np.ndarray, there: np.ndarray) -> str:
    """How a torque goes over into that of the reversed velocity."""
    size = _SAME * np.linalg.norm(here)
    if np.linalg.norm(there + here) <= size:
        return "odd"
    return "even" if np.linalg.norm(there - here) <= size else "neither"


def _kind(program: Program, parity: str) -> str:
    fields = set(fields_of(program))
    if "t" in fields:
        return "changing with time"
    if "temperature" in fields:
        return "changing with the temperature"
    if fields == {"q"}:
        return POTENTIAL
    if parity == "odd" and not fields & {"ddq", "ddq_other"}:
        return FRICTION
    # A load presses where something rubs, or is a gain; with a position alone it is no law of a mechanism.
    if fields & _LOADS and "q" in fields:
        return "mixed"
    if fields - _OWN_MOTION:
        return "coupling"
    return "inertial" if "ddq" in fields else "mixed"


def _driving(torque: np.ndarray, dq: np.ndarray) -> float:
    """Share of the moving samples in which a torque that the motor has to supply is negative power."""
    power = (torque * dq)[np.abs(dq) > _REST * np.abs(dq).max()]
    return float((power < -1e-9 * np.abs(power).max()).mean())
