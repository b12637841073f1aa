"""How far ahead the curves of a robot are drawn where nobody says a horizon."""

from __future__ import annotations

import math
from collections.abc import Iterable

from robophm.health.prognosis import RemainingLife

USUAL = 10_000.0
"""The hours of calendar time ahead that are drawn where no life is known to end."""

LEAST = 1e-6
"""The least hours of operation: a curve has two ends, also that of a robot that has failed."""


def curve_span(lives: Iterable[RemainingLife | None], operating: float) -> float:
    """Give the hours of operation until 95 % of such robots have failed, in the view in which they last longest.

    ``lives`` are those of the views, None where one is not known; ``operating`` is the share of time that it works.
    """
    ends = [life.late for life in lives if life is not None and math.isfinite(life.late)]
    return max(max(ends, default=USUAL) * operating, LEAST)
