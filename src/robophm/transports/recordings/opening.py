"""The choice of the source that reads a file, by its suffix."""

from __future__ import annotations

from pathlib import Path

from robophm.core.argument_checks import path as given_path
from robophm.core.errors import SourceError
from robophm.transports.recordings.files import recognised
from robophm.transports.recordings.format import SampleFormat
from robophm.transports.recordings.packed_samples import PackedSamples
from robophm.transports.recordings.remote import here
from robophm.transports.signals.source import SignalSource


def open_source(*paths: str | Path) -> SignalSource:
    """The source that reads these files, by their content: one file of samples, or any number of files of messages.

    Of a damaged recording what is whole is read, and the notes say what is lost.

    Raises SourceError where a file is missing or cannot be read.
    """
    if not paths:
        raise SourceError("no recordings; expected at least one")
    given = [here(given_path(path, "recording", SourceError)) for path in paths]
    for path in given:
        if path.is_dir():
            continue
        kind, packed, _ = recognised(path)
        if isinstance(kind, SampleFormat):
            if len(given) > 1:
                raise SourceError(f"{path}: holds samples, and is read alone; {len(given)} files were given")
            return PackedSamples(path, kind.open) if packed else kind.open(path)
    from robophm.transports.recordings.salvage import Salvage

    return Salvage(*given)
