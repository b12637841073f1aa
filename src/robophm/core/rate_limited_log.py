"""A log that repeats itself at most so often: of the same line, told again and again, the number is what matters."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable

EVERY = 60.0
"""Seconds in which the same line is written a few times."""

AT_ONCE = 5
"""Times that the same line is written in so many seconds."""

MOST_KNOWN = 1000
"""Different lines of which it is known how often they came; beyond them all is begun anew."""


class RateLimit(logging.Filter):
    """Lets the same line of a log through a few times a minute; the next that is let through says how many were not."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        super().__init__()
        self._clock = clock
        self._seen: dict[tuple[str, object], list[float]] = {}
        """When the minute of a line began, how often it was written in it, and how often it was not."""

    def filter(self, record: logging.LogRecord) -> bool:
        """Return whether the line is written; it is told by its logger and its words without what is filled in."""
        key = record.name, record.msg if isinstance(record.msg, str) else type(record.msg)
        now = self._clock()
        if key not in self._seen and len(self._seen) >= MOST_KNOWN:
            self._seen.clear()
        begun, written, left_out = self._seen.get(key, [now, 0, 0])
        if now - begun >= EVERY:
            if left_out:
                record.msg, record.args = f"{record.getMessage()} (and {left_out:,.0f} more like it before)", ()
            begun, written, left_out = now, 0, 0
        lets = written < AT_ONCE
        self._seen[key] = [begun, written + lets, left_out + (not lets)]
        return lets


def limit_rate(*names: str) -> None:
    """Limit the rate of these logs, by name."""
    limit = RateLimit()
    for name in names:
        log = logging.getLogger(name)
        for before in [one for one in log.filters if isinstance(one, RateLimit)]:
            log.removeFilter(before)
        log.addFilter(limit)
