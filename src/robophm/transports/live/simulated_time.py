"""The time of /clock, which a simulator or a player tells: it goes on from the robot's past, and never goes back."""

from __future__ import annotations

import time
from collections.abc import Callable

from robophm.health.clock_jumps import CLOCK_JUMP

ANEW = 1.0
"""Seconds for which /clock must have told nothing but times that do not follow on what it told before, until it is
said to begin anew. Of two simulators in one network only the one is followed."""


class SimulatedTime:
    """Tells the time that counts by what /clock says.

    The first time of /clock is believed as it is where it follows on the robot's past; otherwise, and where a simulator
    begins anew, time goes on from where it was, by as much as /clock goes on.
    """

    def __init__(
        self, known_to: Callable[[], int | None], note: Callable[[str], None], *,
        steady: Callable[[], float] = time.monotonic,
    ) -> None:  # fmt: skip
        """``known_to``: asked once, when /clock is heard first, for the time to which the past is known [ns].

        ``note`` is told in words when time does not go on as /clock says.
        """
        self._known_to, self._note, self._steady = known_to, note, steady
        self.now = 0
        """The time that counts [ns]; 0 before /clock is heard."""
        self.offset = 0
        """The time that counts less that of /clock [ns]."""
        self._said = 0
        self._apart: float | None = None
        """The moment since when no time of /clock has followed; none while they follow."""

    def hear(self, said: int) -> None:
        """/clock says this time [ns]."""
        if not self.now:
            self._begin(said)
        elif _follows(said, self._said):
            self._apart = None
        elif not self._anew():
            return
        else:
            self.offset = self.now - said
            self._note("/clock began anew; time goes on from where it was")
        self._said = said
        self.now = said + self.offset

    def _begin(self, said: int) -> None:
        known = self._known_to()
        if known is not None and not _follows(said, known):
            self.offset = known + 1 - said
            self._note("/clock does not follow on what was heard before; time goes on from there, by /clock")

    def _anew(self) -> bool:
        if self._apart is None:
            self._apart = self._steady()
            self._note("time of /clock does not follow on what it said before")
        if self._steady() - self._apart < ANEW:
            return False
        self._apart = None
        return True


def _follows(said: int, before: int) -> bool:
    return before <= said <= before + CLOCK_JUMP
