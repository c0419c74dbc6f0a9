"""The loop on the papers' arm: an effect is in the data that nobody declared.

A swarm, like least squares, spreads an undeclared torque over its thirteen parameters and reports them
with the same confidence. The loop asks what the residual looks like, names the effect, and refits. A payload
that was there during the whole fit is no effect but part of the rigid body; it is one against the model of
the unloaded arm, so that is where the loop starts for it.
"""

from collections.abc import Callable

import jax
import numpy as np

from jaxswarm.diagnose.run import conclude
from jaxswarm.diagnose.run_against import conclude_comparison
from jaxswarm.diagnose.selection.changes import compare
from jaxswarm.diagnose.selection.stepwise import diagnose
from jaxswarm.effects.examples import dry_friction, ripple
from jaxswarm.identify.synthetic import synthetic_log
from jaxswarm.logs.log import Log
from jaxswarm.logs.motion import Motion, prepare
from jaxswarm.robot import rx60
from jaxswarm.robot.placements import body_parameters
from jaxswarm.studies import page
from jaxswarm.studies.rx60 import paper
from jaxswarm.studies.rx60.data import Experiment, compress
from jaxswarm.studies.rx60.figures import WORDS
from jaxswarm.studies.rx60.search import base_of, scheme, search, view

PAYLOAD = 2.0  # kg, 0.3 m out on link 3
# The case that shows only against the model of an earlier log.
_LOADED = "load on link 3"


def _cases() -> dict[str, tuple]:
    """Name to (arm, hidden terms)."""
    arm = rx60()
    load = body_parameters(PAYLOAD, np.array([0.0, -0.3, 0.0]), np.zeros((3, 3)))
    parameters = np.array(arm.parameters)
    parameters[2] += load
    return {
        "friction": (arm, (dry_friction(0, 3.0),)),
        "ripple": (arm, (ripple(1),)),
        _LOADED: (arm.replace(parameters=parameters), ()),
    }


def undeclared_effect(
    seed: int,
    key: jax.Array,
    progress: Callable[[str], None] = lambda text: None,
    names: tuple[str, ...] = ("friction", "ripple", _LOADED),
) -> list[dict]:
    """For every hidden effect: what both papers' schemes report, what the loop finds, errors on unseen motion.

    Args:
        seed: Draws motions and noise.
        key: Key of the searches.
        progress: Called with one line per stage.
        names: Which of friction (joint 1), ripple (joint 2), load on link 3.
    """
    rows = []
    for name in names:
        arm, hidden = _cases()[name]
        progress(f"undeclared {name}")
        log = synthetic_log(arm, hidden, seed)
        unseen = synthetic_log(arm, hidden, seed + 10_000)
        row = {
            "hidden": name,
            "torque_noise": 0.2,
            **_by_swarms(prepare(log), prepare(unseen), key),
            "loop": _by_loop(log, unseen, seed, progress),
        }
        if name == _LOADED:
            # Carried during the whole fit a payload is part of the rigid body, and nothing is missing.
            row["fitted_anew"] = row["loop"]
            row["loop"] = _by_comparison(log, unseen, seed, progress)
        rows.append(row)
    return rows


def _by_loop(log: Log, unseen: Log, seed: int, progress) -> dict:
    """The loop from the rigid body, on its own log."""
    found = diagnose(rx60(), (), [prepare(log)], seed=seed, progress=progress)
    motion = prepare(unseen, found.final.model.filtering)
    return _outcome(conclude(found, [motion], seed, progress)[0])


def _by_comparison(log: Log, unseen: Log, seed: int, progress) -> dict:
    """The loop against the model of an earlier, unloaded log."""
    earlier = prepare(synthetic_log(rx60(), (), seed + 20_000))
    model = diagnose(rx60(), (), [earlier], seed=seed, progress=progress).final.model
    motion, further = (prepare(x, model.filtering) for x in (log, unseen))
    found = compare(model, [motion], seed=seed, progress=progress)
    return _outcome(conclude_comparison(found, [further], seed, progress)[0])


def _outcome(result: dict) -> dict:
    return {
        "verdict": result["verdict"],
        "effects": [
            {
                "effect": e["effect"],
                "joint": e["joint"],
                "values": {name: one["value"] for name, one in e["parameters"].items()},
            }
            for e in result["effects"]
        ],
        "before": result["error"]["before"]["rms"],
        "after": result["error"]["after"]["rms"],
    }


def _by_swarms(motion: Motion, unseen: Motion, key: jax.Array) -> dict:
    """GPSO and AELSPSO on the thirteen parameters: base combinations and RMS on the unseen motion."""
    data, check = _experiment(motion), _experiment(unseen)
    problem = compress(data)
    at, base = view(problem), base_of(problem)
    report = {
        "base": list(base.expressions()),
        "base_true": base.reduce(paper.TRUE).tolist(),
    }
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
    tau = motion.low_torque
    return Experiment(motion.t[kept], motion.q[kept], motion.dq[kept], motion.ddq[kept], tau)


def _words(effect: dict) -> str:
    where = f" on {effect['joint']}" if effect["joint"] else ""
    values = ", ".join(f"{name} = {page.number(x)}" for name, x in effect["values"].items())
    return f"{effect['effect']}{where} ({values})"


def section(result: dict, images: dict[str, bytes]) -> list[str]:
    """The page's part on the loop; nothing where the study ran without it."""
    if "loop" not in result:
        return []
    errors, reports = [], []
    for r in result["loop"]:
        effects = ", ".join(map(_words, r["loop"]["effects"]))
        declared = "model of the unloaded arm" if "fitted_anew" in r else "declared rigid body"
        errors += [
            [f"{r['hidden']}: GPSO", *r["gpso"]["rms"], "no effect can be named"],
            [f"{r['hidden']}: AELSPSO", *r["aelspso"]["rms"], "no effect can be named"],
            [f"{r['hidden']}: {declared}", *r["loop"]["before"], ""],
            [
                f"{r['hidden']}: after the loop",
                *r["loop"]["after"],
                effects or r["loop"]["verdict"],
            ],
        ]
        if "fitted_anew" in r:
            anew = r["fitted_anew"]
            row = [f"{r['hidden']}: rigid body with all its parameters fitted anew", *anew["after"]]
            errors.append([*row, anew["verdict"]])
        reports += [
            page.sentence(
                f"Undeclared {r['hidden']}: what the paper's methods would have reported."
            ),
            page.table(
                ["", *r["base"]],
                [
                    [
                        "true (without the load)" if r["hidden"] == _LOADED else "true",
                        *r["base_true"],
                    ],
                    ["GPSO: mean", *r["gpso"]["base_mean"]],
                    ["AELSPSO: mean", *r["aelspso"]["base_mean"]],
                ],
            ),
        ]
    noise = max(r["torque_noise"] for r in result["loop"])
    return [
        page.heading("The loop: an effect that nobody declared"),
        page.sentence(
            f"Own motion (random Fourier), torque noise {noise:g} N m a sample before filtering. RMS in N m "
            "on a motion that was not fitted."
        ),
        page.table(["", "joint 1", "joint 2", "joint 3", "found"], errors),
        page.picture("loop.png", images["loop.png"], WORDS["loop"]),
        *reports,
    ]
