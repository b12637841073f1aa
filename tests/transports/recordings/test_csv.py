from __future__ import annotations

import math
from decimal import Decimal
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robophm.core.errors import SourceError
from robophm.core.signal import Sample
from robophm.transports.recordings import text
from robophm.transports.recordings.formats.csv import CsvRecording, parse_time


def read(path: Path, text: str, *signals: str) -> list[Sample]:
    path.write_bytes(text.encode())
    return list(CsvRecording(path).samples(signals))


@pytest.mark.parametrize(
    ("text", "time"),
    [
        ("0", 0),
        ("-1.5", -1_500_000_000),
        ("1709553600.123456789", 1_709_553_600_123_456_789),
        ("1.709553600123456789e9", 1_709_553_600_123_456_789),
        ("0.0000000004", 0),
        ("0.0000000006", 1),
        ("2024-03-04T12:00:00Z", 1_709_553_600_000_000_000),
        ("2024-03-04 12:00:00.123456789", 1_709_553_600_123_456_789),
        ("2024-03-04T13:00:00,5+01:00", 1_709_553_600_500_000_000),
        ("1969-12-31T23:59:59.75", -250_000_000),
    ],
)
def test_time_is_exact(text: str, time: int) -> None:
    assert parse_time(text) == time


@given(st.integers(min_value=-(2**62), max_value=2**62))
def test_decimal_seconds_round_trip(time: int) -> None:
    assert parse_time(str(Decimal(time).scaleb(-9))) == time


@pytest.mark.parametrize("text", ["", "noon", "nan", "inf", "1e30", "2024-13-01", "12:00"])
def test_no_time(text: str) -> None:
    with pytest.raises(ValueError, match="expected seconds or ISO 8601"):
        parse_time(text)


def test_cells(tmp_path: Path) -> None:
    text = "\ufefftime,/b.y,/a.x[2]\r\n1.5, 2 ,nan\r\n\r\n2,,-0.25\r\n2,inf,"
    one, *rest = read(tmp_path / "t.csv", text, "/a.x[2]", "/b.y")
    assert one[:2] == (1_500_000_000, "/a.x[2]")
    assert math.isnan(one.value)
    assert rest == [
        (1_500_000_000, "/b.y", 2.0),
        (2_000_000_000, "/a.x[2]", -0.25),
        (2_000_000_000, "/b.y", math.inf),
    ]


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("stamp,/a.x\n1,2\n", "line 1: first column is 'stamp'"),
        ("time,a\n1,2\n", "line 1, column 2: signal 'a'"),
        ("time,/a.x,/a.x\n1,2,3\n", "line 1, column 3: '/a.x' is there twice"),
        ("time,/a.x\n", "holds no values"),
        ("time,/a.x\n1,\n", "holds no values"),
        ("time\n1\n", "holds no values"),
        ("time,/a.x\n1,2\n\n3,x\n", r"line 4, column 2 \(/a.x\): 'x' is not a number"),
        ("time,/a.x\n1,2\n2,3,4\n", "line 3: 3 cells; expected 2"),
        ("time,/a.x\n1,2\nsoon,3\n", r"line 3, column 1 \(time\): 'soon'"),
        ("time,/a.x\n2,2\n1,3\n", "line 3: time goes backwards"),
        ('time,/a.x\n1,2\n2,"3\n', "unexpected end of data"),
    ],
)
def test_errors_name_the_place(text: str, where: str, tmp_path: Path) -> None:
    with pytest.raises(SourceError, match=where):
        read(tmp_path / "t.csv", text, "/a.x")


def test_not_text(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_bytes(b"time,/a.x\n1,2\n2,\xff\n")
    with pytest.raises(SourceError, match="line 3: not UTF-8"):
        list(CsvRecording(path).samples(["/a.x"]))


def test_bounds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(SourceError, match="at most 4096"):
        read(tmp_path / "t.csv", "time," + ",".join(f"/a.x{i}" for i in range(5000)) + "\n")
    monkeypatch.setattr(text, "LONGEST_LINE", 100)
    with pytest.raises(SourceError, match="line 2: longer than 100 bytes"):
        read(tmp_path / "t.csv", "time,/a.x\n1," + " " * 200 + "2\n", "/a.x")
