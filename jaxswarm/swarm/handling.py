r"""How candidates that break constraints are compared: three parts of ``constrained``.

A part turns values f and constraints c of candidates into the single values that an optimizer compares.
With v = sum of max(c, 0) over inequalities c <= 0 and of max(|c| - tolerance, 0) over equalities c = 0:

    feasibility_rules      f where v = 0, else L (1 + v): any feasible candidate before any other, and
                           of two that are not the one that breaks less; L = 1e30 is above all f
    epsilon_level          the same with v <= epsilon for v = 0, and epsilon falling to zero, at most
                           epsilon_0 (1 - k / K)^power and 0.8 of the last candidates' median v
    augmented_lagrangian   f + sum of (max(0, lambda + rho c)^2 - lambda^2) / (2 rho) over inequalities
                           and of lambda c + rho c^2 / 2 over equalities;
                           lambda <- lambda + rho c at the best candidate, now and then, and rho grows
                           where that did not halve v

References:
    K. Deb, "An efficient constraint handling method for genetic algorithms", Comput. Methods Appl. Mech.
    Eng. 186 (2000), doi 10.1016/S0045-7825(99)00389-8; T. Takahama, S. Sakai, "Constrained optimization
    by the epsilon constrained differential evolution with gradient-based mutation and feasible elites",
    CEC 2006, doi 10.1109/CEC.2006.1688283; R. T. Rockafellar, "The multiplier method of Hestenes and
    Powell applied to convex programming", J. Optim. Theory Appl. 12 (1973); J. Nocedal, S. Wright,
    "Numerical optimization", 2006, framework 17.3 (the schedule of rho).
"""

from typing import Any

import jax
import jax.numpy as jnp

from jaxswarm.swarm.pytree import pytree, static
from jaxswarm.swarm.schedules import BY_HAND, coefficient, run_length
from jaxswarm.swarm.standing import INFEASIBLE

__all__ = ["augmented_lagrangian", "epsilon_level", "feasibility_rules", "feasible_first", "total"]

FIRST_LEVEL = 0.2
"""Share of the first candidates that the first epsilon lets pass (Takahama and Sakai)."""
FALLING = 0.8
"""Of the median violation of a step's candidates, what the next level is at most: more than half of them
fail it. By the schedule alone a population had collapsed in an infeasible corner, on CEC 2006's G06, long
before the level fell to that corner."""
ENOUGH = 0.5
"""Share to which a round of the multipliers has to bring the violation, or the penalty grows."""


def total(constraints: jax.Array, equalities: int, tolerance: Any) -> jax.Array:
    """Violation v (...,) of constraints (..., m), of which the last ``equalities`` are equalities."""
    split = constraints.shape[-1] - equalities
    broken = jnp.maximum(constraints[..., :split], 0.0)
    missed = jnp.maximum(jnp.abs(constraints[..., split:]) - tolerance, 0.0)
    return broken.sum(axis=-1) + missed.sum(axis=-1)


def feasible_first(value: jax.Array, violation: jax.Array) -> jax.Array:
    """One number that orders candidates by Deb's rules.

    >>> order = feasible_first(jnp.array([5.0, -3.0, 2.0]), jnp.array([0.0, 0.1, 0.2]))
    >>> jnp.argsort(order).tolist()
    [0, 1, 2]
    """
    return jnp.where(violation > 0.0, INFEASIBLE * (1.0 + violation), value)


def feasibility_rules() -> "FeasibilityRules":
    """Deb's rules: nothing to tune, and slow where the feasible set has no interior."""
    return FeasibilityRules()


def epsilon_level(
    num_steps: float | None = None, *, until: float = 0.5, power: float = 5.0
) -> "EpsilonLevel":
    """Let small violations pass at first; for equalities and narrow feasible sets.

    Args:
      num_steps: updates of the run; default as many as ``minimize`` makes.
      until: share of these after which nothing passes any more.
      power: how fast the level falls before.
    """
    until = coefficient("until", until, lower=0.01, upper=1.0)
    return EpsilonLevel(
        until, coefficient("power", power, lower=1.0), *run_length(num_steps, BY_HAND)
    )


def augmented_lagrangian(every: int = 10, *, growth: float = 4.0) -> "AugmentedLagrangian":
    """Multipliers that learn what a constraint costs: smooth, for active constraints of any kind.

    Args:
      every: updates between two changes of the multipliers.
      growth: factor of the penalty after a round that helped too little.
    """
    every = coefficient("every", every, lower=1.0)
    return AugmentedLagrangian(every, coefficient("growth", growth, lower=1.0))


