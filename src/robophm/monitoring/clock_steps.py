"""Warnings about a clock that jumps while a robot is watched: else nothing would seem to happen any more."""

from __future__ import annotations

from robophm.core.signal import HOUR, SECOND
from robophm.health.clock_jumps import ClockJumps
from robophm.health.ledger import Ledger

BACK = 60 * SECOND
"""Nanoseconds behind what is integrated by which the clock, and not the way of a sample, is late."""


class ClockSteps:
    """Warns once of each step of the clock, and says once that it is over."""

    def __init__(self) -> None:
        self._now = ""

    def hear(self, time: int, ledger: Ledger) -> str:
        """Return the warning that a sample of this time [ns], which comes next, calls for; empty as a rule."""
        step, words = "", ""
        if ledger.integrated_to is not None and time < ledger.integrated_to - BACK:
            hours = (ledger.integrated_to - time) / HOUR
            step = "back"
            words = f"the clock went back by {hours:,.2f} h: nothing counts until that time has passed"
        elif ledger.newest is not None and ClockJumps(ledger.newest).ahead(time):
            step = "ahead"
            hours = (time - ledger.newest) / HOUR
            words = f"the clock jumped ahead by {hours:,.0f} h: what it says is set aside until it is confirmed"
        elif self._now:
            words = "the clock is right again: what is heard counts"
        before, self._now = self._now, step
        return words if step != before else ""
