"""Which files are meant."""

from __future__ import annotations

import hashlib
import random
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.transports.recordings.files import fingerprint_of, recordings_in


def test_recordings_as_named_and_those_in_folders_in_order(tmp_path: Path) -> None:
    day = tmp_path / "day"
    day.mkdir()
    for name in ("b.mcap", "a.bag", "notes.txt"):
        (day / name).touch()
    table = tmp_path / "run.csv"
    table.touch()
    assert recordings_in([table, day]) == (table, day / "a.bag", day / "b.mcap")
    assert recordings_in([]) == ()


def test_what_comes_by_a_pipe_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(SourceError, match=r"^-: recordings are not read from a pipe; expected what came out of it"):
        recordings_in([Path("-")])
    monkeypatch.chdir(tmp_path)
    Path("-").touch()  # a file may have that name
    assert recordings_in([Path("-")]) == (Path("-"),)


def test_what_is_not_there_is_said_with_what_is(tmp_path: Path) -> None:
    (tmp_path / "run.mcap").touch()
    with pytest.raises(SourceError, match=r"rum.mcap: no such file; did you mean 'run.mcap'"):
        recordings_in([tmp_path / "rum.mcap"])
    (tmp_path / "empty").mkdir()
    with pytest.raises(SourceError, match="holds no recording"):
        recordings_in([tmp_path / "empty"])


def test_a_recording_is_known_by_what_it_was_known_by_in_the_first_stores(tmp_path: Path) -> None:
    """By the digests of its files, sorted: of the size in words, and 64 KiB from the beginning, the middle, the end."""
    digests = []
    for name, size in (("a.bag", 500_000), ("b.bag", 1_000)):
        content = random.Random(size).randbytes(size)
        (tmp_path / name).write_bytes(content)
        edges = [content[max(0, at) :][:65536] for at in (0, size // 2, size - 65536)]
        digests.append(hashlib.sha256(str(size).encode() + b"".join(edges)).hexdigest())
    assert fingerprint_of(tmp_path) == hashlib.sha256("".join(sorted(digests)).encode()).hexdigest()
