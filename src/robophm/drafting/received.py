"""Files handed in for a robot that is to be drafted: kept in one folder, within bounds, told by their content."""

from __future__ import annotations

import shutil
import tempfile
import threading
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Literal

from robophm.core.errors import RobophmError, nearest
from robophm.design.importers.bom.reading import read_parts
from robophm.design.importers.urdf import read_urdf
from robophm.drafting.answers import Known
from robophm.drafting.drafting import evidence
from robophm.transports.recordings.files import reading
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.packed import head_of
from robophm.transports.recordings.recognising import look_at, usual_suffixes

Kind = Literal["description", "recording", "parts list"]

MOST_FILES = 100
MOST_BYTES = 8_000_000_000
"""The most bytes of all files together."""

SPARED = 500_000_000
"""Bytes of the disk that are left to others."""

DESCRIPTIONS = (".urdf", ".xacro")
LISTS = (".csv", ".tsv", ".txt", ".xlsx", ".ods")


@dataclass(frozen=True)
class ReceivedFile:
    """A file that was handed in, and what it was taken for."""

    path: Path
    kind: Kind
    size: int

    @property
    def name(self) -> str:
        """The name of the file in its folder."""
        return self.path.name


def kind_of(path: Path) -> Kind:
    """The kind of a file, by its content. Raises RobophmError for one that cannot be read as any."""
    with reading(path):
        head, _ = head_of(path)
        look = look_at(path)
        format_ = look.kind if look else None
    suffix = path.suffix.lower()
    if suffix in DESCRIPTIONS or head.lstrip(b"\xef\xbb\xbf \t\r\n").startswith(b"<"):
        read_urdf(path)
        return "description"
    if format_ and (suffix not in LISTS or format_.recognises(head)):
        with open_source(path):
            return "recording"
    if suffix in LISTS:
        read_parts(path)
        return "parts list"
    lists, recorded = (", ".join(endings()[kind]) for kind in ("parts list", "recording"))
    says = f"tells nothing of a robot; expected its URDF, a recording ({recorded}) or a parts list ({lists})"
    raise RobophmError(f"{path.name}: {says}")


def endings() -> dict[Kind, tuple[str, ...]]:
    """Return how names of files of each kind usually end; what a file holds decides."""
    return {"description": DESCRIPTIONS, "recording": tuple(sorted(usual_suffixes())), "parts list": LISTS}


