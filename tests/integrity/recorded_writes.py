"""All that a process does to the files of a folder, as strace saw it."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

CALLS = (
    "openat,open,creat,write,pwrite64,lseek,fsync,fdatasync,ftruncate,rename,renameat,renameat2,unlink,unlinkat,"
    "writev,pwritev,copy_file_range,sendfile,fallocate,link,linkat"
)
NOT_UNDERSTOOD = ("writev", "pwritev", "copy_file_range", "sendfile", "fallocate", "link", "linkat")
"""Calls that change files in ways that are not followed here: one of them is an error."""

_ESCAPED = r"(?:\\x[0-9a-f]{2})*"
_LINE = re.compile(r"^(\d+) +(.*)$")
_CALL = re.compile(r"^(\w+)\((.*)\) += (-?\d+|\?)(.*)$")
_STREAM = re.compile(rf"^(\d+)<({_ESCAPED})>(\(deleted\))?")
_TEXT = re.compile(rf'"({_ESCAPED})"')


@dataclass(frozen=True)
class Write:
    """Bytes written to a file, at a place in it."""

    file: int
    at: int
    data: bytes


@dataclass(frozen=True)
class Cut:
    """A file cut, or made longer, to a size."""

    file: int
    size: int


@dataclass(frozen=True)
class Named:
    """Names given to files, or taken away where there is none."""

    names: Mapping[str, int | None]


@dataclass(frozen=True)
class Synced:
    """A file is on the disk, or, where it is None, the names in the folder: what was done before the call began."""

    file: int | None
    began: int


@dataclass(frozen=True)
class Marked:
    """A word and a number that the process said of itself."""

    word: str
    number: int


Deed = Write | Cut | Named | Synced | Marked


@dataclass
class Recorded:
    """The files that were there, and what was done to them."""

    files: list[bytes] = field(default_factory=list)
    """Content of the files at first; a file is its place here, a new one has none."""
    names: dict[str, int] = field(default_factory=dict)
    """Names of the files at first."""
    deeds: list[Deed] = field(default_factory=list)


def record(command: Sequence[str], folder: Path, log: Path) -> Recorded:
    """Run a Python module with strace, and return what it did to the files of the folder.

    What is in the folder beforehand is taken to be on the disk. What the process marks it writes to its standard
    output, as ``mark word number``. Raises CalledProcessError where it fails.
    """
    found = Recorded()
    for path in sorted(folder.iterdir()):
        found.names[path.name] = len(found.files)
        found.files.append(path.read_bytes())
    traced = ["strace", "-f", "--seccomp-bpf", "-qq", "-y", "-xx", "-s", "100000000", "-o", str(log), "-e"]
    subprocess.run([*traced, f"trace={CALLS}", sys.executable, "-m", *command], check=True, stdout=subprocess.DEVNULL)
    _Reader(found, folder).read(log)
    return found


def _calls(log: Path) -> Iterator[tuple[bool, str, str]]:
    """Whether it begins, the thread and the text of each call: one that waited comes twice, at its begin and whole."""
    waiting: dict[str, str] = {}
    with log.open() as lines:
        for line in lines:
            found = _LINE.match(line)
            if not found:
                continue
            thread, said = found.groups()
            if said.endswith("<unfinished ...>"):
                waiting[thread] = said.removesuffix("<unfinished ...>").rstrip()
                yield True, thread, waiting[thread]
            elif said.startswith("<... "):
                yield False, thread, waiting.pop(thread) + said.partition("resumed>")[2]
            else:
                yield True, thread, said
                yield False, thread, said


class _Reader:
    """Turns the lines of strace into deeds."""

    def __init__(self, found: Recorded, folder: Path) -> None:
        self._found, self._folder = found, f"{folder.resolve()}"
        self._names: dict[str, int] = dict(found.names)
        self._sizes = [len(content) for content in found.files]
        self._places: dict[str, int | None] = {}
        """Place of each open stream in its file; None: always at the end."""
        self._began: dict[str, int] = {}
        """Number of deeds when a thread's call began."""

    def read(self, log: Path) -> None:
        for begins, thread, said in _calls(log):
            if begins:
                self._began[thread] = len(self._found.deeds)
                continue
            call = _CALL.match(said)
            if call and not call[3].startswith(("-", "?")):
                self._take(call[1], call[2], int(call[3]), call[4], self._began[thread])

    def _take(self, name: str, given: str, result: int, tail: str, began: int) -> None:
        if name in ("openat", "open", "creat"):
            self._open(given, result, tail)
        elif name.startswith("rename"):
            before, now = (self._inside(_plain(one)) for one in _TEXT.findall(given))
            if before is not None and now is not None:
                self._name({now: self._names[before], before: None})
        elif name.startswith("unlink"):
            gone = self._inside(_plain(_TEXT.findall(given)[0]))
            if gone in self._names:
                self._name({gone: None})
        elif stream := _STREAM.match(given):
            self._to_stream(name, stream, given[stream.end() :], result, began)

    def _open(self, given: str, result: int, tail: str) -> None:
        path = self._inside(_plain(tail[tail.index("<") + 1 : tail.rindex(">")])) if "<" in tail else None
        if path is None:
            return
        flags = _TEXT.sub("", given)
        if path not in self._names:
            self._sizes.append(0)
            self._name({path: len(self._sizes) - 1})
        self._places[str(result)] = None if "O_APPEND" in flags else 0
        if "O_TRUNC" in flags:
            self._cut(self._names[path], 0)

    def _to_stream(self, name: str, stream: re.Match[str], rest: str, result: int, began: int) -> None:
        number, path, gone = stream[1], _plain(stream[2]), stream[3]
        if number == "1" and name == "write":
            for line in _plain(_TEXT.findall(rest)[0]).splitlines():
                if line.startswith("mark "):
                    _, word, count = line.split()
                    self._found.deeds.append(Marked(word, int(count)))
        if path == self._folder and name in ("fsync", "fdatasync"):
            self._found.deeds.append(Synced(None, began))
        inside = self._inside(path)
        if inside is None or gone or inside not in self._names:
            return
        file = self._names[inside]
        if name in NOT_UNDERSTOOD:
            raise ValueError(f"{name} of {inside} is not followed")
        if name in ("fsync", "fdatasync"):
            self._found.deeds.append(Synced(file, began))
        elif name == "ftruncate":
            self._cut(file, int(rest.removeprefix(", ")))
        elif name == "lseek":
            if self._places.get(number) is not None:
                self._places[number] = result
        elif name in ("write", "pwrite64"):
            data = bytes.fromhex(_TEXT.findall(rest)[0].replace("\\x", ""))[:result]
            place = self._places.get(number)
            at = int(rest.rpartition(", ")[2]) if name == "pwrite64" else self._sizes[file] if place is None else place
            if name == "write" and place is not None:
                self._places[number] = at + len(data)
            self._sizes[file] = max(self._sizes[file], at + len(data))
            self._found.deeds.append(Write(file, at, data))

    def _cut(self, file: int, size: int) -> None:
        self._sizes[file] = size
        self._found.deeds.append(Cut(file, size))

    def _name(self, names: Mapping[str, int | None]) -> None:
        for path, file in names.items():
            if file is None:
                self._names.pop(path, None)
            else:
                self._names[path] = file
        self._found.deeds.append(Named(names))

    def _inside(self, path: str) -> str | None:
        """The name of a file in the folder; None of one elsewhere, and of what SQLite makes anew after each crash."""
        folder, _, name = path.rpartition("/")
        return name if folder == self._folder and not name.endswith("-shm") else None


def _plain(escaped: str) -> str:
    return bytes.fromhex(escaped.replace("\\x", "")).decode(errors="replace")
