"""Shared fixtures: float64 for the whole session, and the one place that finds measured data."""

import os
from pathlib import Path

# Before numpy is imported: spinning threads make small matrix factorizations crawl on busy machines.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import jax  # noqa: E402
import numpy as np  # noqa: E402
import pytest  # noqa: E402

from jaxswarm.identify.synthetic import random_links  # noqa: E402
from jaxswarm.robot import Robot  # noqa: E402
from jaxswarm.robot.load import load_robot  # noqa: E402
from jaxswarm.room import room_for_programs  # noqa: E402

jax.config.update("jax_enable_x64", True)


@pytest.fixture(scope="session")
def data_root() -> Path:
    """Folder with ``data/`` and ``cases/``: ``JAXSWARM_DATA``, else ``../shared`` beside the project."""
    default = Path(__file__).resolve().parents[2] / "shared"
    root = Path(os.environ.get("JAXSWARM_DATA", default))
    if not (root / "data").is_dir():
        pytest.skip(
            f"no measured data at {root}: set JAXSWARM_DATA to the folder that holds data/ and cases/"
        )
    return root


@pytest.fixture(autouse=True, scope="module")
def _room_for_programs():
    """Let go of the programs of former tests before the system has no memory maps left for more."""
    room_for_programs()


@pytest.fixture(scope="module")
def arm() -> Robot:
    """An arm of six joints with links drawn at random."""
    bare = load_robot("ur10e")
    return bare.replace(parameters=random_links(bare, np.random.default_rng(0), mass=20.0))


@pytest.fixture
def key() -> jax.Array:
    """A fixed random key."""
    return jax.random.key(0)
