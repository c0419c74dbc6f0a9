"""What is loaded for what: help needs no numbers, numbers no pictures, a forecast no swarm."""

import os
import subprocess
import sys

import pytest

LOADED = "import sys; sys.stderr.write(' '.join(m for m in {0!r} if m in sys.modules))"


def loaded(code: str, *modules: str) -> set[str]:
    """Which modules are there after the code has run in a fresh process."""
    told = f"{code}\n{LOADED.format(modules)}"
    done = subprocess.run([sys.executable, "-c", told], capture_output=True, text=True)
    return set(done.stderr.split())


@pytest.mark.parametrize("words", ["'--help'", "'diagnose', '--help'", "'predict', '--help'"])
def test_help_loads_no_numbers(words):
    code = f"""
import sys
sys.argv = ['jaxswarm', {words}]
from jaxswarm.cli import main
try:
    main()
except SystemExit:
    pass"""
    assert loaded(code, "jax", "numpy", "scipy", "matplotlib") == set()


@pytest.mark.parametrize("command", ["identify.run", "identify.predict"])
def test_identification_loads_no_library_for_pictures_statistics_or_simulation(command):
    code = f"import jaxswarm.{command}"
    assert loaded(code, "jax", "matplotlib", "scipy.stats", "jaxswarm.simulate") == {"jax"}


def test_a_diagnosis_loads_no_library_for_pictures():
    assert loaded("import jaxswarm.diagnose.run", "jax", "matplotlib") == {"jax"}


def test_a_diagnosis_loads_no_library_of_distributions():
    """Not even where it asks for quantiles of some, which are those that the library tells."""
    code = (
        "from jaxswarm.runtime import start; start()\n"
        "import jaxswarm.diagnose.run\n"
        "from jaxswarm.diagnose.folds.sharp import times_by_chance\n"
        "times_by_chance(7.5, 2), times_by_chance(7.5, 0)"
    )
    assert loaded(code, "jax", "scipy.stats") == {"jax"}


@pytest.mark.parametrize("freedom", [1.3, 7.5, 20.0, 133.0])
def test_quantiles_are_those_of_the_library_of_distributions(freedom):
    from scipy import stats

    from jaxswarm.diagnose.folds.sharp import times_by_chance

    assert times_by_chance(freedom, 2) == stats.f.isf(0.01, freedom, 2 * freedom)
    assert times_by_chance(freedom, 0) == stats.chi2.isf(0.01, freedom) / freedom


def test_a_diagnosis_loads_swarms_when_their_programs_are_made():
    assert loaded("import jaxswarm.diagnose.run", "jax", "jaxswarm.swarm") == {"jax"}


def test_threads_that_are_set_outside_change_no_digit():
    code = (
        "from jaxswarm.runtime import start; start()\n"
        "import hashlib, numpy as np\n"
        "x = np.random.default_rng(0).normal(size=200_000)\n"
        "print(hashlib.sha256((x @ x).tobytes()).hexdigest())"
    )
    found = set()
    for threads in ("1", "2", "4"):
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": threads}
        words = [sys.executable, "-c", code]
        done = subprocess.run(words, env=environment, capture_output=True, text=True, check=True)
        found.add(done.stdout)
    assert len(found) == 1


@pytest.mark.parametrize("command", ["diagnose", "identify"])
def test_only_a_diagnosis_runs_programs_where_they_are_asked_for(command, tmp_path):
    """Elsewhere one long program may run, and a signal has to be heard meanwhile."""
    code = (
        "import sys\n"
        "from jaxswarm import cli\n"
        f"sys.argv = ['jaxswarm', {command!r}, 'none.csv', '--robot', 'rx60', '--out', {str(tmp_path)!r}]\n"
        "try:\n    cli.main()\nexcept SystemExit as end:\n    assert end.code == 2\n"
        "import jax\n"
        "print(jax.config.values['jax_cpu_enable_async_dispatch'])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [str(command != "diagnose")]
