"""The look ahead of a robot that runs: remaining lives take longer than there is between two ticks."""

from __future__ import annotations

import threading
import time

from robophm.health.report import HealthReport
from robophm.health.reporting import look_ahead, with_earlier_look

EVERY = 2.0
"""Seconds between two looks, at least."""

SHARE = 0.1
"""The largest share of time that looking ahead takes: what is heard meanwhile must not wait for it."""


class LookAhead(threading.Thread):
    """Looks ahead from the newest report that it was given, in a thread of its own; a context manager."""

    def __init__(self, *, parts: bool = True, share: float = SHARE) -> None:
        """Prepare the thread; ``parts``: look ahead at every component too; ``share`` of time that it takes at most."""
        super().__init__(name="robophm look ahead", daemon=True)
        self.latest: HealthReport | None = None
        """The newest look ahead."""
        self.fault: Exception | None = None
        """Error by which the thread ended before its time; None where it did not."""
        self._parts, self._share = parts, share
        self._given: HealthReport | None = None
        self._woken = threading.Event()
        self._closed = threading.Event()
        self._begun = 0.0

    def beside(self, now: HealthReport) -> HealthReport:
        """Return the report with the newest look ahead, and ask for another. Raises what looking ahead raised.

        Beside the first report stands the completion of its task, which is found at once; remaining lives come later.
        """
        if self.fault:
            raise self.fault
        if self.latest is None and now.task is not None:
            self.latest = look_ahead(now, remaining_life=False)
        self._given = now
        self._woken.set()
        return with_earlier_look(now, self.latest) if self.latest else now

    def run(self) -> None:
        """Compute looks ahead until ``close``."""
        while not self._closed.is_set():
            self._woken.wait()
            self._woken.clear()
            if self._closed.is_set() or self._given is None:
                continue
            self._begun = time.thread_time()
            try:
                seen = look_ahead(self._given, parts=self._parts, pause=self._pause)
                _ = seen.failures_to_come  # here, so that whoever shows it does not wait for it
                self._pause()
                self.latest = seen
            except _ClosedError:
                return
            except Exception as error:
                self.fault = error
                return
            self._closed.wait(EVERY)

    def _pause(self) -> None:
        """Pause so much longer than was worked that the work is a small share."""
        if self._closed.wait((time.thread_time() - self._begun) * (1 / self._share - 1)):
            raise _ClosedError
        self._begun = time.thread_time()

    def close(self) -> None:
        """End the thread; twice does no harm."""
        self._closed.set()
        self._woken.set()
        if self.is_alive():
            self.join()

    def __enter__(self) -> LookAhead:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class _ClosedError(Exception):
    """Nobody waits any more."""
