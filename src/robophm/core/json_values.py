"""Plain values that JSON can hold, which knows no number that is infinite or none."""

from __future__ import annotations

import math
from typing import Any


def plain(value: Any) -> Any:
    """Return values that JSON can hold: infinite numbers as the text "Infinity" or "-Infinity", NaN as None."""
    if isinstance(value, dict):
        return {key: plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    return value
