"""A flipped bit in a store changes nothing that is read without a word, and the last good state is to be had again."""

from __future__ import annotations

import json
import random
import shutil
import sqlite3
import struct
import subprocess
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from robophm.core.errors import StoreError
from robophm.stores import restore_store
from robophm.stores._write_ahead_log import left_behind
from robophm.stores.events import Event
from robophm.stores.pyramid import number_of
from robophm.stores.service_requests import ServiceRequest
from robophm.stores.sqlite import SqliteStore
from robophm.stores.store import Progress

from .test_alarm_log import alarm

ROBOTS = ("R", "Rover 2")


def content(path: Path) -> dict[str, Any]:
    """All that can be read of a store."""
    with SqliteStore(path) as store:
        return {
            robot: [
                store.ledger(robot), store.progress(robot, "drive"), store.progress(robot, "other"),
                list(kept.reports()), [one.to_json() for one in kept.events()], kept.figures().to_json(),
                [(one, kept.course(one).mean.tolist()) for one in kept.signals()],
                [kept.report_at(time) for time in (-1, 4, 10**9)], store.alarm_log(robot).alarms(),
                store.service_requests(robot).waiting(),
                [store.service_requests(robot).answer(f"{number}") for number in range(3)],
            ]
            for robot in (*store.robots(), *ROBOTS) for kept in [store.history(robot)]
        }  # fmt: skip


def report(time: int, chance: random.Random) -> dict[str, Any]:
    views = {
        view: {"hazard_rate": chance.random(), "unreliability": chance.random()} for view in ("nominal", "sensor_based")
    }
    robot = {"kind": "robot", "path": "R", "flags": ["stale /a.b"] * (time % 2), "breaches": [], **views}
    more = [chance.random() for _ in range(40)]
    return {"time": time, "state": "ok", "clocks": {"operating": chance.random()}, "subjects": [robot], "more": more,
            "signals": {"/a.b": chance.random()}}  # fmt: skip


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store of two robots, of several pages, whose good state is that of before its last report."""
    path = tmp_path_factory.mktemp("sound") / "past.db"
    chance = random.Random(5)
    for round_ in range(3):
        with SqliteStore(path) as store:
            for robot in ROBOTS:
                state = {"age": [chance.random() for _ in range(60)], "round": round_}
                done = [Progress("drive", round_, round_ > 1), Progress("other", 10**18 + round_, True, {"a note": 2})]
                reports = [report(100 * round_ + i, chance) for i in range(8)]
                store.service_requests(robot).leave(ServiceRequest(f"{round_}", {"part": "hot", "round": round_}))
                answers = {f"{round_}": {"done": [round_]}} if round_ < 2 else {}
                store.save(robot, state, done, reports, [Event(round_, "restart", "", "begun")], answers)
                kept = store.alarm_log(robot).keep([alarm(f"hot {i}", 100 * round_ + i, i or None) for i in range(8)])
                store.alarm_log(robot).acknowledge(kept[round_]["number"], "Ada", 77)
    return path


def flipped(sound: Path, folder: Path, seed: int) -> Path:
    """A copy of the store, and of what was kept beside it, with one bit of the store flipped."""
    path = folder / "past.db"
    raw = bytearray(sound.read_bytes())
    place = random.Random(seed).randrange(8 * len(raw))
    raw[place // 8] ^= 1 << place % 8
    path.write_bytes(raw)
    for end in ("-wal", "-shm", ".damaged", ".anew"):
        Path(f"{path}{end}").unlink(missing_ok=True)
    shutil.copy(f"{sound}.good", f"{path}.good")
    return path


def content_or_error(path: Path) -> dict[str, Any] | str:
    try:
        return content(path)
    except StoreError as error:
        return str(error)


def judge(sound: Path, folder: Path, seeds: range, restore: int = 1) -> dict[str, int]:
    """How many flips changed nothing, and how many were said; none may be silent, and each past is had again.

    ``restore``: of so many that are said one is made anew.
    """
    good, counts = content(sound), {"nothing": 0, "said": 0}
    ledgers = {robot: good[robot][:3] for robot in ROBOTS}
    for seed in seeds:
        path = flipped(sound, folder, seed)
        read = content_or_error(path)
        if isinstance(read, dict):
            assert json.dumps(read) == json.dumps(good), f"seed {seed} changed what is read, and nobody said so"
            counts["nothing"] += 1
            continue
        assert "\n" not in read, seed
        counts["said"] += 1
        if counts["said"] % restore == 0:
            assert restore_store(path), (seed, read)
            now = content(path)
            assert {robot: now[robot][:3] for robot in ROBOTS} == ledgers, (seed, read)
            for robot in ROBOTS:
                assert [one for one in now[robot][3] if one not in good[robot][3]] == [], seed
    return counts


@pytest.mark.full
def test_flipped_bits_are_found_and_the_last_good_state_comes_back(sound: Path, tmp_path: Path) -> None:
    counts = judge(sound, tmp_path, range(250), restore=10)
    assert counts["said"] > 100
    assert sum(counts.values()) == 250


def test_a_name_that_is_damaged_is_found_where_it_is_asked_for(sound: Path, tmp_path: Path) -> None:
    """The recording is not unknown because its name is another now: it would be counted a second time."""
    path = tmp_path / "past.db"
    path.write_bytes(sound.read_bytes().replace(b"drive", b"drjve"))
    with SqliteStore(path) as store, pytest.raises(StoreError, match="the progress drjve of R"):
        store.progress("R", "drive")


@pytest.fixture(scope="module")
def crashed(sound: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the store after more saves, none of which was moved out of the log before it was killed."""
    path = tmp_path_factory.mktemp("crashed") / "past.db"
    shutil.copy(sound, path)
    with SqliteStore(path) as store:
        for round_ in range(3, 6):
            store.save("R", {"round": round_}, [Progress("drive", round_)], [report(1000 + round_, random.Random(1))])
        folder = path.with_name("copy")
        folder.mkdir()
        for end in ("", "-wal"):
            shutil.copy(f"{path}{end}", folder / f"past.db{end}")
    return folder


