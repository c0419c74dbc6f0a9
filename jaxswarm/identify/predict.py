"""The command ``predict``, from files to a file."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from jaxswarm import outputs
from jaxswarm.identify.estimation.validate import log_errors
from jaxswarm.identify.forward.begun import in_another_log
from jaxswarm.identify.forward.model import Model, load_model, model_torque
from jaxswarm.identify.forward.seen import begun_before, beyond_seen
from jaxswarm.identify.run import refuse_missing_channels
from jaxswarm.logs import Log, read_log
from jaxswarm.logs.clock import with_sample_times
from jaxswarm.logs.log import take
from jaxswarm.logs.motion import Motion
from jaxswarm.logs.segments import prepare_segments, uncut, unfiltered
from jaxswarm.logs.write import write_table


def predict_file(model_path: Path, log_path: Path, out: Path) -> dict:
    """Predict the torque along a log at its own time stamps and write it as CSV.

    Raises:
        InputError: If the model or the log cannot be used, or the file not be written.
    """
    model = load_model(model_path)
    out = outputs.check_file(out)
    robot = model.robot
    log = read_log(log_path, robot.joints, np.asarray(robot.drive_gain), require_torque=False)
    refuse_missing_channels(model.terms, [log])
    told = predict_log(model, log)
    t = log.t
    header = ["t", *(f"tau_{j}" for j in robot.joints)]
    table = np.column_stack([t, told.tau])

    def write(path: Path) -> None:
        write_table(path, header, table, "%.10g")

    outputs.write_told(out.parent, {out.name: write})
    result = {"log": str(log_path), "samples": len(t), "out": str(out), "notes": list(told.notes)}
    if log.tau is not None:
        result["error"] = log_errors(told.model, *told.motions)
    return result


@dataclass(frozen=True, eq=False)
class Told:
    """What a model says of a log.

    Attributes:
        tau: Torque [N m or N] at the log's own time stamps, (T, n).
        motions: Stretches of the log that were used.
        model: The model as it is in this log: what began in the middle of a fitted one may not have begun
            here, or before.
        notes: Sentences on what was found and done.
    """

    tau: np.ndarray
    motions: list[Motion]
    model: Model
    notes: tuple[str, ...]


def predict_log(model: Model, log: Log) -> Told:
    """Torque of a model at a log's own time stamps.

    Raises:
        InputError: If no stretch of the log is long enough to differentiate.
    """
    noted, motions = prepare_segments(log, model.filtering)
    model, begun = in_another_log(model, motions, log.tau is not None)
    own = with_sample_times(log).t
    own = own - own[0]
    torque = np.empty((len(own), len(log.joints)))
    parts = uncut(log, model.filtering)
    rows = np.split(np.arange(len(own)), np.cumsum([len(p.t) for p in parts])[:-1])
    for part in rows:
        # Every stamp is answered: a stretch too short to filter is differentiated as it stands.
        start, end = own[part[0]], own[part[-1]]
        inside = [m for m in motions if m.t[0] <= end and m.t[-1] >= start]
        motion = inside[0] if inside else unfiltered(take(log, part), motions[0], start)
        predicted = model_torque(model, motion)
        for j, column in enumerate(predicted.T):
            torque[part, j] = np.interp(own[part], motion.t, column)
    unseen = (*beyond_seen(model, motions), *begun_before(model, motions))
    return Told(torque, motions, model, (*noted.notes, *begun, *unseen))
