"""Which effect stands for what a robot file says of a joint beside its links."""

from collections.abc import Iterable

from jaxswarm.effects.base import REGISTRY

# What MJCF calls a joint's attributes, as elements of SDF: of its dynamics, or Drake's own beside them.
SDF_DYNAMICS = {
    "damping": "damping",
    "frictionloss": "friction",
    "stiffness": "spring_stiffness",
    "springref": "spring_reference",
}
SDF_OF_DRAKE = {"armature": "drake:rotor_inertia"}


def with_effects(notes: Iterable[str], format: str = "mjcf") -> list[str]:
    """Notes on a robot file, with the effect to declare where one holds what was left out.

    >>> with_effects(["damping is not part of the links (pan 2)", "2 tendons are not modeled"])
    ['damping is not part of the links (pan 2): declare viscous_friction', '2 tendons are not modeled']
    """
    known = {
        attribute: effect.name
        for effect in REGISTRY.values()
        for held in effect.export
        if held.format == format
        for attribute in held.attributes(effect.nominal())
    }
    told = ((note, known.get(note.partition(" is not part of the links")[0])) for note in notes)
    return [note if name is None else f"{note}: declare {name}" for note, name in told]
