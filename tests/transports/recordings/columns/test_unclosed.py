"""Databases whose recorder was killed: what SQLite itself would read is read, and nothing beside them changes."""

from __future__ import annotations

import shutil
import sqlite3
from collections import Counter
from contextlib import closing
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.columns import read_columns
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording

from ...conftest import SIGNALS

TOPICS = tuple({signal.partition(".")[0] for signal in SIGNALS})


@pytest.fixture
def killed(recorded: dict[str, Path], tmp_path: Path) -> Path:
    """A database as a recorder leaves it that was killed: half of the rows committed in its log alone."""
    return _killed(recorded[".db3"] / "drive.db3", tmp_path / "work", tmp_path / "left")


def _killed(sound: Path, work: Path, left: Path, later: str = "BEGIN") -> Path:
    work.mkdir()
    left.mkdir()
    path = work / "drive.db3"
    shutil.copy(sound, path)
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("PRAGMA wal_autocheckpoint = 0")
        shift = 10_000 * SECOND
        database.execute(
            f"INSERT INTO messages(topic_id, timestamp, data) SELECT topic_id, timestamp + {shift}, data FROM messages"
        )
        database.execute("PRAGMA cache_size = 5")  # so that what is not committed reaches the log too
        database.execute("BEGIN")
        if later != "BEGIN":
            database.execute(later)
        for file in work.iterdir():
            shutil.copy(file, left / file.name)
    return left / "drive.db3"


def rows(path: Path) -> tuple[Counter[tuple[str, int]], Counter[str]]:
    """Topic and time of receipt of each message, and the notes."""
    columns = read_columns(path, [], topics=TOPICS)
    found = Counter(
        (topic, time) for block in columns for topic, part in block.items() for time in part.received.tolist()
    )
    return found, columns.notes


def expected(path: Path, copy: Path) -> Counter[tuple[str, int]]:
    """The same by SQLite, of a copy."""
    shutil.copytree(path.parent, copy)
    with closing(sqlite3.connect(copy / path.name)) as database:
        query = "SELECT name, timestamp FROM messages JOIN topics ON topics.id = topic_id"
        return Counter(row for row in database.execute(query) if row[0] in TOPICS)


def state(folder: Path) -> dict[str, tuple[bytes, int]]:
    return {file.name: (file.read_bytes(), file.stat().st_mtime_ns) for file in folder.iterdir()}


def test_what_was_committed_is_read_and_nothing_written(killed: Path, tmp_path: Path) -> None:
    before = state(killed.parent)
    assert {"drive.db3", "drive.db3-wal", "drive.db3-shm"} <= before.keys()
    found, notes = rows(killed)
    assert found == expected(killed, tmp_path / "copy")
    assert notes == {"drive.db3: its recorder did not close it; what drive.db3-wal holds is read with it": 1}
    with Recording(killed) as recording:
        assert sum(info.messages for info in recording.topics()) >= found.total()
        assert recording.fingerprint
    assert state(killed.parent) == before


def test_without_shm_and_read_only(killed: Path, tmp_path: Path) -> None:
    (killed.parent / "drive.db3-shm").unlink()
    there = expected(killed, tmp_path / "copy")
    killed.parent.chmod(0o555)
    try:
        assert rows(killed)[0] == there
    finally:
        killed.parent.chmod(0o755)


def test_what_was_not_committed_is_not_read_and_said(recorded: dict[str, Path], tmp_path: Path) -> None:
    later = "INSERT INTO messages(topic_id, timestamp, data) SELECT topic_id, timestamp + 1, data FROM messages"
    path = _killed(recorded[".db3"] / "drive.db3", tmp_path / "work", tmp_path / "left", later)
    found, notes = rows(path)
    assert found == expected(path, tmp_path / "copy")
    assert any("damaged, or of what was not committed" in note for note in notes)


