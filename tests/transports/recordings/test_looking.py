"""Columns of any recording are its samples, whether it holds messages or samples; tables of them are read again."""

from __future__ import annotations

import struct
from collections import Counter
from pathlib import Path

import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import Sample
from robophm.measured.export import export
from robophm.measured.overview import overview
from robophm.measured.recordings import recordings, signal_of
from robophm.transports.recordings.columns.topic_columns import by_signal
from robophm.transports.recordings.looking import columns_of, spans_of
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recognising import formats
from robophm.transports.synthetic import SyntheticOta

from ..conftest import SIGNALS
from ..test_contract import written
from ..written import dataflash

FORMATS = [name for name in formats() if name not in ("bag", "db3", "mcap")]


@pytest.fixture(params=FORMATS)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def path(name: str, drive: SyntheticOta, tmp_path: Path) -> Path:
    with written(name).open(drive, tmp_path):
        (found,) = tmp_path.iterdir()
    return found


def read(paths: list[Path], signals: list[str], topics: tuple[str, ...] = ()) -> list[Sample]:
    found = []
    for block in columns_of(paths, signals, topics):
        for signal, (_, times, values) in by_signal(block).items():
            found += [Sample(*one) for one in zip(times.tolist(), [signal] * len(times), values.tolist(), strict=True)]
    return found


def test_the_columns_are_the_samples(name: str, path: Path, drive: SyntheticOta) -> None:
    made = written(name)
    found = read([path], [*made.names.values()])
    assert sorted(found) == made.samples(drive, SIGNALS)
    topic = next(iter(made.names.values())).partition(".")[0]
    assert sorted(read([path], [made.names[SIGNALS[0]]], (topic,))) == made.samples(drive, SIGNALS[:1])
    assert spans_of([path]) == [(drive.times[0], drive.times[-1])]


def test_it_is_listed_with_what_it_holds(name: str, path: Path, drive: SyntheticOta) -> None:
    made = written(name)
    (recorded,) = recordings([path])
    seen = {topic.name: topic for topic in overview(recorded).topics}
    for signal in made.names.values():
        topic, _, field = signal.partition(".")
        assert field in seen[topic].fields
        assert seen[topic].messages == len(drive.times)
        assert (seen[topic].first, seen[topic].last) == (drive.times[0], drive.times[-1])
        assert not seen[topic].gap_count


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_table_of_it_is_read_again_bit_for_bit(
    name: str, path: Path, tmp_path: Path, suffix: str, drive: SyntheticOta
) -> None:
    made = written(name)
    found = recordings([path])
    table = tmp_path / f"table{suffix}"
    rows = export(found[0], [signal_of(signal, found) for signal in made.names.values()], table, Counter())
    assert rows == len(drive.times)
    bits = [(time, signal, struct.pack("<d", value)) for time, signal, value in made.samples(drive, SIGNALS)]
    again = sorted(open_source(table).samples([*made.names.values()]))
    assert [(time, signal, struct.pack("<d", value)) for time, signal, value in again if signal != "clock"] == bits
    (copy,) = recordings([table])
    second = tmp_path / f"again{suffix}"
    export(copy, [signal_of(signal, [copy]) for signal in made.names.values()], second, Counter())
    assert suffix == ".parquet" or second.read_bytes() == table.read_bytes()


@pytest.mark.parametrize(
    ("signal", "says"), [("/ota/batery.x", "no topic '/ota/batery'"), ("/ota/battery.x", "has no")]
)
def test_what_is_not_there_is_said(drive: SyntheticOta, tmp_path: Path, signal: str, says: str) -> None:
    with written("csv").open(drive, tmp_path):
        (path,) = tmp_path.iterdir()
    with pytest.raises(SourceError, match=says):
        signal_of(signal, recordings([path]))
    with pytest.raises(SourceError, match="no signal"):
        columns_of([path], [signal])


def flight(path: Path, start: int) -> Path:
    """A log of three messages, a second apart, whose GPS tells the time [s since 1970]."""
    log = [dataflash.head(GPS=dataflash.GPS, BAT=("Qf", "TimeUS,Volt"))]
    for step in range(3):
        stamp = 5_000_000 + step * 1_000_000
        log.append(dataflash.gps(129, stamp, (start + step) * 1000))
        log.append(dataflash.message(130, "Qf", stamp, step))
    path.write_bytes(b"".join(log))
    return path


def test_several_logs_are_one_drive_one_after_the_other(drive: SyntheticOta, tmp_path: Path) -> None:
    begin = drive.times[0] // 10**9
    day = drive.record(tmp_path / "day.mcap")
    later, earlier = flight(tmp_path / "later.BIN", begin + 1000), flight(tmp_path / "earlier.BIN", begin - 1000)
    (together,) = recordings([later, day, earlier], together=True)
    signals = ["/BAT.Volt", "/ota/battery.voltage"]
    found = read([*together.paths], signals)
    assert [one.time for one in found] == sorted(one.time for one in found)
    assert [one.value for one in found if one.signal == "/BAT.Volt"] == [0, 1, 2, 0, 1, 2]
    assert [one for one in found if one.signal != "/BAT.Volt"] == [*drive.samples(signals[1:])]
    within = flight(tmp_path / "within.BIN", begin + 10)
    with pytest.raises(SourceError, match=r"day\.mcap and .*within\.BIN overlap in time"):
        columns_of([day, within], signals)


def test_rows_that_hold_some_signals_alone(tmp_path: Path) -> None:
    table = tmp_path / "table.csv"
    table.write_text("time,/a.x,/a.y,/b.z\n1,1,,\n2,,2,\n3,3,3,\n3,4,,\n4,,,5\n")
    expected = [(1, "/a.x", 1), (2, "/a.y", 2), (3, "/a.x", 3), (3, "/a.x", 4), (3, "/a.y", 3), (4, "/b.z", 5)]
    found = read([table], ["/a.x", "/a.y", "/b.z"])
    assert sorted(found) == [Sample(time * 10**9, signal, value) for time, signal, value in expected]
    (recorded,) = recordings([table])
    assert [topic.name for topic in overview(recorded).topics] == ["/a", "/b"]
