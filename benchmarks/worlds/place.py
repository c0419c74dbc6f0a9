"""Where the effects of a plan act, and which friction and rotors its arm keeps as declared ones."""

from dataclasses import replace

import numpy as np

from benchmarks.worlds.arm import Arm
from benchmarks.worlds.families import joint_scales
from benchmarks.worlds.laws import GLOBAL, LAWS, Effect
from benchmarks.worlds.plan import Plan


def allowed_friction(arm: Arm, wanted: Plan) -> Arm:
    """The arm with the rotors and the friction that the declared list allows for."""
    zero = np.zeros(arm.size)
    if wanted.declared != "friction and rotors":
        arm = replace(arm, rotor=zero)
    if wanted.declared == "nothing" and not wanted.common:
        arm = replace(arm, viscous=zero, coulomb=zero)
    return arm


def place_effects(rng, arm: Arm, wanted: Plan):
    """Arm without the friction that becomes an effect; declared terms; effects with unit amplitudes."""
    n = arm.size
    declared = []
    if wanted.declared != "nothing":
        declared = [(e, j) for e in ("viscous_friction", "coulomb_friction") for j in range(n)]
    if wanted.declared == "friction and rotors":
        declared += [("rotor_inertia", j) for j in range(n)]
    effects = []
    if wanted.common:
        for j in range(n):
            effects.append(Effect("viscous_friction", j, params={"b": float(arm.viscous[j])}))
            effects.append(Effect("coulomb_friction", j, params={"fc": float(arm.coulomb[j])}))
        arm = replace(arm, viscous=np.zeros(n), coulomb=np.zeros(n))
    for kind in wanted.kinds:
        effects.append(place_effect(rng, arm, kind))
        joint = effects[-1].joint
        if (kind, joint) in declared:
            declared.remove((kind, joint))
            field = {"viscous_friction": "viscous", "coulomb_friction": "coulomb"}[kind]
            arm = replace(arm, **{field: getattr(arm, field) * (np.arange(n) != joint)})
    return arm, tuple(declared), tuple(effects)


def place_effect(rng, arm: Arm, kind: str) -> Effect:
    """A kind on a joint, its shape drawn and its amplitude one."""
    n = arm.size
    if kind in GLOBAL:
        joint, slide = None, False
    else:
        joint = int(rng.integers(n))
        if kind == "encoder_eccentricity" and not arm.sliding.all():  # a matter of turning joints
            joint = int(rng.choice(np.flatnonzero(~arm.sliding)))
        slide = bool(arm.sliding[joint])
    params = {k: float(v) for k, v in LAWS[kind].draw(rng, slide).items()}
    other = None
    if LAWS[kind].pair:
        other = int((joint + rng.integers(1, n)) % n)
    if kind == "drive_gain":
        params["gain"] = 1.0 + 0.01 * float(rng.choice([-1, 1]))
    if kind == "link_geometry":  # a matter of a joint on another link
        joint = int(rng.integers(1, n))
    if kind == "base_tilt":
        angle = rng.uniform(0, 2 * np.pi)
        params = {"gx": 0.1 * np.cos(angle), "gy": 0.1 * np.sin(angle)}
    if kind == "encoder_offset":
        params["dq0"] = float(rng.choice([-1, 1])) * (1e-3 if slide else 1e-2)
    if kind == "torque_constant_saturation":
        params["c"] *= 0.01 / float(joint_scales(arm)[1][joint])
    if kind == "torque_dead_band":
        params["d"] *= 0.01 * float(joint_scales(arm)[1][joint])
    if kind == "joint_elasticity":
        params["k"] = 1e5 * float(arm.mass[joint:].sum())
    if kind == "contact":
        torque = joint_scales(arm)[1] * rng.normal(size=n) * (rng.random(n) < 0.6)
        torque[rng.integers(n)] = joint_scales(arm)[1].max() * rng.choice([-1, 1])
        params["tau"] = [float(x) for x in torque]
    return Effect(kind, joint, other, params)
