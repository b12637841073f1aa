"""Some 5,200 damaged recordings; `make fuzz` has a million, by the same mechanism."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from tests.cases import some

from .fuzz import log_judge, logs, messages
from .fuzz.__main__ import OUTCOMES, repeat, tallied
from .fuzz.judge import Read, counted, read
from .fuzz.mutate import Mutant
from .fuzz.pool import Result
from .fuzz.seeds import TOPICS, seeds, truth

FILES, LOGS, DAMAGED_MESSAGES = 400, 200, 40
MEMORY = 512 << 20


@pytest.mark.parametrize("format_", ["bag", "db3", "wal", "mcap"])
def test_whatever_is_damaged(format_: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """No crash, no hang, no values that were made up, nothing lost without a word, no answer but the peers'."""
    monkeypatch.syspath_prepend(Path(__file__).parents[4])  # for the processes
    findings: list[Result] = []
    tally = tallied({format_: FILES}, seed=1, jobs=1, found=findings.append)[format_]
    assert findings == []
    assert sum(tally.outcomes.values()) == FILES
    possible = OUTCOMES[:2] if format_ == "wal" else OUTCOMES[:4]  # what a log holds has checksums, and is not needed
    assert all(tally.outcomes[outcome] > 10 for outcome in possible), tally.outcomes
    assert sum(count for what, count in tally.peers.items() if what.endswith("agrees")) > 10
    assert tally.memory < MEMORY


LIBRARIES = {"cbor": "cbor2", "cbor message": "cbor2", "msgpack message": "msgpack",
             "flatbuffer message": "foxglove_schemas_flatbuffer"}  # fmt: skip
"""By format, a library that may be missing."""


def each(formats: Sequence[str]) -> list[Any]:
    """The formats, skipped where their library is missing."""
    missing = {one: library for one in formats if (library := LIBRARIES.get(one)) and not find_spec(library)}
    return [
        pytest.param(one, marks=pytest.mark.skipif(one in missing, reason=f"no {missing.get(one)} (make setup)"))
        for one in formats
    ]


LOGS_AND_TABLES = each(logs.FORMATS)
MESSAGES = each(messages.FORMATS)


@pytest.mark.parametrize("format_", some(LOGS_AND_TABLES))
def test_whatever_is_damaged_of_logs_and_tables(format_: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """No crash, no hang, columns as samples; nothing made up or lost without a word where checksums or lengths tell."""
    monkeypatch.syspath_prepend(Path(__file__).parents[4])  # for the processes
    findings: list[Result] = []
    tally = tallied({format_: LOGS}, seed=1, jobs=1, found=findings.append)[format_]
    assert findings == []
    assert sum(tally.outcomes.values()) == LOGS
    assert sum(tally.outcomes[outcome] > 10 for outcome in OUTCOMES[:4]) >= 2, tally.outcomes
    assert tally.memory < MEMORY


@pytest.mark.full
@pytest.mark.parametrize("format_", MESSAGES)
def test_whatever_is_damaged_of_messages(format_: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """No crash, no hang, numbers as the library of the encoding reads them; nothing lost without a word."""
    monkeypatch.syspath_prepend(Path(__file__).parents[4])  # for the processes
    findings: list[Result] = []
    tally = tallied({format_: DAMAGED_MESSAGES}, seed=1, jobs=1, found=findings.append)[format_]
    assert findings == []
    assert sum(tally.outcomes.values()) == DAMAGED_MESSAGES
    assert tally.outcomes["in part"] > DAMAGED_MESSAGES / 3
    assert tally.memory < MEMORY


@pytest.mark.parametrize("format_", [*LOGS_AND_TABLES, *MESSAGES])
def test_the_sound_logs_and_tables_hold_what_was_written(format_: str, tmp_path: Path) -> None:
    for seed in logs.seeds(format_):
        path = tmp_path / f"sound{seed.suffix}"
        path.write_bytes(seed.content)
        found, _ = log_judge.read(path, [signal for signal, _ in seed.samples])
        assert found == {signal: [*own] for signal, own in seed.samples}


@pytest.mark.parametrize("format_", ["bag", "db3", "wal", "mcap"])
def test_the_sound_recordings_hold_what_was_written(format_: str, tmp_path: Path) -> None:
    for seed in seeds(format_):
        path = tmp_path / "sound.db3" if seed.beside else tmp_path / f"sound{seed.suffix}"
        Mutant(seed.name, seed.content, path.suffix, 2, None, (), seed.beside).write(path)
        ours = read(path)
        assert isinstance(ours, Read)
        ros = 1 if format_ == "bag" or seed.name == "ros1" else 2
        assert counted(ours.rows, TOPICS) == counted(truth(ros), TOPICS)


@pytest.mark.parametrize(("format_", "number", "seed"), [
    ("bag", 38584, 94580460),  # a signalling NaN in a message that is decoded by itself
    ("db3", 16919, 94580460),
    ("bag", 22876, 18776684),  # a header whose length leads into the first chunk
    ("bag", 69545, 20261126),  # the info of a chunk that names another topic, which hid the chunk from its own
    ("mcap", 2856, 20261127),  # an index of no channel behind a chunk, where no summary says of which channels it is
    ("mcap", 3584, 20261128),  # the same where a chunk is taken for another record, and its indices for those before
    ("ulg", 9133, 20261126),  # a message that says it is a dropout
    ("parquet", 4773, 20261126),  # a time before 1970
    ("mcap", 4832, 20261130),  # an index that says it is another record, where no summary says what there is
    ("mcap", 5608, 20261129),  # a chunk that begins later than all times that there are
    ("bag", 1394, 22),  # a second header, behind which the reader went back to the first chunk for ever
    ("db3", 1869, 2026112101),  # a row of which SQLite says that there is no memory for it
])  # fmt: skip
def test_what_was_found_once(format_: str, number: int, seed: int) -> None:
    """What long runs found, by the seeds that they printed."""
    assert repeat(format_, number, seed) == 0
