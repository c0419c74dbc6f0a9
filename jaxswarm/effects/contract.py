"""The contract of an effect, as code: run it on your own law before you register it.

Regression, search, report and simulation rely on a few properties of every kind of effect; each is checked
here on drawn motion and parameters, with a sentence for what does not hold. All of ours pass it.
"""

import re
from functools import partial, singledispatch

import jax
import jax.numpy as jnp
import numpy as np

from jaxswarm.effects.base import Effect
from jaxswarm.effects.distortion import distortion_columns
from jaxswarm.effects.draws import draw_parameters, draw_series
from jaxswarm.effects.kinds import (
    BodyChange,
    ExternalTorque,
    MeasurementLaw,
    TorqueLaw,
    TransmissionLaw,
)
from jaxswarm.effects.misreading import misreading
from jaxswarm.effects.series import law_columns, law_torque, remembered, states

__all__ = ["check_effect", "check_unit", "draw_parameters", "draw_series"]

_UNITS = {"1", "N", "m", "s", "rad", "kg", "K", "A", "V", "W", "Hz"}


def check_effect(law: Effect, *, num_draws: int = 8, seed: int = 0) -> None:
    """Raise ``AssertionError``, saying what is wrong, unless ``law`` keeps the contract.

    Checked: the table (names, units, bounds, scales), and what its kind promises. Of a
    :class:`TorqueLaw` that it is one finite number per sample with finite derivatives, at rest too; that
    it maps over samples; that it is zero where all linear parameters are, and
    ``columns @ linear == torque``; that a law called dissipative never drives; that memory does not
    depend on linear parameters and stays finite. Of a :class:`MeasurementLaw` and a :class:`BodyChange`
    that neutral parameters change nothing, and that they are linear in the torque and in the body. Of a
    :class:`TransmissionLaw` that every point of its lattice is a gear that holds; of an
    :class:`ExternalTorque` that its course is finite.

    Args:
        law: Registered or not.
        num_draws: Drawn sets of parameters.
        seed: Of the drawn motion and parameters.

    >>> from jaxswarm.effects import get_law
    >>> check_effect(get_law("stribeck_friction"))
    """
    law.check()
    for p in law.parameters:
        check_unit(p.unit, [other.name for other in law.parameters])
    check_kind(law, np.random.default_rng(seed), num_draws)


@singledispatch
def check_kind(law: Effect, rng: np.random.Generator, num_draws: int) -> None:
    """Check what an effect's kind promises."""
    raise NotImplementedError(f"no contract for effects of kind {type(law).__name__}")


@check_kind.register
def _(law: TorqueLaw, rng, num_draws):
    _require(bool(law.linear), law, "has no linear parameter: nothing says how large it is")
    series = draw_series(rng)
    series = series._replace(state=remembered(law, series.state))
    torque = jax.jit(partial(law_torque, law))
    columns = jax.jit(partial(law_columns, law))
    for draw in range(num_draws):
        values = law.nominal() if draw == 0 else draw_parameters(law, rng)
        along = torque(values, series)
        _require(along.shape == series.t.shape, law, "does not give one torque per sample")
        _require(bool(jnp.isfinite(along).all()), law, f"has no finite torque with {values}")
        _check_linear(law, torque, columns, values, series)
        if law.dissipative:
            power = along * series.dq
            slack = 1e-12 * float(jnp.abs(power).max())
            _require(bool((power >= -slack).all()), law, f"drives instead of braking at {values}")
    _check_gradients(law, law.nominal(), series)
    if law.begins is not None:
        later = {**draw_parameters(law, rng), law.begins: float(series.t[-1]) + 1.0}
        _require(not np.any(torque(later, series)), law, "acts before it begins")
    if law.rate is not None:
        _check_memory(law, rng, series)


@check_kind.register
def _(law: MeasurementLaw, rng, num_draws):
    one, two = rng.normal(size=(2, 64, 2 if law.crosses else 3))
    own = one[:, 0] if law.crosses else one
    same = np.allclose(law.report(law.neutral(), one, 0.01), own, rtol=0, atol=1e-12)
    _require(same, law, "changes the torque where its parameters are neutral")
    if law.excess is not None:
        moved = misreading(law, law.neutral(), tuple(rng.normal(size=(3, 8, 2))))
        _require(not np.any(moved), law, "moves a position where its parameters are neutral")
    if law.distortion is not None:
        _check_distortion(law, rng)
    for _ in range(num_draws):
        values = draw_parameters(law, rng)
        apart = law.report(values, one, 0.01) + 2.0 * law.report(values, two, 0.01)
        linear = np.allclose(law.report(values, one + 2.0 * two, 0.01), apart, atol=1e-9)
        _require(linear, law, "is not linear in the torque")
        if law.alike:
            every, alone = (law.report(values, x, 0.01) for x in (one, one[:, 1]))
            same = np.allclose(alone, every[:, 1], atol=1e-9)
            _require(same, law, "writes down a torque by another one")


@check_kind.register
def _(law: BodyChange, rng, num_draws):
    if law.gravity is not None:
        level = jnp.array([0.0, 0.0, -9.81])
        same = np.allclose(law.gravity(law.neutral(), level), level)
        _require(same, law, "changes gravity where its parameters are neutral")
        return
    if law.placement is not None:
        still = np.asarray(law.placement(law.neutral()))
        _require(still.shape == (2, 2) and not still.any(), law, "moves a joint by nothing")
        return
    if law.compliance is not None:
        firm = np.asarray(law.compliance({p.name: 0.0 for p in law.linear}))
        _require(firm.shape == (2,) and not firm.any(), law, "gives way by nothing")
        return
    if law.window:
        along = np.asarray(law.weight({"start": 0.5, "end": 1.5}, jnp.linspace(0.0, 2.0, 64)))
        _require(along[0] == along[-1] == 0.0 and along.max() == 1.0, law, "has no window")
    assert law.body is not None  # one of the four, as its check sees to
    nothing = np.asarray(law.body(law.neutral()))
    _require(
        nothing.shape == (10,) and not nothing.any(), law, "is no body of ten zeros if neutral"
    )
    one, two = draw_parameters(law, rng), draw_parameters(law, rng)
    both = law.body({name: one[name] + two[name] for name in one})
    linear = np.allclose(both, law.body(one) + law.body(two))
    _require(linear, law, "is not linear in its parameters")


