"""Read a damaged file of samples, and say what is not as it should be."""

from __future__ import annotations

import struct
import subprocess
import zlib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from robophm.core.errors import SourceError
from robophm.core.signal import CLOCK, split_signal
from robophm.transports.recordings.opening import open_source

from ....written.old_bag import by_rosbag
from .logs import ALL, COUNT, VALUES, Samples
from .mutate import Mutant

_USUAL = ("no GPS told UTC", "receipt time used for")
"""Notes that are no word of a loss."""


ROSBAG_EVERY = 16
"""Of so many bags of version 1.2 that are read without a word, ROS's own reader is given one, as it is slow."""


def read(path: Path, signals: Sequence[str]) -> tuple[Samples, Counter[str]]:
    """The samples of these signals, as far as they are still there, in columns and one by one the same."""
    found: Samples = {}
    said: Counter[str] = Counter()
    with open_source(path) as source:
        source.topics(), source.spans()
        left = [*signals]
        while left:
            try:
                blocks = source.columns(left, -(2**63))
                for block in blocks or ():
                    for signal, columns in block.items():
                        found.setdefault(signal, []).extend(
                            zip(columns.times.tolist(), columns.values.tolist(), strict=True)
                        )
                said.update(source.notes)
                one_by_one: Samples = {}
                for time, signal, value in source.samples(left):
                    if signal != CLOCK:
                        one_by_one.setdefault(signal, []).append((time, value))
                said.update(source.notes)
                break
            except SourceError as error:
                gone = {one for one in left if any(f"'{what}'" in str(error) for what in (one, *split_signal(one)))}
                if not gone:
                    raise
                said[f"lost: {error}"] += 1
                left = [one for one in left if one not in gone]
                found.clear()
        else:
            raise SourceError(f"{path}: no signal is left: {dict(said)}")
    if blocks is not None:
        assert repr(sorted(map(repr, found.items()))) == repr(sorted(map(repr, one_by_one.items()))), "columns differ"
    return one_by_one, said


def verdict(mutant: Mutant, path: Path) -> tuple[str, str]:
    """What became of it, and what is not as it should be; raises SourceError where it is refused."""
    assert mutant.log
    there = {signal: [*own] for signal, own in mutant.log.samples}
    found, notes = read(path, [*there])
    said = any(not note.startswith(_USUAL) for note in notes)
    ours, whole = _counted(found, mutant.log.guard), _counted(there, mutant.log.guard)
    if ours == whole:
        return "whole", ""
    if mutant.losable is not None:
        if mutant.log.guard in (VALUES, ALL) and (made_up := ours - whole):
            return "fault", f"made up: {[*made_up][:3]}; {dict(notes)}"
        if mutant.log.guard in (COUNT, VALUES, ALL) and ours.total() < whole.total() and not said:
            return "fault", f"{whole.total() - ours.total()} samples are lost without a word: {dict(notes)}"
    asked = mutant.suffix == ".bag" and not said and zlib.crc32(mutant.content) % ROSBAG_EVERY == 0
    if asked and (left_out := _by_rosbag(path) - ours):
        return "fault", f"ROS's own rosbag reads more: {[*left_out][:3]}; {dict(notes)}"
    return ("changed" if ours - whole else "in part"), ""


def _by_rosbag(path: Path) -> Counter[tuple[str, ...]]:
    """What rosbag reads of a bag of version 1.2 with numbers; nothing where it refuses, or is not there."""
    try:
        _, theirs = by_rosbag(path) or (0, [])
    except (subprocess.SubprocessError, UnicodeDecodeError):
        return Counter()
    return Counter(
        (f"{topic}.data", str(time), repr(struct.unpack("<d", raw)[0]))
        for topic, time, raw in theirs
        if len(raw) == 8 and topic in ("/a", "/b")
    )


def _counted(samples: Samples, guard: str) -> Counter[tuple[str, ...]]:
    """How often each sample is there, by its value alone where times are not guarded."""
    return Counter(
        (signal, repr(value)) if guard == VALUES else (signal, str(time), repr(value))
        for signal, own in samples.items()
        for time, value in own
    )
