"""Errors on motion that was not fitted, as ``diagnosis.json`` has them; of several logs the worst one leads."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.diagnose.decision.rules import BEYOND, NEAR
from jaxswarm.diagnose.folds.noise import noise_of
from jaxswarm.diagnose.selection.elsewhere import event_windows, expected
from jaxswarm.identify.estimation.estimate import Estimate
from jaxswarm.identify.estimation.validate import held_out_errors, log_errors
from jaxswarm.identify.forward.begun import AS_FITTED, in_state_of, states_of
from jaxswarm.identify.forward.model import Model
from jaxswarm.logs.motion import Motion


class UnseenErrors:
    """Errors of models on validation logs, else on held-out blocks of time.

    Args:
        validation: Stretches of the validation logs; those of one log have one source.
        before, after: The declared and the final model: they decide which log is the worst, the one on
            which the error grew most or fell least, and what of a log is not scored: the swing of a link
            that nobody saw begin, and stretches in which both leave far more than in most.
    """

    def __init__(self, validation: Sequence[Motion], before: Estimate, after: Estimate):
        self.logs: dict[str, list[Motion]] = {}
        for motion in validation:
            self.logs.setdefault(motion.source, []).append(motion)
        self.worst: str | None = None
        self._terms = *before.model.terms, *after.model.terms
        self._events = {
            source: [window for m in motions for window in event_windows(before, after, m)]
            for source, motions in self.logs.items()
        }
        self.validation = [self._entry(before, after, source) for source in self.logs]
        if self.logs:
            change = [
                entry["after"]["relative_global"] / max(entry["before"]["relative_global"], 1e-12)
                for entry in self.validation
            ]
            self.worst = list(self.logs)[int(np.argmax(change))]

    def _entry(self, before: Estimate, after: Estimate, source: str) -> dict[str, Any]:
        """Errors of both models on a log; where they are much, what the final one is expected to leave."""
        one, two = (self._on(found.model, source) for found in (before, after))
        entry = {"on": Path(source).name, "before": one, "after": two}
        names, begun = after.model.robot.joints, states_of(after.model, self.logs[source])
        if told := {t: state for t, state in begun.items() if state != AS_FITTED}:
            entry["begun"] = [
                {"effect": t.effect, "joint": names[t.index], "state": state}
                for t, state in told.items()
            ]
        noise = noise_of(after)
        # Many predictions: only where there is something to say.
        if np.any(two["rms"] > NEAR * noise):
            expected = _expected(after, self.logs[source], noise)
            entry["expected"] = expected.tolist()
            most = np.maximum(NEAR * noise, expected)
            entry["beyond"] = _beyond(after.model.robot.joints, two["rms_moving"], noise, most)
        return entry

    def of(self, found: Estimate) -> dict:
        """Errors of a model on the worst log, or on held-out blocks of time."""
        if self.worst is None:
            return {**held_out_errors(found), "on": "held-out blocks of time"}
        return {**self._on(found.model, self.worst), "on": Path(self.worst).name}

    def with_model(self, model: Model) -> dict | None:
        """Errors of a model that is no fit, on the worst log; None without a validation log."""
        if self.worst is None:
            return None
        return {**self._on(model, self.worst), "on": Path(self.worst).name}

    def _on(self, model: Model, source: str) -> dict:
        left_out: dict[str, Any] = {"terms": self._terms, "events": self._events[source]}
        here = in_state_of(model, self.logs[source])
        return log_errors(here, *self.logs[source], **left_out)


def _expected(found: Estimate, motions: Sequence[Motion], noise: np.ndarray) -> np.ndarray:
    """The most (n,) that a fit is expected to leave of a log in stretches, each counted by its length."""
    power = [expected(motion, noise, found) ** 2 for motion in motions]
    return np.sqrt(np.average(power, axis=0, weights=[len(m.t) for m in motions]))


def _beyond(
    joints: Sequence[str], moving: Sequence[float | None], noise: np.ndarray, most: np.ndarray
) -> list[dict[str, Any]]:
    """Joints that in motion are left with far more than the fitted motion leaves open, and how much.

    Args:
        joints: Their names.
        moving: RMS error where they move; None: they do not.
        noise, most: Of every joint, and what the fitted motion leaves open, (n,).
    """
    return [
        {"joint": joint, "over_noise": float(left / own)}
        for joint, left, own, at_most in zip(joints, moving, noise, most, strict=True)
        if left is not None and left > BEYOND * at_most
    ]
