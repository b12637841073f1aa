"""A clock that jumps ahead, and what it says meanwhile: set aside until later samples confirm that the time is so."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import UTC, datetime, timedelta

from robophm.core.signal import CLOCK, HOUR, SECOND, Sample

CLOCK_JUMP = 400 * 24 * HOUR
"""Nanoseconds by which a sample may be ahead of all before it and count at once: a robot may rest for a year."""

CONFIRMED = 600 * SECOND
"""Nanoseconds that the samples ahead must span before they are believed."""

MOST_ASIDE = 200_000
"""Samples that are set aside at most; of what comes beyond them none is kept."""


def stretches(spans: Iterable[tuple[int, int]], gap: int) -> list[tuple[int, int]]:
    """Spans of time [ns] in order, those as one that overlap or are at most ``gap`` [ns] apart."""
    found: list[tuple[int, int]] = []
    for begin, end in sorted(spans):
        if found and begin - found[-1][1] <= gap:
            found[-1] = found[-1][0], max(found[-1][1], end)
        else:
            found.append((begin, end))
    return found


class ClockJumps:
    """Decides sample by sample, in order of arrival, by times alone: what counts now, later, or never."""

    def __init__(self, newest: int, aside: Iterable[int] = ()) -> None:
        """``newest`` is the latest time that counts [ns], ``aside`` the times of samples that are set aside."""
        self.newest = newest
        self._first = self._last = 0
        self.count = 0
        """Number of samples that are set aside."""
        for time in aside:
            self._set_aside(time)

    def ahead(self, time: int) -> bool:
        """Whether a sample is too far ahead to count at once."""
        return time > self.newest + CLOCK_JUMP

    def hear(self, time: int) -> str:
        """Judge one more sample: it ``counts`` (and those set aside never will), ``waits`` with those, or ``confirms``
        them.

        ``full``: it would have to wait, and there is no room.
        """
        if not self.ahead(time):
            self.newest = max(self.newest, time)
            self.count = 0
            return "counts"
        first, last = (min(self._first, time), max(self._last, time)) if self.count else (time, time)
        if last - first >= CONFIRMED:
            self.newest, self.count = last, 0
            return "confirms"
        if self.count >= MOST_ASIDE:
            return "full"
        self._set_aside(time)
        return "waits"

    def _set_aside(self, time: int) -> None:
        self._first, self._last = (min(self._first, time), max(self._last, time)) if self.count else (time, time)
        self.count += 1


def why_not(sample: Sample) -> str:
    """The reason by which a sample is counted that a jump of the clock made; "" of the clock's own."""
    if sample.signal == CLOCK:
        return ""
    moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(seconds=sample.time // SECOND)
    return f"the clock had jumped ahead, to {moment:%Y-%m}: {sample.signal}"


def waiting(newest: int, aside: Sequence[Sample]) -> str:
    """Say in words that samples are set aside, and what will make them count."""
    first = min(sample.time for sample in aside)
    moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(seconds=first // SECOND)
    return (
        f"{len(aside)} samples set aside: the clock jumped ahead by {(first - newest) / HOUR:,.0f} h, to "
        f"{moment:%Y-%m-%d %H:%M:%S} UTC; they count once {CONFIRMED // SECOND // 60} min of such samples confirm it"
    )
