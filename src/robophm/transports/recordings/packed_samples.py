"""Samples of a file that is compressed as a whole: unpacked into a temporary one for as long as they are read."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from robophm.core.errors import SourceError
from robophm.core.signal import Sample
from robophm.transports.recordings.packed import Unpacked
from robophm.transports.signals.source import SignalColumns, SignalSource, TopicInfo

Item = TypeVar("Item")


class PackedSamples(SignalSource):
    """A source of an unpacked copy, under the name of the file; closing it removes the copy.

    Raises SourceError as the source does, and where the file does not unpack or would fill the disk.
    """

    def __init__(self, path: Path, opens: Callable[[Path], SignalSource]) -> None:
        self.path = path
        self._found: Counter[str] = Counter()
        self._copy = Unpacked(path, self._found)
        try:
            with self._named():
                self._source = opens(self._copy.path)
        except BaseException:
            self._copy.close()
            raise
        self.fingerprint = self._source.fingerprint
        self.ends = self._source.ends  # type: ignore[misc]

    @property
    def notes(self) -> Counter[str]:  # type: ignore[override]
        """The notes of the source, and of what could not be unpacked."""
        return self._source.notes + self._found

    def topics(self) -> list[TopicInfo]:
        """The topics of the source."""
        with self._named():
            return self._source.topics()

    def spans(self) -> list[tuple[int, int]]:
        """When the recording began and ended [ns]."""
        with self._named():
            return self._source.spans()

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        """The samples of these signals. Raises SourceError as the interface says."""
        with self._named():
            return self._each(self._source.samples(signals))

    def columns(self, signals: Collection[str], since: int) -> Iterator[Mapping[str, SignalColumns]] | None:
        """The samples by signal, where the source has columns."""
        with self._named():
            blocks = self._source.columns(signals, since)
            return None if blocks is None else self._each(blocks)

    def close(self) -> None:
        """Remove the unpacked copy; closing twice does no harm."""
        self._source.close()
        self._copy.close()

    def _each(self, items: Iterator[Item]) -> Iterator[Item]:
        with self._named():
            yield from items

    @contextmanager
    def _named(self) -> Iterator[None]:
        try:
            yield
        except SourceError as error:
            raise type(error)(str(error).replace(str(self._copy.path), str(self.path))) from None
