"""The choice of the source that reads a file, by its suffix."""

from __future__ import annotations

from pathlib import Path

from robophm.core.argument_checks import path as given_path
from robophm.core.errors import SourceError
from robophm.transports.signals.source import SignalSource


def open_source(*paths: str | Path) -> SignalSource:
    """Open the source that reads these files, by suffix: one .csv, one .journal, or any number of recordings.

    Of a damaged recording what is whole is read, and the notes say what is lost.

    Raises SourceError where a file is missing or cannot be read.
    """
    if not paths:
        raise SourceError("no recordings; expected at least one")
    paths = tuple(given_path(path, "recording", SourceError) for path in paths)
    suffixes = {Path(path).suffix.lower() for path in paths}
    if len(paths) == 1 and suffixes == {".csv"}:
        from robophm.transports.recordings.csv import CsvRecording

        return CsvRecording(paths[0])
    if len(paths) == 1 and suffixes == {".journal"}:
        from robophm.transports.recordings.journal import JournalRecording

        return JournalRecording(paths[0])
    if alone := suffixes & {".csv", ".journal"}:
        raise SourceError(f"a {min(alone)} file is read alone; {len(paths)} files were given")
    from robophm.transports.recordings.salvage import Salvage

    return Salvage(*paths)
