r"""Another gravity, another body: what changes the rigid-body model itself.

References: W. Khalil, E. Dombre (2002), ch. 9; W. Khalil, M. Gautier, P. Lemoine, ICRA 2007 (payload).
"""

import jax.numpy as jnp

from jaxswarm.effects.base import register
from jaxswarm.effects.kinds import BodyChange
from jaxswarm.effects.parameter import Parameter


def _tilted(p, gravity):
    """Gravity with components along base x and y, its magnitude and the sign along z kept."""
    across = jnp.stack([jnp.asarray(p["gx"], float), jnp.asarray(p["gy"], float)])
    rest = jnp.sum(gravity**2) - jnp.sum(across**2)
    # A root has no derivative at zero: keep it away from there.
    down = jnp.where(rest > 0.0, jnp.sqrt(jnp.where(rest > 0.0, rest, 1.0)), 0.0)
    return jnp.concatenate([across, (jnp.sign(gravity[2]) * down)[None]])


BASE_TILT = register(
    BodyChange(
        name="base_tilt",
        scope="global",
        parameters=(
            Parameter("gx", "m/s^2", -3.0, 3.0, False, 0.0, "gravity along the base x axis"),
            Parameter("gy", "m/s^2", -3.0, 3.0, False, 0.0, "gravity along the base y axis"),
        ),
        summary="gravity has components along base x and y, same magnitude",
        reference="Khalil, Dombre 2002, ch. 9",
        meaning=(
            "The base does not stand level, or the controller believes another mounting; measure "
            "it with a level, or set the direction of gravity."
        ),
        gravity=_tilted,
        shown_against="position",
    )
)


def with_free_base(effects: str) -> str:
    """A list of effects with the tilt of the base in it.

    >>> with_free_base("none"), with_free_base("viscous_friction")
    ('base_tilt', 'viscous_friction,base_tilt')
    """
    names = [item.strip() for item in effects.split(",")]
    if BASE_TILT.name in names:
        return effects
    return ",".join([*(name for name in names if name not in ("", "none")), BASE_TILT.name])


_MOMENT = "kg m"
_INERTIA = "kg m^2"


def body_table(linear: bool = False) -> tuple[Parameter, ...]:
    """The ten inertial parameters of a body on the last link; one taken off has a mass below zero."""
    return (
        Parameter("m", "kg", -1e3, 1e3, linear, 1.0, "mass", neutral=0.0),
        *(
            Parameter(f"mc{a}", _MOMENT, -1e3, 1e3, linear, 0.0, f"first moment along {a}")
            for a in "xyz"
        ),
        *(
            Parameter(
                f"I{a}", _INERTIA, -1e3, 1e3, linear, 0.0, f"inertia {a} about the last joint"
            )
            for a in ("xx", "xy", "yy", "xz", "yz", "zz")
        ),
    )


def body_of(p) -> jnp.ndarray:
    """The ten inertial parameters in their standard order, (10,)."""
    return jnp.stack([jnp.asarray(p[one.name], float) for one in _PAYLOAD])


_PAYLOAD = body_table()

register(
    BodyChange(
        name="payload",
        scope="global",
        parameters=_PAYLOAD,
        summary="ten inertial parameters added to the last link, or taken off it, against an earlier model",
        reference="Khalil, Gautier, Lemoine 2007, ICRA",
        meaning=(
            "The last link carries another body than before (a mass below zero: one was taken off): a "
            "tool, a work piece, or a wrong payload setting of the controller; compare the mass with "
            "what is mounted."
        ),
        body=body_of,
        reference_only=True,
        # Adding zero leaves no zero with a sign.
        derived=lambda p: (
            {f"c{a}": (p[f"mc{a}"] / p["m"] + 0.0, "m") for a in "xyz"} if p["m"] else {}
        ),
        way=lambda p: "taken off" if p["m"] < 0.0 else "put on",
        shown_against="position",
    )
)
