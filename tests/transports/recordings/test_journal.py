from __future__ import annotations

import math
import random
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robophm.core.errors import SourceError
from robophm.core.signal import CLOCK, Sample
from robophm.transports.recordings.journal import Journal, JournalRecording
from robophm.transports.recordings.journal_lines import lines as lines_of
from robophm.transports.recordings.journal_lines import sealed

A, B = "/robot/temperature.temperature", "/joints.effort[2]"
RUN = [Sample(5, A, 0.1), Sample(4, B, -0.0), Sample(6, CLOCK, 0.0), Sample(6, A, 1e308)]


def read(path: Path) -> list[Sample]:
    with JournalRecording(path) as source:
        return list(source.samples(source.signals))


@given(st.lists(st.tuples(st.integers(0, 2**63), st.sampled_from([A, B, CLOCK]), st.floats())))
def test_round_trip_is_exact(run: list[tuple[int, str, float]]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.journal"
        with Journal(path, [A, B]) as journal:
            for sample in run:
                journal.write(Sample(*sample))
        assert repr(read(path)) == repr([Sample(*sample) for sample in run])


def test_clock_comes_along_and_silent_signals_are_known(tmp_path: Path) -> None:
    with Journal(tmp_path / "run.journal", [A, B, "/silent.x"]) as journal:
        for sample in RUN:
            journal.write(sample)
    source = JournalRecording(tmp_path / "run.journal")
    assert list(source.samples([B, "/silent.x"])) == [RUN[1], RUN[2]]
    assert {info.topic: info.messages for info in source.topics()} == {
        "/joints": 1,
        "/robot/temperature": 2,
        "/silent": 0,
    }
    with pytest.raises(SourceError, match=r"no signal ./joints.effort\[3\].; known: /joints.effort"):
        source.samples(["/joints.effort[3]"])


@pytest.mark.parametrize("torn", range(1, 12))
def test_torn_last_line_does_not_count_and_is_cut_off_on_restart(torn: int, tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    with Journal(path, [A, B]) as journal:
        for sample in RUN:
            journal.write(sample)
    path.write_bytes(path.read_bytes()[:-torn])
    source = JournalRecording(path)
    assert list(source.samples([A, B])) == RUN[:-1]
    assert source.notes == {"torn last line ignored": 1}
    with Journal(path, [A, B, "/late.x"]) as journal:
        journal.write(RUN[-1])
    assert read(path) == RUN
    assert path.read_text().count(f"# signal {A}") == 2  # each run says what it listened to


def test_gaps_are_said_and_are_no_samples(tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    for _ in range(2):
        with Journal(path, [A, B]) as journal:
            journal.write(RUN[0])
            journal.gap("/joints", "connection lost")
            journal.write(RUN[1])
    marks = [line[:-9] for line in path.read_text().splitlines() if line.startswith("# gap")]
    assert marks == ["# gap connection lost on /joints", "# gap not listening", "# gap connection lost on /joints"]
    source = JournalRecording(path)
    assert list(source.samples([A, B])) == RUN[:2] * 2
    assert source.notes == {"gap in what was heard": 3}


def test_clock_samples_reach_the_file_at_once(tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    with Journal(path, flush_every=3) as journal:
        journal.write(RUN[0])
        assert read(path) == []
        journal.write(RUN[2])
        assert read(path) == [RUN[0], RUN[2]]
        for _ in range(3):
            journal.write(RUN[0])
        assert len(read(path)) == 5


def test_numpy_numbers_are_written_as_plain_ones(tmp_path: Path) -> None:
    import numpy as np

    with Journal(tmp_path / "run.journal") as journal:
        journal.write(Sample(np.int64(3), A, np.float64(math.pi)))  # type: ignore[arg-type]
    assert read(tmp_path / "run.journal") == [Sample(3, A, math.pi)]


def test_errors(tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    path.write_text("time,/a.x\n")
    with pytest.raises(SourceError, match="not a journal"):
        Journal(path)
    for bad in ("/a", "/a\n.x"):
        with pytest.raises(SourceError):
            Journal(tmp_path / "new.journal", [bad])
    with Journal(tmp_path / "new.journal", [A]) as journal:
        journal.write(RUN[0])


@pytest.mark.parametrize("size", [7, 300, 3 << 20])
def test_holes_are_read_around_and_named(tmp_path: Path, size: int) -> None:
    """Blocks that were not on the disk when power was cut are zeros, wherever they begin."""
    path = tmp_path / "run.journal"
    run = [Sample(number, (A, B)[number % 2], number / 7) for number in range(400)]
    with Journal(path, [A, B]) as journal:
        for sample in run:
            journal.write(sample)
    whole = path.read_bytes()
    begin = len(whole) // 3
    there = whole[:begin] + bytes(size) + whole[begin + (size if size < 1 << 20 else 0) :]
    path.write_bytes(there)
    lines = {line + b"\n" for line in there.split(b"\n") if b"\0" not in line}
    kept = [one for one in run if sealed(f"{one.time} {one.value!r} {one.signal}").encode() in lines]
    assert 350 < len(kept) < 400
    source = JournalRecording(path)
    assert list(source.samples([A, B])) == kept
    (note,) = source.notes
    assert note.startswith("damaged at line 1")
    assert note.endswith(", read on behind it")
    with Journal(path, [A, B]) as journal:
        assert list(journal.since(0)) == kept
    gaps = [line.text for line in lines_of(path) if line.text and line.text.startswith("# gap")]
    assert gaps == ["# gap not listening", "# gap damaged lines before"]


HAPPENED = [*[Sample(10**18 + i, (A, B)[i % 2], i / 7) for i in range(60)], Sample(10**18 + 60, CLOCK, 0.0)]


def flips(whole: bytes, chance: random.Random, count: int) -> Iterator[tuple[int, bytes]]:
    """So many places, and what is there with one bit of it another."""
    for _ in range(count):
        place = chance.randrange(8 * len(whole))
        raw = bytearray(whole)
        raw[place // 8] ^= 1 << place % 8
        yield place, bytes(raw)


@pytest.mark.parametrize("earlier", [False, True])
@pytest.mark.parametrize("count", [100, pytest.param(3000, marks=pytest.mark.full)])
def test_no_flipped_bit_is_silent(tmp_path: Path, count: int, *, earlier: bool) -> None:
    """Nothing is made up, what is left out is said; also in a journal that a version without checksums began."""
    path = tmp_path / "run.journal"
    if earlier:
        path.write_text(f"# robophm journal 1\n# signal {A}\n1 0.5 {A}\n")
    before = path.stat().st_size if earlier else 0
    for half in (HAPPENED[:40], HAPPENED[40:]):
        with Journal(path, [A, B]) as journal:
            for sample in half:
                journal.write(sample)
    whole, good = path.read_bytes(), read(path)
    for place, raw in flips(whole[before:], random.Random(count), count):
        path.write_bytes(whole[:before] + raw)
        try:
            source = JournalRecording(path)
        except SourceError:
            continue
        found = list(source.samples(source.signals))
        notes = {one: n for one, n in source.notes.items() if one != "gap in what was heard"}
        gaps = source.notes["gap in what was heard"]
        if repr(found) != repr(good) or source.signals != {A, B} or gaps != 1 + earlier:
            assert notes, f"bit {place} changed what is read, and nobody said so"
        assert [*map(repr, found)] == [one for one in map(repr, good) if one in {*map(repr, found)}], place


def test_one_process_at_a_time_writes_a_journal(tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    with Journal(path, [A]) as journal:
        journal.write(RUN[0])
        journal.sync()
        before = path.read_bytes()
        with pytest.raises(SourceError, match="another process writes this journal; expected one at a time"):
            Journal(path, [B])
        assert path.read_bytes() == before
    Journal(path, [B]).close()


def cut(whole: bytes, synced: int, chance: random.Random) -> bytes:
    """What a disk may hold after a cut of power: of each block behind the sync all, what it was, or nothing but zeros.

    The file may have been made longer before its blocks were written, and blocks come in any order.
    """
    end = chance.randrange(synced, len(whole) + 1)
    there = bytearray(whole[:end])
    for begin in range(synced // 512 * 512, end, 512):
        kept = max(begin, synced)
        if chance.random() < 0.4:
            there[kept : begin + 512] = bytes(len(there[kept : begin + 512]))
        elif chance.random() < 0.2:
            torn = chance.randrange(kept, begin + 513)
            there[torn : begin + 512] = bytes(len(there[torn : begin + 512]))
    return bytes(there)


@pytest.mark.parametrize("left", [b"", b"# robophm jour", bytes(300), b"# robo" + bytes(90)])
def test_a_journal_whose_beginning_was_torn_is_begun_anew(left: bytes, tmp_path: Path) -> None:
    """Nothing was in it: what was listened to is on the disk before the first sample is."""
    path = tmp_path / "run.journal"
    path.write_bytes(left)
    for _ in range(2):
        with Journal(path, [A, B]) as journal:
            journal.write(RUN[0])
    assert read(path) == [RUN[0]] * 2


@pytest.mark.parametrize("content", [b"time,/a.x", b"\0" * 90 + b"mine", b"# robophm journal 3\n1 2 3 4\n"])
def test_what_is_no_journal_is_left_as_it_is(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    path.write_bytes(content)
    with pytest.raises(SourceError, match=r"not a journal|of version 3, of a newer robophm"):
        Journal(path, [A])
    assert path.read_bytes() == content


def test_a_journal_of_an_earlier_version_is_gone_on_with(tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    path.write_text(f"# robophm journal 1\n# signal {A}\n5 0.1 {A}\n6 0.2 {A}\n7 0.")
    with Journal(path, [A, B]) as journal:
        begun = journal.position
        assert list(journal.since(0)) == [Sample(5, A, 0.1), Sample(6, A, 0.2)]
        journal.write(RUN[1])
        assert list(journal.since(begun)) == [RUN[1]]
    assert read(path) == [Sample(5, A, 0.1), Sample(6, A, 0.2), RUN[1]]


@pytest.mark.parametrize("states", [100, pytest.param(1000, marks=pytest.mark.full)])
def test_power_cuts_lose_nothing_that_was_synced_and_make_nothing_up(states: int, tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    run = [Sample(10**18 + number, (A, B)[number % 2], number / 7) for number in range(600)]
    marks = []
    with Journal(path, [A, B]) as journal:
        for number, sample in enumerate(run):
            journal.write(sample)
            if number % 100 == 99:
                journal.sync()
                marks.append((journal.position, number + 1))
    whole = path.read_bytes()
    for seed in range(states):
        chance = random.Random(seed)
        synced, safe = chance.choice(marks)
        path.write_bytes(cut(whole, synced, chance))
        kept = read(path)
        assert kept[:safe] == run[:safe], seed
        assert kept == [sample for sample in run if sample in {*kept}], seed
        if seed % 20 == 0:  # the next run goes on behind it
            with Journal(path, [A, B]) as journal:
                assert list(journal.since(0)) == kept, seed
                journal.write(run[0])
            assert read(path) == [*kept, run[0]], seed