@check_kind.register
def _(law: TransmissionLaw, rng, num_draws):
    inertia = jnp.full(4, 0.5)
    if law.around is not None:
        tried = law.around(0.5, 1e4, 0.01)
    else:
        assert law.lattice is not None  # its check sees to that
        tried = law.lattice(0.5)
    for values in (law.nominal(), *tried):
        known = {p.name for p in law.parameters}
        _require(
            set(values) == known, law, f"has a lattice of {sorted(values)}, not {sorted(known)}"
        )
        gear = law.gear(values, inertia)
        holds = all(bool(np.isfinite(x).all() and np.all(x >= 0)) for x in gear)
        holds = holds and bool(np.all(gear[0] > 0))
        told = "stiffness, damping, gap and hardening are " + ", ".join(map(str, gear))
        _require(holds, law, f"is no gear at {values}: {told}")


@check_kind.register
def _(law: ExternalTorque, rng, num_draws):
    along = law.weight({"start": 0.5, "end": 1.5}, np.linspace(0.0, 2.0, 64))
    _require(along.shape == (64,), law, "does not give one number per sample")
    finite = bool(np.isfinite(along).all()) and bool(np.any(along != 0.0))
    _require(finite, law, "has a course that is zero everywhere or not finite")


def check_unit(unit: str, names: list[str] | None = None) -> None:
    """Raise ``AssertionError`` unless a unit is made of SI symbols, ``/``, ``^`` and parentheses.

    Args:
        unit: Such as ``"N m s/rad"``.
        names: Parameters that may stand in an exponent.

    >>> check_unit("N m (s/rad)^alpha", ["c", "alpha"])
    """
    exponents = re.findall(r"\^(\w+)", unit)
    bad = [e for e in exponents if not e.isdigit() and e not in (names or [])]
    plain = re.sub(r"\^\w+", "", unit)
    words = re.findall(r"\w+", plain)
    bad += [w for w in words if w not in _UNITS]
    rest = re.sub(r"[\w ()/]", "", plain)
    depth = 0
    for mark in plain:
        depth += {"(": 1, ")": -1}.get(mark, 0)
        bad += ["parentheses"] if depth < 0 else []
    outer = re.sub(r"\([^()]*\)", "", plain)
    if bad or rest or depth or not words or outer.count("/") > 1:
        raise AssertionError(f"unit {unit!r} cannot be read: {bad or rest or 'form'}")


def _check_distortion(law, rng):
    torque = np.concatenate([[0.0], rng.normal(0.0, 20.0, 63)])
    values = draw_parameters(law, rng)
    off = np.asarray(law.distortion({**values, **{p.name: 0.0 for p in law.linear}}, torque))
    _require(not off.any(), law, "distorts a torque where all its linear parameters are zero")
    along = np.asarray(law.distortion(values, torque))
    weights = np.array([values[p.name] for p in law.linear])
    same = np.allclose(distortion_columns(law, values, torque) @ weights, along)
    _require(same, law, "is not linear in its linear parameters")


def _check_linear(law, torque, columns, values, series):
    nonlinear = {p.name: values[p.name] for p in law.nonlinear}
    weights = jnp.array([values[p.name] for p in law.linear])
    along = torque(values, series)
    scale = 1e-9 * (1.0 + float(jnp.abs(along).max()))
    off = torque({**values, **{p.name: 0.0 for p in law.linear}}, series)
    _require(
        bool((off == 0.0).all()), law, "leaves a torque where all its linear parameters are zero"
    )
    rebuilt = columns(nonlinear, series) @ weights
    _require(
        bool((jnp.abs(rebuilt - along) <= scale).all()),
        law,
        "is not linear in its linear parameters",
    )


def _check_gradients(law, values, series):
    def one(p, s):
        return law.torque(p, s)

    rest = jax.tree.map(lambda x: jnp.zeros(3, x.dtype), series)
    for sample, where in ((rest, "at rest"), (series, "moving")):
        for argument in (0, 1):
            slope = jax.vmap(jax.grad(one, argument), in_axes=(None, 0))(
                {k: jnp.asarray(v, sample.t.dtype) for k, v in values.items()}, sample
            )
            finite = all(bool(jnp.isfinite(leaf).all()) for leaf in jax.tree.leaves(slope))
            _require(finite, law, f"has no finite derivative {where}")


def _check_memory(law, rng, series):
    values = draw_parameters(law, rng)
    path = jnp.stack(jax.tree.leaves(states(law, values, series)))
    _require(len(path) == law.memories, law, f"has {len(path)} memories, not {law.memories}")
    _require(bool(jnp.isfinite(path).all()), law, "has a memory that does not stay finite")
    other = {**values, **{p.name: values[p.name] + 1.0 for p in law.linear}}
    again = jnp.stack(jax.tree.leaves(states(law, other, series)))
    same = bool((path == again).all())
    _require(same, law, "has a memory that depends on its linear parameters")


def _require(holds: bool, law: Effect, message: str) -> None:
    if not holds:
        raise AssertionError(f"effect {law.name!r} {message}")
