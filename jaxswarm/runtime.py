"""What every process that computes sets before it loads arrays: precision, threads, compiled code on disk."""

import gc
import os
from pathlib import Path

from jaxswarm import terminal


def start(queue: bool = True) -> None:
    """Double precision, one thread for small matrices, and compiled code kept on disk between commands.

    Args:
        queue: Whether compiled programs run in JAX's own threads, so that a signal is heard while a long one
            does; else in the thread that asks. A diagnosis asks for thousands of short ones while others
            search: behind their long ones in the queue its own thread stood still for a fifth of the time.
    """
    # Threads of OpenBLAS wait for each other by spinning: on a busy machine the QR of 500 x 70 numbers
    # takes a hundred times longer than with one. Read when numpy is first imported, hence here. Sums are
    # rounded by how they are shared out, so that whatever is set outside, results have the same bytes.
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    # Imports and tracing make many objects that stay: to look for garbage among them after every 700
    # takes a tenth of a short run.
    gc.set_threshold(100_000, 20, 20)
    home = terminal.find_home()
    import jax

    jax.config.update("jax_enable_x64", True)
    jax.config.update("jax_cpu_enable_async_dispatch", queue)
    cache = os.environ.get("XDG_CACHE_HOME") or (home and home / ".cache")
    if "JAX_COMPILATION_CACHE_DIR" not in os.environ and cache:
        jax.config.update("jax_compilation_cache_dir", str(Path(cache) / "jaxswarm" / "compiled"))
    # Every program: most compile in less than the second that is asked for by default, and there are dozens.
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
