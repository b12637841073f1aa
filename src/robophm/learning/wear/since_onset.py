"""The time since which wear shows: what breaks late is as sound as new for most of its life, as a bearing is.

How long such a unit goes on is told neither by its level, which wanders while it is sound, nor by its age, but by how
long others of its kind went on since their damage showed.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from robophm.core.errors import DataError
from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.models.candidates import Array

DRAWS = 400
"""Draws by which it is told whether a trend shows."""

BETWEEN = 2
"""Looks between the last one that shows nothing and the first that shows it, each of which halves what is open."""


def onset(times: Array, wear: Array) -> float | None:
    """Return since when the trend of readings towards 1 has shown to the last of them, ``wear`` as a share of the way.

    None where it does not show at the last one, or showed at half of all readings already: then it wears all its life.
    Looked for in steps back from the last one that double. Shapes (readings,).
    """
    return _onset(times.tobytes(), wear.tobytes())


@lru_cache(maxsize=64)  # the others of a kind stay as they are
def _onset(times: bytes, wear: bytes) -> float | None:
    t, y = np.frombuffer(times), np.frombuffer(wear)
    half = len(t) // 2
    if not _shows(t, y) or _shows(t[:half], y[:half]):
        return None
    back = 1
    while len(t) - back > half and _shows(t[: len(t) - back], y[: len(t) - back]):
        back *= 2
    sound, showing = max(len(t) - back, half), len(t) - back // 2
    for _ in range(BETWEEN):
        if (middle := (sound + showing) // 2) in (sound, showing):
            break
        sound, showing = (sound, middle) if _shows(t[:middle], y[:middle]) else (middle, showing)
    return float(t[showing - 1])


def _shows(t: Array, y: Array) -> bool:
    try:
        return forecast(t, y, 1.0, draws=DRAWS, judged=False).shows
    except DataError:  # too few, or it stood still until then
        return False
