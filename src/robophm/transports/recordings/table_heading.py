"""The first line of a table in CSV: which column is the time, in what unit, and what signals the others are.

Besides our own, ``time,/battery.voltage``, that of others is read: PlotJuggler's, ``__time,/battery/voltage``; of
``rostopic echo -p``, ``%time,field.voltage``; and of ulog2csv, ``timestamp,voltage_v``. The last two name no topic,
which is then called as the file.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, signal_name, split_signal

OWN = "time"
"""Name of the first column of our own tables, all of whose other columns have to be signals."""

SINCE_START = "times count from the start of the autopilot as if that were 1970"

_PX4 = re.compile(r"(?:.*\d_)?([a-z][a-z_]*)_(\d+)\Z")
"""Name of a file of ulog2csv: that of the log, which ends in a digit as PX4 names them, topic, and instance."""


@dataclass(frozen=True)
class Heading:
    """The meaning of the columns of a table."""

    unit: Decimal
    """Nanoseconds of a unit of the time in the first column."""
    signals: dict[int, str]
    """Signals by the number of their column."""
    notes: tuple[str, ...]


def heading_of(path: Path, header: Sequence[str], first: Sequence[str]) -> Heading:
    """Return what the columns of a table are, by its first two lines. Raises SourceError where it is none that is
    known.

    Of the tables of others a column without a number in its first row, or whose name can be no signal's, is left out.
    """
    if header[0] == OWN:
        return Heading(Decimal(SECOND), _own(path, header), ())
    if header[0] not in _OTHERS:
        if _is_number(header[0]):
            says = "has no names of columns; expected a line before it: of `ros2 topic echo --csv` type and topic"
            examples = "sensor_msgs/msg/BatteryState,/battery, else e.g. time,/battery.voltage"
            raise SourceError(f"{path}, line 1: {says}, e.g. {examples}")
        others = ", ".join(f"'{name}' of {other.writer}" for name, other in _OTHERS.items())
        raise SourceError(f"{path}, line 1: first column is '{header[0]}'; expected '{OWN}' and commas, or {others}")
    other = _OTHERS[header[0]]
    signals: dict[int, str] = {}
    left = []
    for number, name in enumerate(header[1:], 1):
        cell = first[number] if number < len(first) else ""
        with suppress(SourceError):
            signal = other.signal(path.stem, name)
            if (not cell or _is_number(cell)) and signal not in signals.values():
                signals[number] = signal
                continue
        left.append(name)
    if not signals:
        raise SourceError(f"{path}: holds no column of numbers that can be asked for")
    notes = [f"columns left out, without numbers or with names that are no signals: {len(left)}"] * bool(left)
    return Heading(other.unit, signals, (*notes, *([SINCE_START] if header[0] == "timestamp" else [])))


def _own(path: Path, header: Sequence[str]) -> dict[int, str]:
    for number, name in enumerate(header[1:], 2):
        try:
            split_signal(name)
        except SourceError as error:
            raise SourceError(f"{path}, line 1, column {number}: {error}") from None
        if name in header[1 : number - 1]:
            raise SourceError(f"{path}, line 1, column {number}: '{name}' is there twice")
    return dict(enumerate(header[1:], 1))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


@dataclass(frozen=True)
class _Other:
    """A program that writes tables, the unit [ns] of its times, and which signal a column is, by file and name."""

    writer: str
    unit: Decimal
    signal: Callable[[str, str], str]


def _of_path(stem: str, name: str) -> str:
    """``/battery/voltage`` is the last step of a topic before it; a dot, as of an instance, is none of ours."""
    topic, _, field = name.strip("/").rpartition("/")
    return signal_name("/" + re.sub(r"[.\s]", "_", topic or stem), field)


def _of_ros(stem: str, name: str) -> str:
    return signal_name("/" + re.sub(r"[.\s]", "_", stem), name.removeprefix("field."))


def _of_px4(stem: str, name: str) -> str:
    if found := _PX4.match(stem):
        stem = found[1] + (f"_{found[2]}" if int(found[2]) else "")
    return _of_ros(stem, name)


_OTHERS = {
    "__time": _Other("PlotJuggler", Decimal(SECOND), _of_path),
    "%time": _Other("rostopic echo -p", Decimal(1), _of_ros),
    "timestamp": _Other("ulog2csv", Decimal(1000), _of_px4),
}
"""Programs by the name of the first column that they write."""
