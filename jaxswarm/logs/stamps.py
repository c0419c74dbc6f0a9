"""Time stamps as seconds: stamps count from the first one, in whole nanoseconds so that no digits are lost."""

import numpy as np


def seconds(name: str, values: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Time stamps as seconds from the first one, durations as seconds, and notes (T,).

    >>> seconds("t", np.array(["2026-01-01T00:00:01", "2026-01-01T00:00:03"], dtype="datetime64[s]"))[0]
    array([0., 2.])
    """
    missing = np.isnat(values)
    exact = values.astype(f"{values.dtype.kind}8[ns]")
    start, notes = np.timedelta64(0, "ns"), []
    if values.dtype.kind == "M" and not missing.all():
        start = exact[~missing][0]
        notes = [f"{name} counts seconds from the first stamp, {start}."]
    counted = (exact - start).astype(np.int64) * 1e-9
    return np.where(missing, np.nan, counted), notes
