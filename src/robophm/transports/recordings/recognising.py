"""The format of a recording, told by its content, whatever the file is called and however it is compressed."""

from __future__ import annotations

import functools
from pathlib import Path

from robophm.core.errors import PlugError
from robophm.core.registry import load_plug, plugs
from robophm.transports.recordings.format import RecordingFormat
from robophm.transports.recordings.packed import head_of

FORMATS = "robophm.transports.recordings.formats"
"""The plug folder, and the group of entry points of other packages."""

_PACKED = (".zstd", ".zst", ".gz")


@functools.cache
def formats() -> dict[str, RecordingFormat]:
    """All formats that can be had here by their names, sorted. Raises PlugError where one is none."""
    found = {}
    for name in plugs(FORMATS):
        module = load_plug(FORMATS, name, "recording format")
        found[name] = getattr(module, "FORMAT", None)
        if not isinstance(found[name], RecordingFormat):
            raise PlugError(f"recording format '{name}': {module.__name__} has no FORMAT; expected a RecordingFormat")
    return found  # type: ignore[return-value]


def suffixes() -> frozenset[str]:
    """The usual suffixes of recordings of all formats."""
    return frozenset(suffix for one in formats().values() for suffix in one.suffixes)


def format_of(path: Path) -> RecordingFormat | None:
    """The format that recognises what a regular file begins with, or else the one that its suffix is of; None else.

    The suffix may be right where a head is damaged, and where a format has no mark. Raises OSError.
    """
    head = head_of(path)
    recognising = [one for one in formats().values() if head and one.recognises(head)]
    named = [one for one in formats().values() if _suffix(path) in one.suffixes]
    return next(iter([one for one in recognising if one in named] or recognising or named), None)


def _suffix(path: Path) -> str:
    if path.suffix.lower() in _PACKED:
        path = path.with_suffix("")
    return path.suffix.lower()
