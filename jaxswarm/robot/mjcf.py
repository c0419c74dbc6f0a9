"""Robots from MJCF: compiled by MuJoCo itself, then taken out of the compiled model.

Defaults, angle units, Euler sequences, included files and inertias from shapes are thus resolved by the
format's own reader. With T the pose of a body in its parent and p, a, r the anchor, axis and reference
position of its joints, MuJoCo places the body at

    T J_1(q_1 - r_1) J_2(q_2 - r_2) ...,   J(s) = Trans(p) Rot(a, s) Trans(-p)  or  Trans(a s),

which here are joints with frames at their anchors, and a fixed joint from the last anchor to the body.
Reference: MuJoCo documentation, chapters Computation and XML reference, mujoco.readthedocs.io.
"""

from pathlib import Path

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.robot.joints import Description, Joint, Limits, Mimic
from jaxswarm.robot.placements import (
    body_parameters,
    move_parameters,
    rotation_about,
    rotation_quaternion,
)


def describe_mjcf(path: str | Path) -> Description:
    """Return what an MJCF file says.

    Raises:
        InputError: If MuJoCo is not installed or refuses the file.
    """
    try:
        import mujoco
    except ImportError as error:
        raise InputError(
            f"{path}: reading MJCF needs the package mujoco: pip install 'jaxswarm[mjcf]'."
        ) from error
    # Left to itself MuJoCo prints its warnings and writes them to a file of the current folder.
    warned: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(warned.append)
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except (ValueError, mujoco.FatalError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{path}: MuJoCo refuses it ({reason}): correct the file.") from error
    finally:
        mujoco.set_mju_user_warning(before)
    names = [
        model.joint(j).name or f"{model.body(model.jnt_bodyid[j]).name or 'body'}_joint{j}"
        for j in range(model.njnt)
    ]
    couplings, notes = _couplings(mujoco, model, names)
    notes += [*_left_out(mujoco, model, names), *(f"MuJoCo warns: {text}" for text in warned)]
    joints: list[Joint] = []
    for body in range(1, model.nbody):
        joints += _of_body(mujoco, model, body, names, couplings)
    name = Path(path).stem if model.names[:1] == b"\0" else model.names.split(b"\0")[0].decode()
    return Description(name, tuple(joints), tuple(model.opt.gravity.tolist()), notes=tuple(notes))


def _frame(body: int) -> str:
    """Name of the fixed joint at a body's frame; no joint of a file can be called so."""
    return f"(body {body})"


def _of_body(mujoco, model, body: int, names, couplings) -> list[Joint]:
    """Return the joints of a body and the fixed one that carries it."""
    rotation = rotation_quaternion(model.body_quat[body])
    translation = model.body_pos[body].copy()
    above = int(model.body_parentid[body])
    parent = _frame(above) if above else None  # the world carries the base
    anchor, joints = np.zeros(3), []
    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    for j in range(first, first + count):
        kind = mujoco.mjtJoint(model.jnt_type[j])
        axis, place = model.jnt_axis[j].copy(), model.jnt_pos[j].copy()
        shift, turn = place - anchor, np.eye(3)
        anchor = place
        if kind in (mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_SLIDE):
            reference = float(model.qpos0[model.jnt_qposadr[j]])
            if kind == mujoco.mjtJoint.mjJNT_HINGE:
                turn = rotation_about(axis, -reference)
            else:
                shift = shift - axis * reference
        joints.append(
            Joint(
                name=names[j],
                kind=_KINDS[kind.name],
                parent=parent,
                rotation=rotation @ turn,
                translation=translation + rotation @ shift,
                axis=axis,
                limits=_limits(model, j),
                mimic=couplings.get(names[j]),
            )
        )
        parent, rotation, translation = names[j], np.eye(3), np.zeros(3)
    center = body_parameters(
        float(model.body_mass[body]), np.zeros(3), np.diag(model.body_inertia[body])
    )
    inertia_axes = rotation_quaternion(model.body_iquat[body])
    parameters = move_parameters(center, inertia_axes, model.body_ipos[body])
    at = translation - rotation @ anchor
    joints.append(Joint(_frame(body), "fixed", parent, rotation, at, parameters=parameters))
    return joints


_KINDS = {
    "mjJNT_HINGE": "revolute",
    "mjJNT_SLIDE": "prismatic",
    "mjJNT_FREE": "floating",
    "mjJNT_BALL": "ball",
}


def _limits(model, j: int) -> Limits:
    lower, upper = model.jnt_range[j] if model.jnt_limited[j] else (np.nan, np.nan)
    effort = np.abs(model.jnt_actfrcrange[j]).max() if model.jnt_actfrclimited[j] else np.nan
    return Limits(float(lower), float(upper), effort=float(effort))


def _couplings(mujoco, model, names) -> tuple[dict[str, Mimic], list[str]]:
    """Return joint -> coupling of the active linear joint equalities, and notes on other equalities."""
    couplings, notes = {}, []
    for e in range(model.neq):
        if not model.eq_active0[e]:
            continue
        kind = mujoco.mjtEq(model.eq_type[e])
        curve = model.eq_data[e, :5]
        first, second = int(model.eq_obj1id[e]), int(model.eq_obj2id[e])
        if kind == mujoco.mjtEq.mjEQ_JOINT and second >= 0 and not curve[2:].any():
            # MuJoCo couples the distances from the reference positions.
            zero, other = (float(model.qpos0[model.jnt_qposadr[j]]) for j in (first, second))
            slope = float(curve[1])
            offset = float(curve[0]) + zero - slope * other
            couplings[names[first]] = Mimic(names[second], slope, offset)
        else:
            label = kind.name.removeprefix("mjEQ_").lower()
            notes.append(
                f"equality {model.eq(e).name or e} ({label}) is not modeled: links are a tree"
            )
    return couplings, notes


def _left_out(mujoco, model, names) -> list[str]:
    """Return notes on what acts in MuJoCo and is no part of a rigid tree."""
    notes = []
    for what, values in (
        ("armature", model.dof_armature),
        ("damping", model.dof_damping),
        ("frictionloss", model.dof_frictionloss),
    ):
        given = {names[j]: v for j, v in zip(model.dof_jntid, values, strict=True) if v.any()}
        if given:
            shown = ", ".join(f"{joint} {v.max():.4g}" for joint, v in given.items())
            notes.append(f"{what} is not part of the links ({shown})")
    springs = [names[j] for j in range(model.njnt) if model.jnt_stiffness[j].any()]
    if springs:
        notes.append(f"stiffness is not part of the links ({', '.join(springs)})")
    if model.ntendon:
        notes.append(f"{model.ntendon} tendons are not modeled")
    if model.body_gravcomp.any():
        notes.append("gravity compensation of bodies is not modeled: links weigh what they weigh")
    if model.opt.density or model.opt.viscosity:
        notes.append("drag of the medium is not modeled")
    return notes
