"""Backtests of wear as predictions of remaining lives, which ``robophm calibrate`` scores."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robophm.calibration.predictions import LEVELS, Lives
from robophm.learning.wear.backtest import Backtest


def lives_of(backtests: Sequence[Backtest]) -> Lives:
    """Return a row for each cut at which anything was foretold, numbered by backtest; on the parts' own clocks.

    Whatever these count is taken for hours. Raises ModelError where nothing was foretold.
    """
    cuts = [(k, cut) for k, one in enumerate(backtests) for cut in one.cuts if cut.forecast is not None]
    return Lives(
        np.array([k for k, _ in cuts], dtype=np.intp),
        np.array([cut.time for _, cut in cuts]),
        np.array([cut.quantiles(LEVELS) for _, cut in cuts]).reshape(-1, len(LEVELS)),
        np.array([float(np.mean(cut.forecast.passage <= cut.left)) for _, cut in cuts if cut.forecast]),
        np.array([cut.left for _, cut in cuts]),
        np.zeros(len(cuts), dtype=np.bool_),
    )
