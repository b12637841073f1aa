"""The time since which a part is stressed beyond what it was designed for, by the course of its signal in a store."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from robophm.health.why import Explanation, ObservedStress, Since
from robophm.stores.store import POINTS, History

UNKNOWN = Since(None)


def with_since(found: Explanation, history: History | None, now: int | None) -> Explanation:
    """Return an explanation that says since when each stress has been beyond its design value, as a history tells.

    ``now``: the time [ns] of what is explained. Raises StoreError where the history cannot be read.
    """
    kept = set(history.signals()) if history else set()

    def told(one: ObservedStress) -> ObservedStress:
        if not one.beyond:
            return one
        return replace(one, since=_since(one, history, now) if history and one.signal in kept else UNKNOWN)

    parts = (replace(part, stresses=tuple(map(told, part.stresses))) for part in found.parts)
    return replace(found, parts=tuple(parts))


def _since(stress: ObservedStress, history: History, now: int | None) -> Since:
    """Look for the last mean that was not beyond, each time closer, and take the next that is known."""
    start: int | None = None
    end: int | None = None
    while True:
        course = history.course(stress.signal, start, end, POINTS)
        known = np.flatnonzero(course.number[:, 0])
        if not len(known):
            return UNKNOWN
        times = course.times[known]
        nearest = (course.low if stress.higher else course.high)[known, 0]
        within = np.flatnonzero(nearest <= stress.as_designed if stress.higher else nearest >= stress.as_designed)
        if not len(within):
            return Since(int(times[0]))
        last = int(within[-1])
        after = int(times[last])
        beyond = int(times[last + 1]) if last + 1 < len(times) else now
        closer = after, end if last + 1 == len(times) else int(times[last + 1]) + max(course.width, 1)
        if not course.width or closer == (start, end):
            return UNKNOWN if beyond is None else Since(beyond, after)
        start, end = closer
