"""The interface of formats of recordings, of which each plug in ``formats/`` is one."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from robophm.transports.signals.source import SignalSource


@dataclass(frozen=True)
class RecordingFormat:
    """How files of one format are recognised; each plug has one in ``FORMAT``, of one of the two kinds below."""

    suffixes: tuple[str, ...]
    """Usual suffixes of its files, in small letters; they decide only where the content of a file does not."""
    recognises: Callable[[bytes], bool]
    """Whether a file is of this format, by its first 64 KiB or as many bytes as it has."""
    ambiguous_suffixes: tuple[str, ...] = field(default=(), kw_only=True)
    """Usual suffixes that files of any other kind have too, so that they decide nothing."""


@dataclass(frozen=True)
class SampleFormat(RecordingFormat):
    """A format whose files are opened one by one, each as a source of samples."""

    open: Callable[[Path], SignalSource]
    """The source of a file that is there. Raises SourceError where it cannot be read."""
    in_folders: bool = True
    """Whether its files are looked for in folders: not those that may repeat what lies beside them, as tables do."""


@dataclass(frozen=True)
class MessageFormat(RecordingFormat):
    """A format of files of messages: several are one drive, damaged ones are read as far as they are whole."""

    open: Callable[[Path, Counter[str]], Any]
    """The file, a ``PiecedFile``, and what is lost of it in the notes. Raises SourceError where it cannot be read."""
    in_parts: bool = False
    """Whether of a large file that lies elsewhere no more is asked for than is read, as it says before."""
