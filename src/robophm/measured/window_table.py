"""Windows of signals as a table, row by row as they are over: CSV with exact times and values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from robophm.core.errors import RobophmError
from robophm.core.files import replacing
from robophm.core.signal import SECOND
from robophm.measured.recordings import Signal
from robophm.measured.statistics import Window

_COLUMNS = b"recording,signal,unit,begin,samples,known,lowest,mean,highest,deviation\n"


@contextmanager
def writing_windows(path: Path) -> Iterator[Callable[[str, Signal, Window], None]]:
    """Open a table; return what writes a window as a row. A file that was there is replaced at the end.

    Times are seconds, ``begin`` since the epoch. Raises RobophmError where it cannot be written.
    """
    try:
        with replacing(path) as stream:
            stream.write(_COLUMNS)

            def write(recording: str, signal: Signal, window: Window) -> None:
                stream.write(_row(recording, signal, window))

            yield write
    except OSError as error:
        raise RobophmError(f"{path}: cannot be written: {error.strerror or error}") from None


def _row(recording: str, signal: Signal, window: Window) -> bytes:
    begin, known = (f"{time // SECOND}.{time % SECOND:09d}" for time in (window.begin, window.held))
    figures = (window.lowest, window.mean, window.highest, window.deviation)
    quoted = '"' + recording.replace('"', '""') + '"'
    cells = (quoted, signal.name, signal.unit or "", begin, str(window.samples), known,
             *("" if math.isnan(one) else repr(one) for one in figures))  # fmt: skip
    return (",".join(cells) + "\n").encode("utf-8", "surrogateescape")
