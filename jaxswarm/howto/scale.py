"""Scale.

One arm: minutes. ``--budget SECONDS`` ends at the first round after that with what is known so far; an
interrupted ``diagnose`` goes on from what it has searched when the same command is given again.

Many logs of arms of one kind: ``jaxswarm diagnose --fleet LOGS --robot R --out DIR`` (``pip install
'jaxswarm[fleet]'``) takes a folder, a glob or an address, works on ``--workers N`` processes or an existing
``--scheduler``, writes a file a log and one table, and goes on where it was stopped. A bad log is a row with
its reason. ``--against fleet`` tells arms that differ from their sisters.

Long logs are reduced to a triangular factor once: searches then cost the square of the number of parameters,
whatever the length. Searches of the swarm engine run by the thousand on one device, all with one program:

>>> import jax
>>> import jaxswarm
>>> space = jaxswarm.Space(x=(-5.0, 5.0))
>>> keys = jax.random.split(jax.random.key(0), 100)
>>> found = jaxswarm.minimize_runs(lambda p, a: (p["x"] - 2) ** 2, jaxswarm.gpso(10), space, keys, num_steps=40)
>>> found.value.shape
(100,)

``minimize_sharded`` spreads the runs over devices with the same numbers, ``minimize_resumable`` keeps them on
disk, and ``Driver`` hands candidates to programs that JAX cannot trace.

Thousands of tasks and searches fit into one process: compiled programs are let go of before Linux has no
memory maps left for it, and what is called again is compiled again.
"""
