"""Hostile inputs, faults and spoiled logs; ``python -m benchmarks.trust`` runs them.

``oracle`` says what is allowed to happen, ``good`` makes files that are right, ``mutate_*`` spoil them by
structure, ``targets`` say what reads them; ``fuzz`` and ``commands`` try many, ``faults`` kills and starves
commands, ``spoiled`` and ``null`` ask whether a log that says nothing, or something wrong, is told so.
"""
