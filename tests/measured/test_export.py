"""A table holds every sample, and reads back as it was."""

import math
from collections import Counter

import pytest

from robophm.core.errors import RobophmError
from robophm.core.signal import SECOND
from robophm.measured.export import export
from robophm.measured.recordings import recordings, signal_of
from robophm.transports.recordings.formats.csv import CsvRecording
from robophm.transports.recordings.recording import Recording

from .plain import BARE, START, TEMPERATURE, write

DAY = ["/ota/battery.voltage", "/ota/power/temperature.temperature", "/ota/odom.pose.pose.position.x"]


def same(values):
    return [(time, signal, "nan" if math.isnan(value) else value) for time, signal, value in values]


def exported(source, names, target):
    (recorded,) = recordings([source], together=True)
    return export(recorded, [signal_of(name, [recorded]) for name in names], target, Counter())


def test_csv_is_read_again_as_the_recording_was(tmp_path, day):
    exported(day, DAY, tmp_path / "day.csv")
    with Recording(day) as recording:
        expected = sorted(recording.samples(DAY))
    assert sorted(CsvRecording(tmp_path / "day.csv").samples(DAY)) == expected


def odd(tmp_path):
    """Out of order, twice at one time, not a number, before 1970, and topics that do not go together."""
    at = [(5, 5, 1.0), (6, 3, 2.0), (7, 3, 0.5), (8, 3, 2.0), (9, 9, math.nan), (10, None, 7.0), (10, None, 7.0)]
    messages = [
        (START + t * SECOND, None if s is None else START + s * SECOND + 1, v) for t, s, v in at
    ] + [(START + 3600 * SECOND, None, math.inf)]  # fmt: skip
    return write(tmp_path / "odd.mcap", messages, 100)


def test_odd_samples_are_all_there(tmp_path):
    path = odd(tmp_path)
    names = [BARE, TEMPERATURE]
    assert exported(path, names, tmp_path / "odd.csv") == 8
    with Recording(path) as recording:
        expected = sorted(same(recording.samples(names)), key=str)
    got = CsvRecording(tmp_path / "odd.csv")
    assert sorted(same(got.samples(names)), key=str) == expected
    lines = (tmp_path / "odd.csv").read_text().splitlines()
    assert lines[1] == f"{START // SECOND + 3}.000000001,,0.5"


def test_parquet_holds_the_same(tmp_path, day):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    exported(day, DAY, tmp_path / "day.csv")
    exported(day, DAY, tmp_path / "day.parquet")
    table = parquet.read_table(tmp_path / "day.parquet")
    assert table.column_names == ["time", *DAY]
    assert table.schema.field(DAY[0]).metadata == {b"unit": b"V"}
    times = table.column("time").cast("int64").to_pylist()
    values = [table.column(name).to_pylist() for name in DAY]
    got = [(t, name, v) for name, each in zip(DAY, values, strict=True) for t, v in zip(times, each, strict=True)]
    assert sorted(one for one in got if one[2] is not None) == sorted(CsvRecording(tmp_path / "day.csv").samples(DAY))


def test_parquet_tells_what_is_no_sample_from_what_is_no_number(tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    exported(odd(tmp_path), [BARE, TEMPERATURE], tmp_path / "odd.parquet")
    table = parquet.read_table(tmp_path / "odd.parquet")
    assert table.column(TEMPERATURE).null_count == 3
    assert sum(math.isnan(one) for one in table.column(TEMPERATURE).to_pylist() if one is not None) == 1


def test_without_pyarrow_one_line_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    with pytest.raises(RobophmError, match=r"pip install 'robophm\[parquet\]'"):
        exported(odd(tmp_path), [BARE], tmp_path / "odd.parquet")
    assert not (tmp_path / "odd.parquet").exists()


def test_what_was_there_stays_where_nothing_can_be_written(tmp_path):
    path = odd(tmp_path)
    (tmp_path / "odd.csv").write_text("mine")
    path.write_bytes(path.read_bytes()[:60])  # neither a topic nor a message is left
    with pytest.raises(RobophmError):
        exported(path, [BARE], tmp_path / "odd.csv")
    assert (tmp_path / "odd.csv").read_text() == "mine"
    assert [one.name for one in tmp_path.iterdir() if one.name.startswith(".")] == []
