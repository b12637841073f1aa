"""A drive in many files, with metadata.yaml beside them or without: one ledger, and a file in it is counted once."""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import pytest
from tests.transports.recordings.columns.test_splits import split

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.design.file import load
from robophm.design.robot import Robot
from robophm.monitoring.recording_sessions import sessions_of
from robophm.monitoring.replay import replay, replay_sessions
from robophm.stores.memory import MemoryStore
from robophm.transports.synthetic import SyntheticOta

from .killed import is_as_if_undisturbed, killed

OTA = Path(__file__).parents[2] / "examples/ota/robot.yaml"
T0 = 1_709_553_600 * SECOND


@pytest.fixture(scope="module")
def ota() -> Robot:
    return load(OTA)


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """Four minutes in one file, and in a folder of files of ten seconds."""
    folder = tmp_path_factory.mktemp("drive")
    whole = SyntheticOta(seed=2, start=T0, duration=240 * SECOND).record(folder / "drive.mcap")
    split(whole, folder / "parts")
    return whole, folder / "parts"


def past(robot: Robot, *paths: Path, period: float = 20.0) -> tuple[object, list[object]]:
    store = MemoryStore()
    replay(robot, list(paths), store=store, period=period, report_every=60)
    return store.ledger(robot.name), list(store.history(robot.name).reports())


def test_one_ledger_however_a_drive_lies(ota: Robot, drive: tuple[Path, Path], tmp_path: Path) -> None:
    whole, parts = drive
    expected = past(ota, whole)
    assert len(expected[1]) == 4
    assert past(ota, parts) == expected
    assert past(ota, *sorted(parts.iterdir())) == expected
    folder = tmp_path / "with metadata"
    folder.mkdir()
    for part in parts.iterdir():
        (folder / part.name).write_bytes(part.read_bytes())
    names = [part.name for part in sorted(parts.iterdir())]
    (folder / "metadata.yaml").write_text(json.dumps({"rosbag2_bagfile_information": {"relative_file_paths": names}}))
    assert len(sessions_of(ota, folder)) == 1
    assert len(sessions_of(ota, parts)) == 24
    assert past(ota, folder) == expected


def test_a_file_that_comes_later_is_counted_alone(ota: Robot, drive: tuple[Path, Path], tmp_path: Path) -> None:
    _, parts = drive
    bags = tmp_path / "bags"
    bags.mkdir()
    kept = MemoryStore()
    names = sorted(part.name for part in parts.iterdir())
    for some in (names[:5], names[5:6], names[6:7], names[7:]):
        for name in some:
            (bags / name).write_bytes((parts / name).read_bytes())
        replay(ota, bags, store=kept, period=20)
    fresh = MemoryStore()
    replay(ota, bags, store=fresh, period=20)
    assert kept.ledger(ota.name) == fresh.ledger(ota.name)
    assert all(kept.progress(ota.name, session.key).complete for session in sessions_of(ota, bags))


def test_a_file_before_those_that_were_counted_is_refused(ota: Robot, drive: tuple[Path, Path], tmp_path: Path) -> None:
    _, parts = drive
    early, *late = sorted(parts.iterdir())
    store = MemoryStore()
    replay(ota, late[:10], store=store, period=20)
    kept = store.ledger(ota.name)
    with pytest.raises(SourceError, match=r"drive_000\.mcap ends \d+ s before the robot's ledger does"):
        replay(ota, [early, *late], store=store, period=20)
    assert store.ledger(ota.name) == kept


def test_files_that_a_store_of_before_has_are_not_counted_again(ota: Robot, drive: tuple[Path, Path]) -> None:
    """It knows each by the digest of its size in words and 64 KiB at three places."""
    _, parts = drive
    store, sessions = MemoryStore(), sessions_of(ota, parts)
    before = []
    for session in sessions:
        content = session.files[0].read_bytes()
        edges = [content[at:][:65536] for at in (0, len(content) // 2, max(0, len(content) - 65536))]
        known = hashlib.sha256(str(len(content)).encode() + b"".join(edges)).hexdigest()
        for _ in range(2):  # of the files of a recording, and of the recordings of a session
            known = hashlib.sha256(known.encode()).hexdigest()
        key = hashlib.sha256("\n".join((known, *sorted(session.signals))).encode()).hexdigest()
        assert key == session.key_before() != session.key
        before.append(replace(session, key=key))
    replay_sessions(ota, before[:20], store=store, period=20)
    kept = store.ledger(ota.name)
    replay_sessions(ota, sessions[:20], store=store, period=20)
    assert store.ledger(ota.name) == kept
    replay(ota, parts, store=store, period=20)
    assert store.ledger(ota.name) == past(ota, parts)[0]


@pytest.mark.full
def test_a_replay_of_parts_that_is_killed_again_and_again(ota: Robot, drive: tuple[Path, Path], tmp_path: Path) -> None:
    """It ends as one that was not, and on the way some parts are done and others are not."""
    _, parts = drive
    keys = [session.key for session in sessions_of(ota, parts)]
    between = 0
    for store in killed(OTA, parts, tmp_path / "killed.db", ticks=(20, 60), seed=5):
        done = [store.progress(ota.name, key).complete for key in keys]
        assert done == sorted(done, reverse=True)  # in their order
        between += 0 < sum(done) < len(done)
    assert all(done)
    assert between >= 2
    is_as_if_undisturbed(OTA, parts, tmp_path / "killed.db")
