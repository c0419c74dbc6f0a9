"""The loop on the papers' arm: an effect is in the data that nobody declared.

A swarm, like least squares, spreads an undeclared torque over its thirteen parameters and reports them
with the same confidence. The loop asks what the residual looks like, names the effect, and refits.
"""

from collections.abc import Callable

import jax
import numpy as np

from jaxswarm.diagnose.loop import diagnose
from jaxswarm.diagnose.run import conclude
from jaxswarm.diagnose.synthetic import synthetic_log
from jaxswarm.identify.terms import Term
from jaxswarm.logs.motion import Motion, prepare
from jaxswarm.robot import rx60
from jaxswarm.robot.placements import body_parameters
from jaxswarm.studies.rx60_data import Experiment, compress
from jaxswarm.studies.rx60_search import base_of, scheme, search, view

PAYLOAD = 2.0  # kg, 0.3 m out on link 3


def _cases() -> dict[str, tuple]:
    """Name to (arm, hidden terms)."""
    arm = rx60()
    load = body_parameters(PAYLOAD, np.array([0.0, -0.3, 0.0]), np.zeros((3, 3)))
    parameters = np.array(arm.parameters)
    parameters[2] += load
    return {
        "friction": (arm, (Term("coulomb_friction", 0, values={"fc": 3.0}),)),
        "ripple": (
            arm,
            (Term("torque_ripple", 1, values={"sine": 0.9, "cosine": 0.7, "n": 22.0}),),
        ),
        "payload": (arm.replace(parameters=parameters), ()),
    }


def undeclared_effect(
    seed: int,
    key: jax.Array,
    progress: Callable[[str], None] = lambda text: None,
    names: tuple[str, ...] = ("friction", "ripple", "payload"),
) -> list[dict]:
    """For every hidden effect: what both papers' schemes report, what the loop finds, errors on unseen motion.

    Args:
        seed: Draws motions and noise.
        key: Key of the searches.
        progress: Called with one line per stage.
        names: Which of friction (joint 1), ripple (joint 2), payload (link 3).
    """
    rows = []
    for name in names:
        arm, hidden = _cases()[name]
        progress(f"undeclared {name}")
        motion = prepare(synthetic_log(arm, hidden, seed))
        log = synthetic_log(arm, hidden, seed + 10_000)
        row = {"hidden": name, "torque_noise": 0.2, **_by_swarms(motion, prepare(log), key)}
        found = diagnose(rx60(), (), [motion], seed=seed, progress=progress)
        unseen = prepare(log, found.final.model.filtering)
        result, _ = conclude(found, [unseen], seed, progress)
        row["loop"] = {
            "verdict": result["verdict"],
            "effects": [{"effect": e["effect"], "joint": e["joint"]} for e in result["effects"]],
            "before": result["error"]["before"]["rms"],
            "after": result["error"]["after"]["rms"],
        }
        rows.append(row)
    return rows


def _by_swarms(motion: Motion, unseen: Motion, key: jax.Array) -> dict:
    """GPSO and AELSPSO on the thirteen parameters: base combinations and RMS on the unseen motion."""
    data, check = _experiment(motion), _experiment(unseen)
    problem = compress(data)
    at, base = view(problem), base_of(problem)
    report = {"base": list(base.expressions())}
    for name in ("gpso", "aelspso"):
        found = search(at, scheme(name, 2000), key, runs=10, num_steps=2000)
        theta = found.points.mean(axis=0)
        error = check.tau - check.columns @ theta
        report[name] = {
            "fbest": float(found.values.mean()),
            "base_mean": base.reduce(theta).tolist(),
            "rms": np.sqrt((error**2).mean(axis=0)).tolist(),
        }
    return report


def _experiment(motion: Motion) -> Experiment:
    """A prepared log below its torque cutoff, motion and torque filtered alike."""
    kept = motion.decimator.kept(len(motion.t))
    tau = motion.decimator.apply(motion.tau)
    return Experiment(motion.t[kept], motion.q[kept], motion.dq[kept], motion.ddq[kept], tau)
