"""The command ``predict``, from files to a file."""

from pathlib import Path

import numpy as np

from jaxswarm import outputs
from jaxswarm.identify.model import Model, load_model, model_torque
from jaxswarm.identify.validate import log_errors
from jaxswarm.logs import Log, read_log
from jaxswarm.logs.motion import Motion, prepare
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
    t, tau, motion = predict_log(model, log)
    header = ["t", *(f"tau_{j}" for j in robot.joints)]
    table = np.column_stack([t, tau])

    def write(path: Path) -> None:
        write_table(path, header, table, "%.10g")

    outputs.write_files(out.parent, {out.name: write})
    result = {"log": str(log_path), "samples": len(t), "out": str(out), "notes": log.notes}
    if motion.tau is not None:
        result["error"] = log_errors(model, motion)
    return result


def predict_log(model: Model, log: Log) -> tuple[np.ndarray, np.ndarray, Motion]:
    """Torque of a model at a log's own time stamps: times (T,), torque (T, n), and the motion used."""
    motion = prepare(log, model.filtering)
    torque = model_torque(model, motion)
    own = log.t - log.t[0]
    columns = [np.interp(own, motion.t, torque[:, j]) for j in range(torque.shape[1])]
    return log.t, np.column_stack(columns), motion