class ReceivedFiles:
    """The files that were handed in, in a folder that is made for the first of them; for any number of threads."""

    def __init__(self, folder: Path, recordings: Sequence[Path] = ()) -> None:
        """``recordings``: further ones, which lie elsewhere and are left there."""
        self.folder = folder
        self._elsewhere = tuple(recordings)
        self._lock = threading.RLock()
        self._kinds: dict[tuple[str, int, int], Kind] = {}
        self._known: tuple[tuple[Path, ...], Known] | None = None

    def all(self) -> list[ReceivedFile]:
        """All files, in the order of their names."""
        with self._lock:
            paths = sorted(self.folder.iterdir()) if self.folder.is_dir() else []
            return [found for path in paths if path.is_file() and (found := self._file(path))]

    def of_kind(self, kind: Kind) -> list[ReceivedFile]:
        """The files of this kind."""
        return [one for one in self.all() if one.kind == kind]

    @property
    def recordings(self) -> tuple[Path, ...]:
        """The recordings that were handed in, and those that lie elsewhere."""
        return (*self._elsewhere, *(one.path for one in self.of_kind("recording")))

    @property
    def room(self) -> int:
        """How many bytes more may be handed in."""
        held = sum(one.size for one in self.all())
        return max(0, min(MOST_BYTES - held, shutil.disk_usage(self.folder.parent).free - SPARED))

    def begin(self, name: str) -> Arrival:
        """Begin to take a file, of whose name only the last step counts. Raises RobophmError where there is no room."""
        name = file_name(name)
        if len(self.all()) >= MOST_FILES:
            raise RobophmError(f"{name}: {MOST_FILES} files are here already; take one away first")
        try:
            self.folder.mkdir(exist_ok=True)
            place = Path(tempfile.mkdtemp(dir=self.folder, prefix=".arriving-"))
            return Arrival(self, place / name, (place / name).open("wb"), self.room)
        except OSError as error:
            raise RobophmError(f"{self.folder}: cannot be written: {error.strerror}") from None

    def keep(self, arrived: Path) -> None:
        """Keep a file that is whole. One of the same name is replaced, and of a second URDF the first is.

        Raises RobophmError where it cannot be read as anything that tells of a robot.
        """
        try:
            kind = kind_of(arrived)
        except RobophmError as error:
            raise RobophmError(str(error).replace(f"{arrived.parent}/", "")) from None
        with self._lock:
            others = self.of_kind("description") if kind == "description" else []
            arrived.replace(self.folder / arrived.name)
            for one in others:
                if one.name != arrived.name:
                    one.path.unlink(missing_ok=True)

    def remove(self, name: str) -> None:
        """Take a file away. Raises RobophmError where there is none of that name."""
        with self._lock:
            known = {one.name: one for one in self.all()}
            if name not in known:
                raise RobophmError(f"no file '{name:.100}'{nearest(name, known)}")
            known[name].path.unlink(missing_ok=True)

    def evidence(self) -> Known:
        """All that the files tell of the robot, read once. Raises RobophmError for one that cannot be read."""
        with self._lock:
            described = [one.path for one in self.of_kind("description")]
            paths = (*described, *self.recordings)
            if self._known is None or self._known[0] != paths:
                self._known = paths, evidence(next(iter(described), None), self.recordings)
            return self._known[1]

    def _file(self, path: Path) -> ReceivedFile | None:
        """A file and its kind, which is looked for once; None where it is none of them."""
        try:
            stat = path.stat()
            key = (path.name, stat.st_mtime_ns, stat.st_size)
            if key not in self._kinds:
                self._kinds[key] = kind_of(path)
                self._known = None
            return ReceivedFile(path, self._kinds[key], stat.st_size)
        except (OSError, RobophmError):
            return None


@dataclass
class Arrival:
    """A file that comes piece by piece; until it is kept, nothing is changed, and what is refused leaves nothing."""

    files: ReceivedFiles
    path: Path
    file: BinaryIO
    left: int
    """Bytes that may still come."""

    def write(self, piece: bytes) -> None:
        """Take the next piece. Raises RobophmError where there is no room for it."""
        self.left -= len(piece)
        if self.left < 0:
            raise RobophmError(f"{self.path.name}: there is no room for it; {too_large(self.files.room)}")
        try:
            self.file.write(piece)
        except OSError as error:
            raise RobophmError(f"{self.path.name}: cannot be written: {error.strerror}") from None

    def keep(self) -> None:
        """Keep the file, which is whole. Raises RobophmError as ``ReceivedFiles.keep``."""
        self.file.close()
        self.files.keep(self.path)

    def close(self) -> None:
        """Let go of it, whatever has come."""
        self.file.close()
        shutil.rmtree(self.path.parent, ignore_errors=True)
        with suppress(OSError):
            self.files.folder.rmdir()  # where nothing is in it


def too_large(room: int) -> str:
    """Advice on a file that there is no room for."""
    return (
        f"{room / 1e9:.2g} GB may still come; a recording can stay where it is: `robophm serve --replay FILE`, "
        "or hand in a part of it"
    )


def file_name(name: str) -> str:
    """The last step of a file's name, which leads nowhere else."""
    last = name.replace("\\", "/").rpartition("/")[2]
    kept = "".join(letter if letter.isalnum() or letter in "._- " else "_" for letter in last).lstrip(".")
    return kept[-60:].strip() or "file"
