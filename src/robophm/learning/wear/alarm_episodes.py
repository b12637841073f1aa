"""When a change began that a CUSUM raised, and when it was over."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.learning.wear.cusum import Cusum


class Episode(NamedTuple):
    """One change; indices of readings."""

    begin: int
    """The first reading after its sum was last 0 (Page, Biometrika 41, 1954)."""
    raised: int
    """The first whose sum is beyond the limit."""
    end: int | None
    """The first after its sum was last at the limit, once it has come back to 0; None: it goes on."""
    level: float
    """Mean of its readings."""


def episodes(detector: Cusum, values: npt.ArrayLike) -> Iterator[Episode]:
    """Changes after the baseline, the first one first, up and down alike.

    While one goes on its sum is held at the limit, so that it is known to be over as soon after the change has gone as
    it was raised after it came.
    """
    y = np.asarray(values, dtype=float)
    z = ((y - detector.mean) / detector.deviation).tolist()
    found: list[Episode] = []
    for sign in (1.0, -1.0):
        total, begin, held, raised = 0.0, 0, 0, None
        for i in range(detector.readings, len(z)):
            total = max(0.0, total + sign * z[i] - detector.reference)
            if total == 0.0:
                if raised is not None:
                    found.append(Episode(begin, raised, held + 1, float(y[begin : held + 1].mean())))
                begin, raised = i + 1, None
            elif total > detector.limit:
                raised = i if raised is None else raised
                total, held = detector.limit, i
        if raised is not None:
            found.append(Episode(begin, raised, None, float(y[begin:].mean())))
    yield from sorted(found)
