"""Recordings that lie elsewhere: a copy here that has as much of them as was asked for.

The copy is as large as the recording, and empty but for what was fetched; who reads says what will be needed before.
"""

from __future__ import annotations

import logging
import os
import re
import shutil
import tempfile
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from threading import Lock

import numpy as np

from robophm.core.errors import PlugError, SourceError, nearest
from robophm.core.registry import load_plug, plugs
from robophm.transports.recordings.format import MessageFormat
from robophm.transports.recordings.place import Place, Range, RangesError, RemoteFile, without_query
from robophm.transports.recordings.recognising import look_at

PLACES = "robophm.transports.recordings.places"
"""The plug folder, and the group of entry points of other packages."""

BLOCK = 1 << 14
"""Bytes that are fetched at least."""

_NEAR = 4
"""Blocks that are fetched along, where they lie between two that are wanted."""

_MOST = 1 << 22
"""Bytes of one request."""

SMALL = 1 << 20
"""Bytes of a recording that is fetched as a whole: to ask for parts would take as long, and splits are read so."""

_EDGE = 1 << 16
"""Bytes at the beginning, in the middle and at the end by which a recording is recognised and told from others."""

_LEFT = 2
"""The divisor of the free room for temporary files: a copy takes at most this part of it."""

_ADDRESS = re.compile(r"([a-z][a-z0-9+.-]+):/+(.+)", re.IGNORECASE | re.DOTALL)
_HERE = type(Path())
_log = logging.getLogger(__name__)
_lock = Lock()


@cache
def _places() -> dict[str, Place]:
    """The place of each scheme. Raises PlugError where a plug has none."""
    found: dict[str, Place] = {}
    for name in plugs(PLACES):
        module = load_plug(PLACES, name, "place of recordings")
        place = getattr(module, "PLACE", None)
        if not isinstance(place, Place):
            raise PlugError(f"place of recordings '{name}': {module.__name__} has no PLACE; expected a Place")
        found |= dict.fromkeys(place.schemes, place)
    return found


class Fetched:
    """A file elsewhere, and a copy of it with what was fetched."""

    def __init__(self, file: RemoteFile, path: Path) -> None:
        self._file = file
        self._path = path
        self._there = np.zeros(-(-file.size // BLOCK), np.bool_)
        self._lock = Lock()
        self.fetched = 0
        """The number of bytes that were fetched."""
        with path.open("wb") as copy:
            copy.truncate(file.size)

    def bring(self, ranges: Iterable[Range]) -> None:
        """Fetch what of these bytes is not here. Raises SourceError where it cannot be had."""
        with self._lock:
            wanted = np.zeros_like(self._there)
            for start, end in ranges:
                wanted[max(0, start) // BLOCK : -(-min(end, self._file.size) // BLOCK)] = True
            if not (wanted & ~self._there).any():
                return
            try:
                self._write(self._file.parts(self._runs(wanted & ~self._there)))
            except RangesError:
                self._bring_whole("what serves it knows no ranges of bytes")
            if (wanted & ~self._there).any():  # what is empty would be read as zeros
                raise SourceError(f"{self._path}: cannot be read: fewer bytes came than were asked for")

    def bring_all(self, why: str) -> None:
        """Fetch all that is not here yet, and say ``why``."""
        with self._lock:
            if not self._there.all():
                self._bring_whole(why)

    def _bring_whole(self, why: str) -> None:
        size = self._file.size
        if size > shutil.disk_usage(self._path.parent).free // _LEFT:
            raise SourceError(f"{self._path}: has {size / 1e6:,.0f} MB; they do not fit on the disk here")
        if size > SMALL:
            _log.warning("%s: all of %.1f MB is fetched: %s", self._path, size / 1e6, why)
        begin = 0

        def parts() -> Iterable[tuple[int, bytes]]:
            nonlocal begin
            for part in self._file.whole():
                yield begin, part
                begin += len(part)

        self._write(parts())
        if begin != size:
            raise SourceError(f"{self._path}: has {begin} bytes; expected {size}")
        self._there[:] = True

    def _runs(self, missing: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> list[Range]:
        """What to ask for: blocks that are near each other at once."""
        blocks = np.flatnonzero(missing)
        ends = np.flatnonzero(np.diff(blocks) > _NEAR)
        runs: list[Range] = []
        for first, last in zip(blocks[[0, *(ends + 1)]].tolist(), blocks[[*ends, -1]].tolist(), strict=True):
            stop = min((last + 1) * BLOCK, self._file.size)
            runs += [(start, min(start + _MOST, stop)) for start in range(first * BLOCK, stop, _MOST)]
        return runs

    def _write(self, parts: Iterable[tuple[int, bytes]]) -> None:
        with self._path.open("rb+", buffering=0) as copy:
            for start, content in parts:
                end = start + len(content)
                if end > self._file.size:
                    raise SourceError(f"{self._path}: has more bytes than the {self._file.size} that were said")
                copy.seek(start)
                copy.write(content)
                self.fetched += len(content)
                self._there[start // BLOCK : end // BLOCK + (end == self._file.size)] = True
        os.utime(self._path, (self._file.changed, self._file.changed))


class RemotePath(_HERE):  # type: ignore[valid-type, misc]
    """The path of a copy here, called by the address of what it is a copy of, without what stands behind ``?``."""

    address = ""
    fetched: Fetched

    def __str__(self) -> str:
        return self.address or str(super().__str__())

    def __fspath__(self) -> str:
        return str(super().__str__())


def fetched_of(path: Path) -> Fetched | None:
    """Return what was fetched of a recording that lies elsewhere; None of one that lies here."""
    return path.fetched if isinstance(path, RemotePath) and path.address else None


def here(path: str | Path) -> Path:
    """The path itself, or that of a copy of what lies at this address.

    A recording is asked for once in a process. Raises SourceError where there is none, or nobody knows the scheme.
    """
    if isinstance(path, RemotePath):
        return path
    address = _ADDRESS.fullmatch(os.fspath(path))
    if not address or os.path.exists(path):  # noqa: PTH110  whatever a file here is called
        return path if isinstance(path, Path) else Path(path)  # to make one of one takes as long as to look
    scheme, rest = address[1].lower(), address[2]
    if scheme not in _places():
        plain = without_query(f"{scheme}://{rest}")
        raise SourceError(f"{plain}: no place of recordings '{scheme}'{nearest(scheme, _places())}")
    with _lock:
        return _arrived(f"{scheme}://{rest}", _places()[scheme])


@cache
def _arrived(address: str, place: Place) -> RemotePath:
    file = place.open(address)
    shown = without_query(address)
    if not file.size:
        raise SourceError(f"{shown}: is empty; expected a recording")
    folder = Path(tempfile.mkdtemp(dir=_folder()))
    path = RemotePath(folder / shown.rstrip("/").rpartition("/")[2])
    path.address = shown
    path.fetched = Fetched(file, path)
    edge = min(_EDGE, file.size)
    path.fetched.bring([(at, at + edge) for at in (0, file.size // 2, file.size - edge)])
    look = look_at(path)
    if file.size <= SMALL:
        path.fetched.bring_all("")
    elif not look or look.packed or not (isinstance(look.kind, MessageFormat) and look.kind.in_parts):
        path.fetched.bring_all("its format is not read in parts")
    return path


@cache
def _folder() -> str:
    """The folder of all copies, which is removed when the process ends."""
    folder = tempfile.TemporaryDirectory(prefix="robophm.")
    _kept.append(folder)
    return folder.name


_kept: list[tempfile.TemporaryDirectory[str]] = []
