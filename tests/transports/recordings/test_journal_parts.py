"""A journal that goes on in new files: what is read is what was written, whatever becomes of its parts meanwhile."""

from __future__ import annotations

import random
import tracemalloc
from pathlib import Path

import pyarrow
import pytest
import zstandard

from robophm.core.errors import SourceError
from robophm.core.signal import CLOCK, Sample
from robophm.transports.recordings import journal_parts
from robophm.transports.recordings.journal import Journal, JournalRecording
from robophm.transports.recordings.journal_parts import MOST_KEPT, pack, parts_of, room_for

A, B = "/robot/temperature.temperature", "/joints.effort[2]"
PART = 1500


def sample(number: int) -> Sample:
    """The sample of a number: each time once, every tenth of the clock, at which lines reach the file."""
    if number % 10 == 9:
        return Sample(10**18 + number, CLOCK, 0.0)
    return Sample(10**18 + number, (A, B)[number % 2], number / 7)


def read(path: Path) -> list[Sample]:
    source = JournalRecording(path)
    return [*source.samples(source.signals)]


def written(path: Path, begin: int, end: int, **more: int) -> Journal:
    """A journal that is closed, with these samples behind what was there."""
    with Journal(path, [A, B], part_size=PART, **more) as journal:
        for number in range(begin, end):
            journal.write(sample(number))
    return journal


def numbers(samples: list[Sample]) -> list[int]:
    """The numbers of samples that were written, which are as they were written."""
    found = [one.time - 10**18 for one in samples]
    assert samples == [*map(sample, found)]
    return found


@pytest.fixture
def small_frames(monkeypatch: pytest.MonkeyPatch) -> int:
    monkeypatch.setattr(journal_parts, "FRAME", 400)
    return 400


@pytest.mark.parametrize("seed", range(2))
def test_it_is_read_as_it_was_written_and_gone_on_with_from_any_place(seed: int, tmp_path: Path) -> None:
    chance, path, places, done = random.Random(seed), tmp_path / "run.journal", [(0, 0)], 0
    while done < 400:
        with Journal(path, [A, B], part_size=PART) as journal:
            place, before = chance.choice(places)
            assert numbers([*journal.since(place)]) == [*range(before, done)], "from where somebody had got to"
            for _ in range(chance.randint(1, 90)):
                journal.write(sample(done))
                done += 1
                if chance.random() < 0.2:
                    journal.sync()
                    places.append((journal.position, done))
    assert numbers(read(path)) == [*range(done)]
    parts = parts_of(path)
    assert len(parts) > 8
    packed = [part.path.stat().st_size for part in parts if part.path.suffix == ".zst"]
    assert len(packed) > 3
    assert max(packed) < PART
    assert path.stat().st_size < 2 * PART
    assert {one.name.removeprefix("run.journal") for one in tmp_path.iterdir()} == {
        "", *(part.path.name.removeprefix("run.journal") for part in parts)
    }, "nothing else is left"  # fmt: skip


def test_packing_changes_nothing_that_is_read(tmp_path: Path, small_frames: int) -> None:
    path = tmp_path / "run.journal"
    written(path, 0, 300)
    before = JournalRecording(path)
    for part in parts_of(path):
        if part.path.suffix != ".zst":
            plain = part.path.read_bytes()
            pack(part.path, lambda: True)
            with pyarrow.CompressedInputStream(pyarrow.OSFile(f"{part.path}.zst"), "zstd") as peer:
                assert peer.read(10 * PART) == plain, "any reader of zstd unpacks it"
    assert {part.path.suffix for part in parts_of(path)} == {".zst"}
    after = JournalRecording(path)
    assert after.fingerprint == before.fingerprint
    assert numbers([*after.samples([A, B])]) == [*range(300)]
    assert after.notes == before.notes == {}


