"""Reading of damaged recordings: the messages that are whole, with notes of what is lost."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from robophm.transports.recordings.recording import Recording
from robophm.transports.signals.source import SignalColumns


class Salvage(Recording):
    """One drive, some of whose files may be damaged, as when the robot lost its power: what is left is read.

    When its topics begin and end is what its messages say that can be read, and not what the files claim.

    Raises SourceError where a file is missing or no recording, or no message can be found.
    """

    _salvages = True

    def __init__(self, *paths: str | Path) -> None:
        super().__init__(*paths)
        lost = self.lost()
        self._damage = [f"damaged, and read as far as it is whole: {what}" for what in lost[:1]]
        self._found.update(self._damage)

    def columns(self, signals: Collection[str], since: int) -> Iterator[Mapping[str, SignalColumns]]:
        """Yield the samples of these signals that are whole."""
        for block in super().columns(signals, since):
            self.notes.update(set(self._damage) - self.notes.keys())
            yield block