@pytree
class FeasibilityRules:
    """See :func:`feasibility_rules`."""

    adapts: bool = static(default=False)

    def start(self, num_constraints, dtype):
        """Nothing to remember."""
        return ()

    def __call__(self, memory, value, constraints, equalities, violation):
        return feasible_first(value, violation)

    def adapt(self, memory, values, leader, equalities, violation, count):
        """Never changes."""
        return memory


@pytree
class EpsilonLevel:
    """See :func:`epsilon_level`; remembers epsilon, and the first one."""

    until: Any
    power: Any
    num_steps: Any
    of_run: bool = static(default=False)
    adapts: bool = static(default=True)

    def start(self, num_constraints, dtype):
        """Everything passes until the first candidates are seen."""
        return jnp.asarray(jnp.inf, dtype), jnp.asarray(jnp.inf, dtype)

    def __call__(self, memory, value, constraints, equalities, violation):
        return feasible_first(value, jnp.where(violation <= memory[0], 0.0, violation))

    def adapt(self, memory, values, leader, equalities, violation, count):
        """The level of the next update."""
        finite = jnp.where(jnp.isfinite(violation), violation, 0.0)
        first = jnp.where(count == 0, jnp.quantile(finite, FIRST_LEVEL), memory[1])
        left = jnp.clip(1.0 - (count + 1).astype(float) / (self.until * self.num_steps), 0.0, 1.0)
        level = first * left.astype(first.dtype) ** self.power
        level = jnp.minimum(jnp.minimum(level, memory[0]), FALLING * jnp.median(finite))
        return level.astype(first.dtype), first.astype(memory[1].dtype)


@pytree
class AugmentedLagrangian:
    """See :func:`augmented_lagrangian`; remembers multipliers (m,), penalty and last violation."""

    every: Any
    growth: Any
    adapts: bool = static(default=True)

    def start(self, num_constraints, dtype):
        """No multipliers; the penalty follows from the first candidates."""
        one = jnp.ones((), dtype)
        return jnp.zeros((num_constraints,), dtype), one, one * jnp.inf

    def __call__(self, memory, value, constraints, equalities, violation):
        (multipliers, penalty, _), split = memory, constraints.shape[-1] - equalities
        multipliers = jnp.expand_dims(multipliers, tuple(range(constraints.ndim - 1)))
        low, equal = multipliers[..., :split], multipliers[..., split:]
        pushed = jnp.maximum(0.0, low + penalty * constraints[..., :split])
        paid = (pushed**2 - low**2) / (2.0 * penalty)
        missed = constraints[..., split:]
        owed = equal * missed + 0.5 * penalty * missed**2
        return value + paid.sum(axis=-1) + owed.sum(axis=-1)

    def adapt(self, memory, values, leader, equalities, violation, count):
        """Change the multipliers at the best candidate when it is time."""
        multipliers, penalty, before = memory
        split = multipliers.shape[0] - equalities
        penalty = jnp.where(count == 0, _balance(values, split), penalty)
        moved = multipliers + penalty * leader[1:]
        moved = jnp.where(jnp.arange(moved.shape[0]) < split, jnp.maximum(moved, 0.0), moved)
        now = total(leader[1:], equalities, 0.0)
        due = ((count + 1) % jnp.asarray(self.every, jnp.int32) == 0) & jnp.isfinite(now)
        grown = jnp.where(now > ENOUGH * before, penalty * self.growth, penalty)
        grown = jnp.minimum(grown, INFEASIBLE**0.5).astype(penalty.dtype)
        return (
            jnp.where(due & jnp.isfinite(moved), moved, multipliers),
            jnp.where(due & (now > 0.0), grown, penalty),
            jnp.where(due, now, before),
        )


def _balance(values, split):
    """A penalty at which the first candidates' violations weigh as much as their values differ."""
    value, constraints = values[:, 0], values[:, 1:]
    broken = jnp.where(
        jnp.arange(constraints.shape[1]) < split, jnp.maximum(constraints, 0.0), constraints
    )
    finite = jnp.isfinite(value) & jnp.isfinite(constraints).all(axis=1)
    spread = jnp.nanmax(jnp.where(finite, value, jnp.nan)) - jnp.nanmin(
        jnp.where(finite, value, jnp.nan)
    )
    weight = jnp.nanmean(jnp.where(finite, jnp.sum(broken**2, axis=1), jnp.nan))
    ratio = spread / weight
    return jnp.where(jnp.isfinite(ratio) & (ratio > 0.0), ratio, 1.0).astype(values.dtype)
