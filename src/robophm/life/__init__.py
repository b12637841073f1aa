"""Life distributions: how hazard depends on age. One file here is one distribution; its name is that in a design.

A new distribution is one new file with one public class derived from ``LifeDistribution``, or such a module
in somebody else's package under the entry-point group ``robophm.life``. Files are imported on first use.
"""

from __future__ import annotations

from functools import lru_cache

from robophm.core.registry import load_class, plugs
from robophm.life.distribution import LifeDistribution

__all__ = ["LifeDistribution", "life_distribution", "life_distributions"]

NOT_PLUGS = ("distribution", "side_by_side")  # the interface, and many at once


def life_distributions() -> list[str]:
    """Names of all life distributions that can be had here, sorted."""
    return plugs(__name__)


def life_distribution(name: str) -> type[LifeDistribution]:
    """The class of a life distribution by its file's name: ``life_distribution("weibull")`` is Weibull.

    Raises PlugError, with the nearest known name, where there is none.
    """
    return _loaded(name) if isinstance(name, str) else load_class(__name__, name, *_WANTED)


@lru_cache(maxsize=64)  # each part of a design asks
def _loaded(name: str) -> type[LifeDistribution]:
    return load_class(__name__, name, *_WANTED)


_WANTED: tuple[str, type[LifeDistribution]] = ("life distribution", LifeDistribution)