def judge_log(crashed: Path, folder: Path, seeds: range, caplog: pytest.LogCaptureFixture) -> dict[str, int]:
    """How many flips in the log changed nothing, and how many were said; none may be silent, and all open."""
    whole, path = (crashed / "past.db-wal").read_bytes(), folder / "past.db"
    counts = {"nothing": 0, "said": 0}
    good: dict[str, Any] | None = None
    for seed in (-1, *seeds):
        raw = bytearray(whole)
        if seed >= 0:
            place = random.Random(seed).randrange(8 * len(raw))
            raw[place // 8] ^= 1 << place % 8
        for old in folder.iterdir():
            old.unlink()
        shutil.copy(crashed / "past.db", path)
        Path(f"{path}-wal").write_bytes(raw)
        caplog.clear()
        read = content(path)
        good = good or read
        said = [one for one in caplog.messages if "the end of its log is left out" in one]
        assert (seed < 0) <= (not said)
        if seed >= 0:
            assert said or json.dumps(read) == json.dumps(good), f"seed {seed} changed what is read, and nobody said so"
            counts["said" if said else "nothing"] += 1
            assert restore_store(path) is None, "what is read is sound"
            caplog.clear()
            content(path)
            assert not caplog.messages, "it is said once"
    return counts


@pytest.mark.full
def test_flipped_bits_in_the_log_of_a_store_that_was_killed_are_said(
    crashed: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    counts = judge_log(crashed, tmp_path, range(40), caplog)
    assert counts["said"] > 20


@pytest.mark.full
def test_a_thousand_flipped_bits_in_the_log(crashed: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    print(judge_log(crashed, tmp_path, range(100, 1100), caplog))


@pytest.mark.full
def test_six_thousand_flipped_bits(sound: Path, tmp_path: Path) -> None:
    counts = judge(sound, tmp_path, range(1000, 7000))
    print(counts)
    assert counts["said"] > 2500


@pytest.mark.parametrize("levels", [1, 2, 3, 4])
def test_figures_that_are_hidden_on_several_levels_are_missed(sound: Path, tmp_path: Path, levels: int) -> None:
    """As one flipped bit in a page of the index hides them: reports, or spans of ten minutes, hours and days too."""
    path = tmp_path / "past.db"
    shutil.copy(sound, path)
    with closing(sqlite3.connect(path)) as base, base:
        base.execute("DELETE FROM figures WHERE robot = ? AND width IN (SELECT DISTINCT width FROM figures ORDER BY "
                     "width LIMIT ?)", (number_of("R"), levels))  # fmt: skip
    with SqliteStore(path) as store:
        assert len(store.history("Rover 2").figures().times)
        with pytest.raises(StoreError, match="the figures of the history are damaged"):
            store.history("R").figures()


def test_a_sound_store_is_left_alone(sound: Path) -> None:
    before = sound.read_bytes()
    assert restore_store(sound) is None
    assert sound.read_bytes() == before


def test_a_damaged_store_without_a_good_state_is_refused(sound: Path, tmp_path: Path) -> None:
    path = tmp_path / "past.db"
    path.write_bytes(b"0" * 100 + sound.read_bytes()[100:])
    raw = path.read_bytes()
    with pytest.raises(StoreError, match=r"damaged, and no good state was kept beside it in past\.db\.good"):
        restore_store(path)
    assert path.read_bytes() == raw
    shutil.copy(f"{sound}.good", f"{path}.good")
    done = restore_store(path)
    assert done
    assert done.copy.read_bytes() == raw
    assert {robot: some[:3] for robot, some in content(path).items()} == {
        robot: some[:3] for robot, some in content(sound).items()
    }


def test_the_alarms_that_can_be_read_are_carried_over(sound: Path, tmp_path: Path) -> None:
    path = tmp_path / "past.db"
    shutil.copy(sound, path)
    with SqliteStore(path) as store:
        for robot in ROBOTS:
            log = store.alarm_log(robot)
            kept = log.keep([alarm("hot", 1), alarm("cold", 2, 9, ended_by="warm"), alarm("loud", 3)])
            log.acknowledge(kept[1]["number"], "Ada", 77)
    assert restore_store(path) is None
    with SqliteStore(path) as store:
        before = {robot: store.alarm_log(robot).alarms() for robot in ROBOTS}
    raw = path.read_bytes()
    place = raw.rindex(b'{"what": "loud"')  # whichever robot's it is
    path.write_bytes(raw[:place] + b"\xff" + raw[place + 1 :])
    done = restore_store(path)
    assert done
    assert done.said == ("what is damaged of its history is lost",)
    assert restore_store(path) is None  # it is sound, the levels of its figures too
    with SqliteStore(path) as store:
        after = {robot: store.alarm_log(robot).alarms() for robot in ROBOTS}
        (more,) = store.alarm_log("R").keep([alarm("late", 4)])
    assert sum(map(len, after.values())) == sum(map(len, before.values())) - 1
    lost = [one for robot in ROBOTS for one in before[robot] if one not in after[robot]]
    assert [one["what"] for one in lost] == ["loud"]
    assert more["number"] > max(one["number"] for robot in ROBOTS for one in after[robot])


LOCKED = """
import fcntl, sys
with open(sys.argv[1] + "-shm", "r+b") as index:
    try:
        fcntl.lockf(index, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, 128)  # all who have the file open share this byte
    except BlockingIOError:
        print("locked")
"""


def test_who_looks_into_the_log_does_not_let_go_of_the_locks_of_others_in_its_process(tmp_path: Path) -> None:
    path = tmp_path / "past.db"
    with SqliteStore(path) as store:
        store.save("R", {"exposure": 1.0})
        with SqliteStore(path) as looking:
            assert looking.ledger("R") == {"exposure": 1.0}
            words = [sys.executable, "-c", LOCKED, str(path)]
            said = subprocess.run(words, capture_output=True, text=True, check=True, timeout=60)
            assert said.stdout == "locked\n", "a newcomer would take the store for one that nobody has open"


@pytest.mark.parametrize("big_endian", [False, True])
def test_what_is_taken_of_a_log_is_what_sqlite_takes(tmp_path: Path, big_endian: bool) -> None:
    """Each cut and some flips of a log, against what SQLite itself then reads; also of a machine that is big-endian."""
    path, chance = tmp_path / "base.db", random.Random(3)
    with closing(sqlite3.connect(path, isolation_level=None)) as base:
        base.execute("PRAGMA page_size = 512")
        base.execute("PRAGMA journal_mode = WAL")
        base.execute("CREATE TABLE saves (number INTEGER, bytes BLOB)")
        for number in range(12):
            base.execute("INSERT INTO saves VALUES (?, ?)", (number, chance.randbytes(700)))
        whole, log = path.read_bytes(), Path(f"{path}-wal").read_bytes()
    if big_endian:
        log = in_other_order(log)
    size = 24 + 512
    ends = [at for at in range((len(log) - 32) // size) if struct.unpack_from(">I", log, 32 + at * size + 4)[0]]
    damaged = [log[:end] for end in range(0, len(log), 97)]
    for _ in range(60):
        one = bytearray(log)
        one[chance.randrange(32, len(log))] ^= 1 << chance.randrange(8)
        damaged.append(bytes(one))
    for number, some in enumerate([log, *damaged]):
        other = tmp_path / f"{number}.db"
        other.write_bytes(whole)
        Path(f"{other}-wal").write_bytes(some)
        left = left_behind(other)
        with closing(sqlite3.connect(other, isolation_level=None)) as base:
            ((busy, taken, _),) = base.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchall()
        assert not busy
        frames = max(0, len(some) - 32)
        assert left.pages == frames // size + (frames % size >= 24) - max(0, taken), f"{number}: {left}, {taken}"
        within = [at for at in ends if 32 + at * size + 24 <= len(some)]
        if len(some) < len(log) or not number:
            assert left.saves == sum(at >= taken for at in within)


def in_other_order(log: bytes) -> bytes:
    """A log whose checksums are of big-endian words, by the plain loop of SQLite's own description."""
    changed = bytearray(log)
    changed[3] |= 1

    def summed(first: int, second: int, some: bytes) -> tuple[int, int]:
        for x, y in struct.iter_unpack(">II", some):
            first = (first + x + second) % 2**32
            second = (second + y + first) % 2**32
        return first, second

    state = summed(0, 0, bytes(changed[:24]))
    struct.pack_into(">II", changed, 24, *state)
    for at in range(32, len(log), 24 + 512):
        state = summed(*state, bytes(changed[at : at + 8] + changed[at + 24 : at + 536]))
        struct.pack_into(">II", changed, at + 16, *state)
    return bytes(changed)
