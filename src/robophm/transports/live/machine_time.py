"""The time of what is heard live: this machine's clock while that is plausible, else what has passed since it was.

A clock may be in 1970 until a server tells the time, in 2038 for some seconds, or set back by hours while a robot runs.
It is held against a clock that nobody sets, and against the time to which the robot's past is known.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from robophm.core.signal import HOUR, SECOND
from robophm.health.clock_jumps import CLOCK_JUMP, CONFIRMED

FIRST = 1_735_689_600 * SECOND
"""The beginning of 2025: nothing was monitored by this program before, so that a clock that says so is wrong."""

OFF = 60 * SECOND
"""Nanoseconds by which a clock that is off is told of, and followed once it is plausible; a smaller step is left out
until the next start."""


def elapsed() -> int:
    """Return nanoseconds that no setting of the clock changes, those of sleep among them where the system tells."""
    clock = getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)
    return time.clock_gettime_ns(clock)


class MachineTime:
    """Tells the time that counts, which never goes back and never jumps by more than a robot may rest.

    The machine's clock is plausible from the time that counts until ``CLOCK_JUMP`` after it. It is believed at the
    start where it is plausible against the past, and later where it was set and has stayed plausible for ``CONFIRMED``;
    meanwhile time goes on, from where the past ends, by the clock that nobody sets. Without a past, a clock from before
    ``FIRST`` is waited for as long.
    """

    def __init__(
        self, known_to: int | None, note: Callable[[str], None], *,
        clock: Callable[[], int] | None = None, steady: Callable[[], int] | None = None,
    ) -> None:  # fmt: skip
        """``known_to``: the time to which the past is known [ns]; ``note`` is told in words when the clock is set."""
        self._known_to, self._note = known_to, note
        self._clock, self._steady = clock or time.time_ns, steady or elapsed
        self._start = self._steady()
        self._offset: int | None = None
        """The time that counts less what has elapsed."""
        self._set = self._set_at = 0
        """Nanoseconds by which the clock is ahead of the time that counts, as far as it was said, and since when."""

    def now(self) -> int:
        """Return the time that counts [ns]; 0 before there is one."""
        passed, said = self._steady(), self._clock()
        if self._offset is None:
            if self._known_to is None and said < FIRST and passed - self._start < CONFIRMED:
                self._note("the clock is before 2025: nothing counts until it is set, for ten minutes at most")
                return 0
            self._begin(said, passed)
        now = passed + (self._offset or 0)
        ahead = said - now
        if abs(ahead - self._set) > SECOND:
            if abs(ahead) <= SECOND:
                self._note("the clock is right again")
            else:
                self._note(f"the clock was set {'forward' if ahead > self._set else 'back'}; time went on as it was")
            self._set, self._set_at = ahead, passed
        if ahead >= OFF and _plausible(said, now) and passed - self._set_at >= CONFIRMED:
            self._note("the clock was set forward, and is believed")
            self._offset, self._set = said - passed, 0
            return said
        return now

    def _begin(self, said: int, passed: int) -> None:
        known = self._known_to
        if known is None or _plausible(said, known):
            self._offset = said - passed
            return
        self._offset = known + 1 - passed
        self._set, self._set_at = said - known - 1, passed
        if abs(self._set) > SECOND:
            days = CLOCK_JUMP // (24 * HOUR)
            side = "before the end of the robot's past" if said < known else f"over {days} days after the robot's past"
            self._note(f"the clock is {side}; time goes on from there, until the clock is plausible")

    @property
    def ahead(self) -> float:
        """Return seconds by which the machine's clock is ahead of the time that counts; NaN where it is the same."""
        return self._set / SECOND if abs(self._set) >= OFF else float("nan")


def _plausible(said: int, known_to: int) -> bool:
    return known_to <= said <= known_to + CLOCK_JUMP
