"""What a diagnosis under way has searched already, kept on disk so that an interrupted one goes on.

The loop itself is fast and follows from its inputs alone; the searches of nonlinear parameters are what
takes time. Their results are written after every round, exact to the last bit, under a fingerprint of
everything the searches depend on. A repeated command reads them and so comes to the same result.
"""

import hashlib
import json
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

import jax
import numpy as np

from jaxswarm import outputs
from jaxswarm.effects.base import REGISTRY
from jaxswarm.effects.term import Term
from jaxswarm.logs.motion import Motion
from jaxswarm.robot.model import Robot

FILE = "diagnosis.partial.json"


class Journal:
    """Results of searches by round and term, in one file of a folder.

    Args:
        folder: Where the report will be.
        fingerprint: Of the inputs, see :func:`fingerprint`; a file with another one, or one that was
            changed since it was written, is not used.
    """

    def __init__(self, folder: Path, fingerprint: str):
        self.folder, self.fingerprint = Path(folder), fingerprint
        self.rounds: dict[str, dict[str, list[dict[str, float]]]] = {}
        try:
            content = json.loads((self.folder / FILE).read_text(encoding="utf-8"))
            told = content["fingerprint"], content["digest"]
            if told == (fingerprint, _digest(content["rounds"])):
                self.rounds = content["rounds"]
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            pass  # no earlier attempt, or one that cannot be read: start anew

    def recall(self, number: int, term: Term) -> list[dict[str, float]] | None:
        """Values per fold that a round of the interrupted diagnosis found for a term."""
        return self.rounds.get(str(number), {}).get(_name(term))

    def keep(self, number: int, found: dict[Term, list[dict[str, float]]]) -> None:
        """Write what a round found."""
        self.rounds[str(number)] = {
            _name(t): [{k: float(v) for k, v in fold.items()} for fold in values]
            for t, values in found.items()
        }
        known = {"fingerprint": self.fingerprint, "digest": _digest(self.rounds)}
        outputs.write_files(self.folder, {FILE: json.dumps({**known, "rounds": self.rounds})})

    def close(self, done: bool = True) -> None:
        """The report is written; of a search that is done nothing is left to go on from."""
        if done:
            (self.folder / FILE).unlink(missing_ok=True)


def fingerprint(robot: Robot, motions: Sequence[Motion], *options) -> str:
    """Digest of our version and laws, a robot, logs as they are filtered, and options by ``repr``."""
    # Laws of a user's own file may change from one run to the next.
    laws = [(law.name, law.parameters, law.grid_size) for law in REGISTRY.values()]
    digest = hashlib.sha256(repr((version("jaxswarm"), laws, options)).encode())
    arrays = [
        *jax.tree.leaves(robot),
        *(x for m in motions for x in (m.t, m.q, m.dq, m.ddq, m.tau)),
        *(m.channels[name] for m in motions for name in sorted(m.channels)),
        *(m.decimator.taps for m in motions),
    ]
    bands = [
        (
            m.motion_cutoff,
            m.torque_cutoff,
            m.skew,
            m.weight_skew,
            m.decimator.factor,
            sorted(m.channels),
        )
        for m in motions
    ]
    digest.update(repr(bands).encode())
    for array in arrays:
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def _digest(rounds: object) -> str:
    return hashlib.sha256(json.dumps(rounds, sort_keys=True).encode()).hexdigest()


def _name(term: Term) -> str:
    return "/".join(map(str, term.place))
