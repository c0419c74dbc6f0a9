"""An identified model: what ``model.json`` holds and ``predict`` needs, and its torque along a log."""

import json
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import numpy as np

from jaxswarm.documents import read_document
from jaxswarm.effects import formula
from jaxswarm.effects.kinds import TorqueLaw
from jaxswarm.effects.parameter import assumed
from jaxswarm.effects.term import Term
from jaxswarm.errors import InputError
from jaxswarm.identify.forward import uncertainty
from jaxswarm.identify.forward.model_check import check_content
from jaxswarm.identify.forward.smooth import Smooth, from_json, to_json
from jaxswarm.identify.forward.torque_along import torque_along
from jaxswarm.identify.forward.uncertainty import Uncertainty
from jaxswarm.identify.forward.written_down import mixed
from jaxswarm.logs.motion import Filtering, Motion
from jaxswarm.robot.model import Robot

FORMAT = 1


@dataclass(frozen=True)
class Model:
    """A robot, its terms with values, and how a log has to be filtered for it.

    Attributes:
        robot: With the identified link parameters (base values, zeros for what merges into them).
        terms: With values for all their parameters.
        width: Width of every joint's smooth sign [rad/s or m/s], (n,).
        filtering: Frequencies the model was identified with.
        sigma: Residual standard deviation per joint at identification [N m or N].
        smooth: Fitted functions for what no law explains.
        uncertainty: Covariance of the linear parameters; None where it is not known.
    """

    robot: Robot
    terms: tuple[Term, ...]
    width: tuple[float, ...]
    filtering: Filtering
    sigma: tuple[float, ...]
    smooth: tuple[Smooth, ...] = ()
    uncertainty: Uncertainty | None = field(default=None, compare=False)

    def during(self, log: int | None) -> "Model":
        """The model in a log by its number, with what happened there alone; None: what always holds."""
        kept = (
            t for t in self.terms if not t.law.in_one_log or (log is not None and t.acts_in(log))
        )
        return replace(self, terms=tuple(kept))

    def on_joint(self, joint: int) -> "Model":
        """The model without what acts on other joints alone: the torque of this one is the same.

        Where what is written down may mix joints, nothing is left out.
        """
        if mixed(self.terms):
            return self
        kept = (t for t in self.terms if t.joint == joint or not isinstance(t.law, TorqueLaw))
        return replace(self, terms=tuple(kept))

    def __repr__(self) -> str:
        terms = ", ".join(term.label(self.robot.joints) for term in self.terms)
        further = f" + {len(self.smooth)} smooth" if self.smooth else ""
        return f"Model({self.robot.name}: rigid body + [{terms}]{further})"


def linear_values(model: Model) -> np.ndarray:
    """The parameters the columns of :func:`assemble` multiply, shape (p,)."""
    parts = [np.asarray(model.robot.parameters).ravel()]
    for term in model.terms:
        names = term.linear_names(model.robot.joints)
        parts.append(np.array([term.values[name] for name in names]))
    return np.concatenate(parts)


def model_torque(model: Model, motion: Motion) -> np.ndarray:
    """Torque of the whole model on a log's working clock, shape (T, n)."""
    theta = linear_values(model)
    torque = torque_along(model.robot, model.terms, motion, model.width, theta)
    return torque + smooth_torque(model, motion)


def smooth_torque(model: Model, motion: Motion) -> np.ndarray:
    """What the smooth terms of a model add along a log, shape (T, n)."""
    torque = np.zeros((len(motion.t), model.robot.num_joints))
    for term in model.smooth:
        torque[:, term.joint] += term.torque(motion)
    return torque


def with_linear_values(model: Model, values: np.ndarray) -> Model:
    """The model with other values for the columns of :func:`assemble`, shape (p,)."""
    k = 10 * model.robot.num_joints
    parameters = jnp.asarray(values[:k].reshape(-1, 10))
    terms = []
    for term in model.terms:
        count = len(term.linear_names(model.robot.joints))
        terms.append(term.with_linear(values[k : k + count], model.robot.joints))
        k += count
    return replace(model, robot=model.robot.replace(parameters=parameters), terms=tuple(terms))


def save_model(model: Model, path: Path) -> None:
    """Write ``model.json``: everything :func:`load_model` and ``predict`` need."""
    Path(path).write_text(model_text(model), encoding="utf-8")