def test_whoever_is_killed_while_packing_leaves_both_and_neither_counts_twice(tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    written(path, 0, 200)
    part = parts_of(path)[-1].path
    whole = part.read_bytes()
    pack(part, lambda: True)
    part.write_bytes(whole)
    (tmp_path / f"{part.name}.packing").write_bytes(b"half")
    assert numbers(read(path)) == [*range(200)]
    pack(parts_of(path)[-1].path, lambda: False)
    assert part.exists(), "whoever is to end leaves it"
    assert numbers(read(path)) == [*range(200)]


def test_the_oldest_are_let_go_of_and_it_is_said(tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    places = []
    with Journal(path, [A, B], part_size=PART, most_kept=3 * PART) as journal:
        for number in range(3000):
            journal.write(sample(number))
            if number % 10 == 9:
                places.append((journal.position, number + 1))
            if number % 100 == 99:
                assert journal._tidying
                journal._tidying.join()
        journal.sync()
    assert sum(part.path.stat().st_size for part in parts_of(path)) < 6 * PART
    (note,) = (one for one in journal.notes if "oldest" in one)
    assert note == f"{path}: let go of its oldest part, to keep below {3 * PART / 1e6:,.0f} MB"
    kept = numbers(read(path))
    assert kept == [*range(kept[0], 3000)]
    assert 100 < kept[0] < 2950
    with Journal(path, [A, B], part_size=PART, most_kept=3 * PART) as journal:
        for place, before in places[-12:]:
            assert numbers([*journal.since(place)]) == [*range(max(before, kept[0]), 3000)]


def test_a_tenth_of_the_file_system_or_four_gib(tmp_path: Path) -> None:
    import shutil

    assert room_for(tmp_path / "run.journal") == min(shutil.disk_usage(tmp_path).total // 10, 4 << 30)
    assert MOST_KEPT == 4 << 30


@pytest.mark.parametrize("count", [40, pytest.param(2000, marks=pytest.mark.full)])
def test_no_flipped_bit_of_a_packed_part_is_silent(count: int, tmp_path: Path, small_frames: int) -> None:
    """Nothing is made up, what is left out is said, and it is what one frame holds at most."""
    path = tmp_path / "run.journal"
    written(path, 0, 120)
    for part in parts_of(path):
        if part.path.suffix != ".zst":
            pack(part.path, lambda: True)
    victim = parts_of(path)[0].path
    whole, chance = victim.read_bytes(), random.Random(count)
    for _ in range(count):
        place = chance.randrange(8 * len(whole))
        raw = bytearray(whole)
        raw[place // 8] ^= 1 << place % 8
        victim.write_bytes(raw)
        source = JournalRecording(path)
        found = numbers([*source.samples(source.signals)])
        assert found == sorted(set(found))
        assert len(found) >= 120 - 2 * (small_frames // 30 + 2), "a mark is of the frames at both its sides"
        if len(found) < 120:
            assert any(f"of {victim.name}" in note or f"{victim.name}: " in note for note in source.notes), place


def test_a_bomb_is_damage_and_takes_no_memory(tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    written(path, 0, 30)
    mark = b"\x50\x2a\x4d\x18\0\0\0\0"
    huge = zstandard.ZstdCompressor(level=1).compress(bytes(200 << 20))
    unknown = zstandard.ZstdCompressor(level=1, write_content_size=False).compress(bytes(200 << 20))
    (tmp_path / "run.journal.5.zst").write_bytes(mark + huge + mark + unknown + mark)
    tracemalloc.start()
    try:
        source = JournalRecording(path)
        assert numbers([*source.samples([A, B])]) == [*range(30)]
        assert tracemalloc.get_traced_memory()[1] < 20 << 20
    finally:
        tracemalloc.stop()
    assert any("run.journal.5.zst" in note for note in source.notes)


def test_a_reader_is_told_where_a_new_file_is_begun_meanwhile(tmp_path: Path) -> None:
    path = tmp_path / "run.journal"
    written(path, 0, 20)
    source = JournalRecording(path)
    reading = source.samples([A, B])
    assert next(reading) == sample(0)
    written(path, 20, 100)
    with pytest.raises(SourceError, match="went on in a new file while it was read"):
        list(reading)


def test_a_disk_that_takes_no_new_file_leaves_it_in_the_old_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "run.journal"
    (tmp_path / "run.journal.next").mkdir()
    with Journal(path, [A, B], part_size=PART) as journal:
        for number in range(100):
            journal.write(sample(number))
        assert [note for note in journal.notes if "cannot go on in a new file" in note]
        (tmp_path / "run.journal.next").rmdir()
        monkeypatch.setattr(journal, "_next_at", 0)
        for number in range(100, 120):
            journal.write(sample(number))
    assert len(parts_of(path)) >= 1
    assert numbers(read(path)) == [*range(120)]
