"""Reading a verdict.

A verdict is one of five words, and goes by what every joint is left with in multiples of its noise:

>>> from jaxswarm.diagnose.decision import verdict
>>> for word in (verdict.NOTHING, verdict.EXPLAINED, verdict.PARTLY, verdict.UNEXPLAINED, verdict.CANNOT):
...     print(word)
nothing missing
explained
partly explained
unexplained
cannot be judged

Read on in this order. The sentence below the verdict has the error before and after, and on what: a
validation log is proof, held-out regions of the same log are less, and ``none`` is none. The table by joint
has the noise beside the error; ``far`` marks joints beyond twice their noise. Each effect comes with its
formula, what it means for the machine, values with 95 % intervals, and runners-up with their share of its
gain: one near 1 is as good, and the log does not tell the two apart.

``undecided`` names such a pair and how to go on: ``jaxswarm excite --separate A,B --given model.json`` plans
the motion that tells them apart. ``left without a law`` says on which joint, with which variables, in which
stretch of time and band of frequencies something remains. ``to be looked at`` lists values at a bound, with a
sign or size that no drive has, and links that no rigid body can be. ``cannot be judged`` is told of logs too
short, too slow or too contradictory; the reasons say what to record instead.

Intervals hold the noise, the correlation of the residual and, against an earlier model, the doubt of that
model. They do not hold what is wrong with the model otherwise: an interval is worth little where a joint is
far from its noise.
"""
