"""The format of a recording, told by its content, whatever the file is called and however it is compressed."""

from __future__ import annotations

import functools
from pathlib import Path

from robophm.core.errors import PlugError
from robophm.core.registry import load_plug, plugs
from robophm.transports.recordings.format import RecordingFormat
from robophm.transports.recordings.packed import head_of
from robophm.transports.recordings.unchanged import State, settled

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
    return _look(path)[0]


def is_packed(path: Path) -> bool:
    """Whether a file is compressed as a whole. Raises OSError."""
    return _look(path)[1]


def _look(path: Path) -> tuple[RecordingFormat | None, bool]:
    state = settled(path)
    return _of_state(path, state) if state else _of_content(path)


@functools.lru_cache(maxsize=8192)
def _of_state(path: Path, state: State) -> tuple[RecordingFormat | None, bool]:
    return _of_content(path)


def _of_content(path: Path) -> tuple[RecordingFormat | None, bool]:
    head, packed = head_of(path)
    suffix = _suffix(path)
    recognising = [one for one in formats().values() if head and one.recognises(head)]
    named = [one for one in formats().values() if suffix in one.suffixes]
    return next(iter([one for one in recognising if one in named] or recognising or named), None), packed


def _suffix(path: Path) -> str:
    if path.suffix.lower() in _PACKED:
        path = path.with_suffix("")
    return path.suffix.lower()
