"""The named optimizers, with what each is and where it comes from."""

from collections.abc import Callable
from typing import Any, NamedTuple

from jaxswarm.errors import InputError, nearest
from jaxswarm.swarm.optimizers.aelspso import aelspso
from jaxswarm.swarm.optimizers.auto import auto
from jaxswarm.swarm.optimizers.clpso import clpso
from jaxswarm.swarm.optimizers.cma_es import cma_es
from jaxswarm.swarm.optimizers.cma_restarts import bipop_cma_es, ipop_cma_es
from jaxswarm.swarm.optimizers.de import de
from jaxswarm.swarm.optimizers.ga import ga, textbook_ga
from jaxswarm.swarm.optimizers.lm_ma_es import lm_ma_es
from jaxswarm.swarm.optimizers.lshade import lshade
from jaxswarm.swarm.optimizers.open_es import open_es
from jaxswarm.swarm.optimizers.pso import pso
from jaxswarm.swarm.optimizers.published import gpso, spso, spso2011
from jaxswarm.swarm.optimizers.random_search import random_search
from jaxswarm.swarm.optimizers.sep_cma_es import sep_cma_es
from jaxswarm.swarm.optimizers.sepso import sepso
from jaxswarm.swarm.optimizers.shade import shade
from jaxswarm.swarm.optimizers.snes import snes

__all__ = ["OPTIMIZERS", "Entry", "find_optimizer"]


class Entry(NamedTuple):
    """One named optimizer.

    Attributes:
      factory: builds it; every argument has a default.
      description: one line.
      reference: the publication of its rule.
      reconstruction: whether the rule, or a part of it, is not stated in its source.
      scheduled: whether the factory takes ``num_steps``, the length of its schedules; without it
        they last as long as the run.
    """

    factory: Callable[..., Any]
    description: str
    reference: str
    reconstruction: bool = False
    scheduled: bool = False


OPTIMIZERS: dict[str, Entry] = {
    "pso": Entry(
        pso,
        "global-best swarm; every part can be exchanged",
        "Kennedy & Eberhart 1995; Trelea 2003, doi 10.1016/S0020-0190(02)00447-7",
    ),
    "spso": Entry(
        spso,
        "plain inertia-weight swarm, the rival of the SEPSO paper",
        "Shi & Eberhart 1998; Clerc 2012, hal-00764996",
    ),
    "gpso": Entry(
        gpso,
        "global-best swarm of the RX60 paper: falling inertia, limited velocity",
        "Shi & Eberhart 1998, doi 10.1109/ICEC.1998.699146",
        reconstruction=True,
        scheduled=True,
    ),
    "sepso": Entry(
        sepso,
        "social emotional swarm, variants R1, R2, R3",
        "after Xu, Cui & Zeng 2010, doi 10.1007/978-3-642-17563-3_68",
        reconstruction=True,
        scheduled=True,
    ),
    "aelspso": Entry(
        aelspso,
        "adaptive inertia by evolutionary state, elitist learning of the leader",
        "Zhan, Zhang, Li & Chung 2009, doi 10.1109/TSMCB.2009.2015956",
        scheduled=True,
    ),
    "ga": Entry(
        ga,
        "real-coded genetic algorithm: tournament, SBX, polynomial mutation",
        "Deb & Agrawal 1995; Deb 2000, doi 10.1016/S0045-7825(99)00389-8",
    ),
    "textbook_ga": Entry(
        textbook_ga,
        "roulette on 1/value, arithmetic crossover, uniform mutation, one elite",
        "Goldberg 1989",
    ),
    "spso2011": Entry(
        spso2011,
        "standard PSO 2011: rotation-invariant ball, random informants",
        "Zambrano-Bigiarini, Clerc & Rojas 2013, doi 10.1109/CEC.2013.6557848",
    ),
    "clpso": Entry(
        clpso,
        "comprehensive learning swarm for many local optima",
        "Liang, Qin, Suganthan & Baskar 2006, doi 10.1109/TEVC.2005.857610",
        scheduled=True,
    ),
    "de": Entry(
        de,
        "classic differential evolution",
        "Storn & Price 1997, doi 10.1023/A:1008202821328",
    ),
    "shade": Entry(
        shade,
        "differential evolution with success history",
        "Tanabe & Fukunaga 2013, doi 10.1109/CEC.2013.6557555",
    ),
    "lshade": Entry(
        lshade,
        "success history with a shrinking population",
        "Tanabe & Fukunaga 2014, doi 10.1109/CEC.2014.6900380",
        scheduled=True,
    ),
    "cma_es": Entry(
        cma_es,
        "covariance matrix adaptation",
        "Hansen 2016, arXiv 1604.00772",
    ),
    "ipop_cma_es": Entry(
        ipop_cma_es,
        "covariance matrix adaptation, restarted with doubled populations",
        "Auger & Hansen 2005, doi 10.1109/CEC.2005.1554902",
    ),
    "bipop_cma_es": Entry(
        bipop_cma_es,
        "covariance matrix adaptation, restarted with large and small populations in turn",
        "Hansen 2009, doi 10.1145/1570256.1570333",
    ),
    "sep_cma_es": Entry(
        sep_cma_es,
        "standard deviations without correlations, in linear time",
        "Ros & Hansen 2008, doi 10.1007/978-3-540-87700-4_30",
    ),
    "lm_ma_es": Entry(
        lm_ma_es,
        "correlations of many dimensions from a few remembered directions",
        "Loshchilov, Glasmachers & Beyer 2019, doi 10.1109/TEVC.2018.2855049",
    ),
    "snes": Entry(
        snes,
        "separable natural evolution strategy",
        "Schaul, Glasmachers & Schmidhuber 2011, doi 10.1145/2001576.2001692",
    ),
    "open_es": Entry(
        open_es,
        "smoothed gradient from mirrored samples, followed by Adam",
        "Salimans, Ho, Chen, Sidor & Sutskever 2017, arXiv 1703.03864",
        scheduled=True,
    ),
    "auto": Entry(
        auto,
        "a strategy chosen from dimension, budget, parallel width and noise",
        "its head states the rules",
    ),
    "random_search": Entry(
        random_search,
        "uniform candidates: the yardstick",
        "Bergstra & Bengio 2012",
    ),
}
"""Name -> :class:`Entry`, in the order in which they are listed."""


def find_optimizer(name: str) -> Entry:
    """Return the entry of a name, or raise :class:`InputError` that offers the nearest ones.

    >>> find_optimizer("cmaes")
    Traceback (most recent call last):
        ...
    jaxswarm.errors.InputError: optimizer='cmaes' is unknown...cma_es...
    """
    if name not in OPTIMIZERS:
        raise InputError(f"optimizer={name!r} is unknown. {nearest(str(name), OPTIMIZERS)}")
    return OPTIMIZERS[name]
