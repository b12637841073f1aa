"""How a process ends that is asked to by SIGINT or SIGTERM: at once while it begins, and in time in any case.

While it begins nothing has to be kept, and an exception raised wherever the signal finds the process would be taken by
whichever library is just imported: so none is raised.
"""

from __future__ import annotations

import os
import signal
import sys
import threading

LONGEST_END = 4.5
"""Seconds after which a process that was asked to end does so, whatever it is doing."""

SAYING = 0.2
"""Seconds that a last line has to get out; there may be nobody who reads it."""

ASKED_BY = (signal.SIGINT, signal.SIGTERM)


def end_at_once() -> None:
    """Let SIGINT and SIGTERM end this process at once, with 130 and 143; the one that it is to ignore it ignores."""
    if threading.current_thread() is threading.main_thread():
        for number in ASKED_BY:
            if signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, _at_once)


def be_interruptible() -> None:
    """Undo ``end_at_once``: SIGINT is KeyboardInterrupt, and SIGTERM what the system makes of it."""
    for number in ASKED_BY:
        if signal.getsignal(number) is _at_once:
            signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)


def ignore() -> None:
    """Take SIGINT and SIGTERM as nothing, for the process is about to end."""
    if threading.current_thread() is threading.main_thread():
        for number in ASKED_BY:
            signal.signal(number, signal.SIG_IGN)


def leave(code: int, said: str) -> None:
    """Say a line on stderr and end this process now, from any thread: a kill leaves nothing half-written either."""

    def say() -> None:
        sys.stdout.flush()
        print(said, file=sys.stderr, flush=True)

    saying = threading.Thread(target=say, daemon=True)
    saying.start()
    saying.join(SAYING)
    os._exit(code)


def leave_in_time(number: int) -> threading.Timer:
    """Count from now: after LONGEST_END this process leaves as by the signal, unless what is returned is cancelled.

    Its last seconds may be lost then, so that it is no end in order.
    """
    counting = threading.Timer(LONGEST_END, leave, (128 + number, "error: ended before all that was heard was kept"))
    counting.daemon = True
    counting.start()
    return counting


def _at_once(number: int, _frame: object) -> None:
    os.write(2, b"interrupted\n")
    os._exit(128 + number)
