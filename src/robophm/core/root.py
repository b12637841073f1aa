"""The root of a function: SciPy's, which takes longer to load than most commands to answer."""

from __future__ import annotations

from collections.abc import Callable


def root(function: Callable[[float], float], low: float, high: float, *, within: float = 2e-12) -> float:
    """Return where a function is 0 between two places at which its signs differ, ``within`` so much.

    Raises ValueError where they do not differ. Source: Brent, Algorithms for Minimization Without Derivatives (1973),
    ch. 4.
    """
    from scipy.optimize import brentq

    return float(brentq(function, low, high, xtol=within))
