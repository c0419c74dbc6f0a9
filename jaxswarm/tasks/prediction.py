"""The torque of an identified model along a log."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from jaxswarm.errors import InputError
from jaxswarm.identify.estimation.validate import log_errors
from jaxswarm.identify.forward.model import Model
from jaxswarm.identify.predict import predict_log
from jaxswarm.identify.report.errors import error_table
from jaxswarm.identify.report.summary import units
from jaxswarm.identify.run import refuse_missing_channels
from jaxswarm.logs import Log
from jaxswarm.tables import Result, Table
from jaxswarm.tasks.inputs import as_logs, as_model, in_double


@dataclass(frozen=True, eq=False, repr=False)
class Predicted(Result):
    """Predicted torques.

    Attributes:
        t: The log's own time stamps [s], (T,).
        tau: Predicted torque [N m or N], (T, n).
    """

    t: np.ndarray | None = None
    tau: np.ndarray | None = None


@in_double
def predict(model: Model | str | Path, log: Log | str | Path) -> Predicted:
    """Predict the torque of a model along a log, at the log's own time stamps.

    Args:
        model: A model, a result with one, or its ``model.json``.
        log: The motion; torque is not needed, but scored where it is there.

    Returns:
        ``t`` and ``tau``, and errors in the table where the log has torque.

    Raises:
        InputError: If the model or the log cannot be used.
    """
    model = as_model(model)
    if not isinstance(log, Log | str | Path):
        raise InputError(f"log is a {type(log).__name__}: pass one Log or one file")
    (read,) = as_logs(log, model.robot, require_torque=False)
    refuse_missing_channels(model.terms, [read])
    told = predict_log(model, read)
    t = read.t
    content: dict[str, Any] = {"log": read.source, "samples": len(t), "notes": list(told.notes)}
    tables: tuple[Table, ...] = ()
    if read.tau is not None:
        content["error"] = log_errors(told.model, *told.motions)
        rows = {read.source: content["error"]}
        tables = (error_table(model.robot.name, rows, model.robot.joints, units(model.robot)),)
    return Predicted(content, (f"{len(t)} samples of {read.source}",), tables, t=t, tau=told.tau)
