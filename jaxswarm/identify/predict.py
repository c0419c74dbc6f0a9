"""The command ``predict``, from files to a file."""

from pathlib import Path

import numpy as np

from jaxswarm import outputs
from jaxswarm.errors import InputError
from jaxswarm.identify.estimation.validate import log_errors
from jaxswarm.identify.forward.model import Model, load_model, model_torque
from jaxswarm.logs import Log, read_log
from jaxswarm.logs.clock import with_sample_times
from jaxswarm.logs.motion import Motion, prepare


def predict_file(model_path: Path, log_path: Path, out: Path) -> dict:
    """Predict the torque along a log at its own time stamps and write it as CSV.

    Raises:
        InputError: If the model or the log cannot be used, or the file not be written.
    """
    model = load_model(model_path)
    out = Path(out)
    outputs.check_folder(out.parent)
    if out.is_dir():
        raise InputError(f"--out {out}: is a folder; name a file such as {out / 'pred.csv'}")
    robot = model.robot
    log = read_log(log_path, robot.joints, np.asarray(robot.drive_gain), require_torque=False)
    t, tau, motion = predict_log(model, log)
    header = ",".join(["t", *(f"tau_{j}" for j in robot.joints)])
    table = np.column_stack([t, tau])

    def write(path: Path) -> None:
        np.savetxt(path, table, delimiter=",", header=header, comments="", fmt="%.10g")

    outputs.write_files(out.parent, {out.name: write})
    result = {"log": str(log_path), "samples": len(t), "out": str(out)}
    if motion.tau is not None:
        result["error"] = log_errors(model, motion)
    return result


def predict_log(model: Model, log: Log) -> tuple[np.ndarray, np.ndarray, Motion]:
    """Torque of a model at a log's own time stamps: times (T,), torque (T, n), and the motion used."""
    motion = prepare(log, model.filtering)
    torque = model_torque(model, motion)
    own = with_sample_times(log).t
    own = own - own[0]
    columns = [np.interp(own, motion.t, torque[:, j]) for j in range(torque.shape[1])]
    return log.t, np.column_stack(columns), motion