@pytest.mark.parametrize("at", [0, 3, 20, 32 + 5, 32 + 24 + 2000, -3000])
def test_a_damaged_log_is_read_as_far_as_sqlite_reads_it(at: int, killed: Path, tmp_path: Path) -> None:
    log = killed.with_name("drive.db3-wal")
    content = bytearray(log.read_bytes())
    content[at] ^= 0x10
    log.write_bytes(content)
    found, notes = rows(killed)
    there = expected(killed, tmp_path / "copy")
    assert found == there
    assert any(note.startswith("lost: ") and "drive.db3-wal" in note for note in notes)
    with pytest.raises(SourceError, match=r"drive\.db3-wal"):
        Recording(killed)


def test_no_room_for_a_copy(killed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    left = shutil.disk_usage("/")._replace(free=1000)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: left)
    found, notes = rows(killed)
    assert found
    assert any("no room for a copy" in note and "lost" in note for note in notes)


def test_two_whose_logs_alone_differ_are_two(recorded: dict[str, Path], tmp_path: Path) -> None:
    """A database that was just begun holds nothing of its own."""
    each = []
    for number in (1, 2):
        folder = tmp_path / f"{number}"
        folder.mkdir()
        with closing(sqlite3.connect(folder / "x.db3", isolation_level=None)) as database:
            database.execute("PRAGMA journal_mode = WAL")
            with closing(sqlite3.connect(recorded[".db3"] / "drive.db3")) as sound:
                for line in sound.iterdump():
                    if line not in ("BEGIN TRANSACTION;", "COMMIT;"):
                        database.execute(line)
            database.execute("UPDATE messages SET timestamp = timestamp + ?", (number * 1000 * SECOND,))
            shutil.copytree(folder, tmp_path / f"left{number}")
        each.append(tmp_path / f"left{number}" / "x.db3")
    assert each[0].read_bytes() == each[1].read_bytes()
    with open_source(*each) as source:
        assert len(source.spans()) == 2


@pytest.mark.parametrize("what", ["salts of a frame", "both salts of the last", "head", "half a frame"])
def test_whatever_of_a_log_does_not_count_is_said(killed: Path, tmp_path: Path, what: str) -> None:
    """SQLite passes over it, as over what a log still holds of before it was begun anew."""
    whole = rows(killed)[0].total()
    log = killed.with_name("drive.db3-wal")
    content = bytearray(log.read_bytes())
    frame = 24 + int.from_bytes(content[8:12], "big")
    if what == "salts of a frame":
        content[32 + 3 * frame + 9] ^= 0x10
    elif what == "both salts of the last":
        content[len(content) - frame + 8 : len(content) - frame + 16] = b"\xa5" * 8
    elif what == "head":
        content[17] ^= 1
    else:
        del content[len(content) - frame // 2 :]
    log.write_bytes(content)
    found, notes = rows(killed)
    assert found == expected(killed, tmp_path / "copy")
    assert found.total() < whole
    assert any(note.startswith("lost: ") and "drive.db3-wal" in note for note in notes)


def test_what_a_log_holds_of_before_it_was_begun_anew_is_not_missing(tmp_path: Path, recorded: dict[str, Path]) -> None:
    path = tmp_path / "drive.db3"
    shutil.copy(recorded[".db3"] / "drive.db3", path)
    (tmp_path / "left").mkdir()
    with closing(sqlite3.connect(path, isolation_level=None)) as database:
        database.execute("PRAGMA journal_mode = WAL")
        insert = "INSERT INTO messages(topic_id, timestamp, data) SELECT topic_id, timestamp + ?, data FROM messages"
        database.execute(f"{insert} LIMIT 900", (10_000 * SECOND,))
        database.execute("PRAGMA wal_checkpoint(RESTART)")
        database.execute(f"{insert} LIMIT 5", (20_000 * SECOND,))
        for file in ("drive.db3", "drive.db3-wal"):
            shutil.copy(tmp_path / file, tmp_path / "left" / file)
    left = tmp_path / "left" / "drive.db3"
    found, notes = rows(left)
    assert found == expected(left, tmp_path / "copy")
    assert not any("lost" in note for note in notes)
