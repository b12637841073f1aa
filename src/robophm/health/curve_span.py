"""How far ahead the curves of a robot are drawn if nothing is said."""

from __future__ import annotations

import math
from collections.abc import Iterable

from robophm.health.prognosis import RemainingLife

USUAL = 10_000.0
"""Hours of calendar time ahead, where no life is known to end."""

LEAST = 1e-6
"""Hours of operation, of a robot that has failed: a curve has two ends."""


def curve_span(lives: Iterable[RemainingLife | None], operating: float) -> float:
    """Hours of operation until 95 % have failed in the view in which they last longest.

    ``lives`` are those of the views, None where one is not known; ``operating`` is the share of time that it works.
    """
    ends = [life.late for life in lives if life is not None and math.isfinite(life.late)]
    return max(max(ends, default=USUAL) * operating, LEAST)
