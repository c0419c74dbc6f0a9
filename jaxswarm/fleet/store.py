"""Results of single logs on disk, each written whole: what is there need not be done again.

``DIR/logs/<name>/diagnosis.json`` holds what ``jaxswarm diagnose`` tells of the log; a log that cannot be
used has ``refused.json`` with the reason. Both name the log and the fingerprint of what was asked, so that
another question, or another file under the same name, is answered anew.
"""

import hashlib
import json
from importlib.metadata import version
from pathlib import Path

import jax
import numpy as np

from jaxswarm import outputs
from jaxswarm.fleet.one_log import FAILED, REFUSED, Settings, unused
from jaxswarm.fleet.sources import Source, stamp

_DONE, _REFUSED = "diagnosis.json", "refused.json"


def fingerprint(settings: Settings) -> str:
    """Digest of our version, the robot, the earlier model and all options."""
    robot, model = settings.robot, settings.model
    options = {k: v for k, v in vars(settings).items() if k not in ("robot", "model")}
    told: list[object] = [version("jaxswarm"), robot.name, robot.joints, robot.kinds]
    told += [robot.parents, options]
    if model is not None:
        told += [model.terms, model.width, model.filtering]
    digest = hashlib.sha256(repr(told).encode())
    for leaf in jax.tree.leaves((robot, None if model is None else model.robot)):
        digest.update(np.ascontiguousarray(leaf).tobytes())
    return digest.hexdigest()


class Store:
    """The folder with a result for every log.

    Args:
        folder: ``DIR/logs``.
        asked: Fingerprint of the question, see :func:`fingerprint`.
    """

    def __init__(self, folder: Path, asked: str):
        self.folder, self.asked = Path(folder), asked

    def known(self, source: Source) -> bool:
        """Whether the log, as it is now, has an answer to this question."""
        for name in (_DONE, _REFUSED):
            kept = self._read(source, name).get("fleet", {})
            if kept.get("asked") == self.asked:
                return kept.get("stamp") is not None and kept["stamp"] == _stamp(source)
        return False

    def keep(self, source: Source, answer: dict) -> None:
        """Write what came of a log; a failure is not kept, it may pass."""
        mark = {"log": source.address, "asked": self.asked, "stamp": answer["stamp"]}
        if "result" in answer:
            self._write(source, _DONE, {**answer["result"], "fleet": mark}, _REFUSED)
        elif answer["unused"] == REFUSED:
            content = {**unused(REFUSED, answer["reason"]), "fleet": mark}
            self._write(source, _REFUSED, content, _DONE)

    def result(self, source: Source) -> dict:
        """What came of a log: the content of its ``diagnosis.json``, or why there is none."""
        for name in (_DONE, _REFUSED):
            content = self._read(source, name)
            if content.get("fleet", {}).get("asked") == self.asked:
                return content
        return unused(FAILED, f"its result cannot be read in {self.folder / source.name}")

    def _read(self, source: Source, name: str) -> dict:
        try:
            content = json.loads((self.folder / source.name / name).read_text(encoding="utf-8"))
            return content if isinstance(content, dict) else {}
        except (OSError, ValueError):
            return {}

    def _write(self, source: Source, name: str, content: dict, other: str) -> None:
        place = self.folder / source.name
        outputs.write_files(place, {name: outputs.to_json(content)})
        (place / other).unlink(missing_ok=True)


def _stamp(source: Source) -> str | None:
    try:
        return stamp(source.address)
    except Exception:  # a log that cannot be reached now is asked again and told with its reason
        return None
