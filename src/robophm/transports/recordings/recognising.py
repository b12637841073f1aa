"""The format of a recording, told by its content, whatever the file is called and however it is compressed."""

from __future__ import annotations

import functools
from errno import ELOOP, ENOENT, ENOTDIR
from pathlib import Path
from stat import S_ISREG
from typing import NamedTuple

from robophm.core.errors import PlugError
from robophm.core.registry import load_plug, plugs
from robophm.transports.recordings.format import RecordingFormat
from robophm.transports.recordings.packed import head_of
from robophm.transports.recordings.unchanged import State, settled

FORMATS = "robophm.transports.recordings.formats"
"""The plug folder, and the group of entry points of other packages."""

_NOTHING = (ENOENT, ENOTDIR, ELOOP)
"""Errors of the system that say that there is nothing, or a link that leads nowhere."""

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
    """The suffixes by which recordings are told where their content does not tell."""
    return frozenset(suffix for one in formats().values() for suffix in one.suffixes)


def usual_suffixes() -> frozenset[str]:
    """The usual suffixes of recordings of all formats, those among them that tell nothing."""
    return suffixes().union(*(one.ambiguous_suffixes for one in formats().values()))


class Look(NamedTuple):
    """A first look at a regular file."""

    kind: RecordingFormat | None
    """The format that recognises what the file begins with, or else the one that its suffix is of; None else."""
    packed: bool
    """Whether it is compressed as a whole."""
    state: State | None
    """The state of the file; None where a later change might not show in it."""


def look_at(path: Path) -> Look | None:
    """Look at a file; None where there is no regular one: a pipe would be empty when it is read. Raises OSError.

    The suffix may be right where a head is damaged, and where a format has no mark.
    """
    try:
        stat = path.stat()
    except OSError as error:
        if error.errno not in _NOTHING:
            raise
        return None
    if not S_ISREG(stat.st_mode):
        return None
    state = settled(stat)
    return _of_state(path, state) if state else _of_content(path, state)


@functools.lru_cache(maxsize=8192)
def _of_state(path: Path, state: State) -> Look:
    return _of_content(path, state)


def _of_content(path: Path, state: State | None) -> Look:
    head, packed = head_of(path)
    suffix = _suffix(path)
    each = sorted(formats().values(), key=lambda one: suffix not in one.suffixes)  # those of this suffix first
    named = each[0] if each and suffix in each[0].suffixes else None
    return Look(next((one for one in each if head and one.recognises(head)), named), packed, state)


def _suffix(path: Path) -> str:
    if path.suffix.lower() in _PACKED:
        path = path.with_suffix("")
    return path.suffix.lower()
