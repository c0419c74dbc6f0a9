"""Your log.

Time, positions and torques of every joint, in SI units, are enough; velocities, currents and temperatures are
used where they are there. CSV, NPZ, MAT, Parquet, HDF5, LeRobot sets and MCAP recordings are read
(``pip install 'jaxswarm[formats]'`` for all of them). Other names and units are said once, as an option or in
a TOML file: ``--columns 't=Time:ms,q=Axis{k} pos:deg'``; ``--topic``, ``--side motor`` or ``link`` and
``--effort torque`` or ``current`` say what a recording leaves open.

Look first: ``jaxswarm inspect arm.csv --robot arm.urdf --out seen`` says what is in it before anything is
fitted: rate, jitter and gaps, noise, ranges, how much of speed, load and reversals it covers, and which base
parameters could be identified. From arrays:

>>> import numpy as np
>>> import jaxswarm
>>> t = np.arange(0.0, 6.0, 0.01)
>>> q = 0.2 * np.sin(2.5 * t)[:, None]
>>> log = jaxswarm.log_from_arrays(t, q, 30.0 * 0.5 * np.cos(2.5 * t)[:, None], joints=("slide",))
>>> log.q.shape
(600, 1)

Log at 100 Hz or more, start and end at rest, move every joint at creeping and at full speed and in both
directions, and record a second, different motion: ``--validation other.csv`` is the only proof that counts.
Twenty seconds are plenty for six joints. ``jaxswarm excite`` plans a motion that is worth logging.

Degrees, milliseconds, a flipped torque or swapped joints are refused with the reason, before a fit. If the
log is right nevertheless, ``--accept NAME`` goes on with the finding that the message names.
"""
