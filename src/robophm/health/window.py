"""The open window of a robot's signals: what has been received and not yet been integrated, signal by signal."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping

import numpy as np
import numpy.typing as npt

from robophm.core.signal import Sample

Array = npt.NDArray[np.float64]
Times = npt.NDArray[np.int64]
Columns = Mapping[str, tuple[Times, Array]]
"""Times [ns since the epoch], ascending, and values of each signal."""


class Window:
    """Samples in order of arrival, which come out in order of time; of equal times the greatest value last."""

    def __init__(self, samples: Iterable[Sample] = ()) -> None:
        self._own: dict[str, tuple[array[int], array[float]]] = {}
        self._count = 0
        for sample in samples:
            self.add(sample)

    @classmethod
    def of(cls, columns: Columns) -> Window:
        """Make a window that holds these columns."""
        window = cls()
        for signal, (times, values) in columns.items():
            if len(times):
                window._own[signal] = array("q", times.tobytes()), array("d", values.tobytes())
                window._count += len(times)
        return window

    def add(self, sample: Sample) -> None:
        """Add one more sample."""
        time, signal, value = sample
        own = self._own.get(signal)
        if own is None:
            own = self._own[signal] = array("q"), array("d")
        own[0].append(time)
        own[1].append(value)
        self._count += 1

    def __len__(self) -> int:
        return self._count

    def columns(self) -> Columns:
        """Return the samples of each signal, ascending in time."""
        return {signal: in_time(np.array(times), np.array(values)) for signal, (times, values) in self._own.items()}

    def samples(self) -> list[Sample]:
        """Return all samples, in order of time."""
        return sorted(
            Sample(time, signal, value)
            for signal, (times, values) in self._own.items()
            for time, value in zip(times, values, strict=True)
        )

    def take(self, until: int) -> Columns:
        """Take out the samples that are not later than a time [ns]."""
        both = parted(self.columns(), until)
        rest = Window.of(both[1])
        self._own, self._count = rest._own, rest._count
        return both[0]

    def copy(self) -> Window:
        """Return an independent copy of the window."""
        copy = Window()
        copy._own = {signal: (times[:], values[:]) for signal, (times, values) in self._own.items()}
        copy._count = self._count
        return copy


def newest(columns: Columns) -> int | None:
    """Return the time [ns] of the newest sample; None where there is none."""
    return max((int(times.max()) for times, _ in columns.values() if len(times)), default=None)


def parted(columns: Columns, time: int) -> tuple[Columns, Columns]:
    """Split columns into the samples not later than a time [ns], and the later ones."""
    ready, rest = {}, {}
    for signal, (times, values) in columns.items():
        split = int(np.searchsorted(times, time, side="right"))
        ready[signal] = times[:split], values[:split]
        rest[signal] = times[split:], values[split:]
    return ready, rest


def in_time(times: Times, values: Array) -> tuple[Times, Array]:
    """Sort samples by time [ns], of equal times the greatest value last."""
    if (times[1:] > times[:-1]).all():
        return times, values
    order = np.lexsort((values, times))
    return times[order], values[order]