def model_text(model: Model) -> str:
    """What ``model.json`` holds."""
    model = model.during(None)  # a contact in the log is nothing of the robot's
    robot = model.robot
    content = {
        "format": FORMAT,
        "robot": {
            "name": robot.name,
            "joints": list(robot.joints),
            "kinds": list(robot.kinds),
            "parents": list(robot.parents),
            **{
                field: np.asarray(getattr(robot, field)).tolist()
                for field in ("rotation", "translation", "axis", "gravity", "parameters")
            },
            "drive_gain": [None if np.isnan(g) else float(g) for g in np.asarray(robot.drive_gain)],
        },
        "terms": [
            {
                "effect": t.effect,
                "joint": None if t.joint is None else robot.joints[t.joint],
                "other": None if t.other is None else robot.joints[t.other],
                "values": {k: float(v) for k, v in t.values.items()},
                **({"formula": formula.to_json(t.formula)} if t.formula else {}),
            }
            for t in model.terms
        ],
        "width": list(map(float, model.width)),
        "filtering": {
            "motion_cutoff": model.filtering.motion_cutoff,
            "torque_cutoff": model.filtering.torque_cutoff,
            "use_logged_velocity": model.filtering.use_logged_velocity,
            "skew": model.filtering.skew,
            "weight_skew": model.filtering.weight_skew,
        },
        "sigma": list(map(float, model.sigma)),
        "smooth": [to_json(term, robot.joints) for term in model.smooth],
        "uncertainty": uncertainty.to_json(model.uncertainty),
    }
    return json.dumps(content, indent=1) + "\n"


def load_model(path: Path) -> Model:
    """Read a ``model.json``.

    Raises:
        InputError: If the file is missing, not JSON, of another format or incomplete.
    """
    path = Path(path)
    try:
        content = json.loads(read_document(path))
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; identify writes it as DIR/model.json") from None
    except InputError:
        raise
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{path}: cannot be read as JSON ({error}); pass a model.json") from None
    if not isinstance(content, dict) or "format" not in content:
        raise InputError(f"{path}: is no jaxswarm model; pass a model.json written by identify")
    if content["format"] != FORMAT:
        raise InputError(
            f"{path}: format {content['format']!r}, this version reads {FORMAT}; identify it again"
        )
    try:
        return _from_json(content)
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        if isinstance(error, InputError):
            raise InputError(f"{path}: {error}") from None
        raise InputError(f"{path}: incomplete or damaged ({error!r}); identify it again") from None


def _per_joint(width: float | list[float], joints: int) -> list[float]:
    """One width per joint; older files hold one for all."""
    return width if isinstance(width, list) else [width] * joints


def _from_json(content: dict) -> Model:
    check_content(content)
    part = content["robot"]
    joints = tuple(part["joints"])
    n = len(joints)
    shapes = {
        "rotation": (n, 3, 3),
        "translation": (n, 3),
        "axis": (n, 3),
        "gravity": (3,),
        "parameters": (n, 10),
    }
    arrays: dict[str, Any] = {
        k: jnp.asarray(np.asarray(part[k], float).reshape(s)) for k, s in shapes.items()
    }
    gains = [np.nan if g is None else float(g) for g in part["drive_gain"]]
    robot = Robot(
        name=part["name"],
        joints=joints,
        kinds=tuple(part["kinds"]),
        parents=tuple(part["parents"]),
        drive_gain=jnp.asarray(gains),
        **arrays,
    )
    terms = []
    for entry in content["terms"]:
        joint = None if entry["joint"] is None else joints.index(entry["joint"])
        other = None if entry["other"] is None else joints.index(entry["other"])
        own = formula.from_json(entry["formula"]) if "formula" in entry else None
        term = Term(entry["effect"], joint, other, formula=own)
        # Files written before a choice or a shape was one of the parameters lack it.
        terms.append(replace(term, values={**assumed(term.law.parameters), **entry["values"]}))
    return Model(
        robot,
        tuple(terms),
        tuple(map(float, _per_joint(content["width"], n))),
        Filtering(**content["filtering"]),
        tuple(content["sigma"]),
        tuple(from_json(entry, joints) for entry in content.get("smooth", [])),
        uncertainty.from_json(content.get("uncertainty")),
    )
