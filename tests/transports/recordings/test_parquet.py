"""Tables in Parquet: what export writes is what was recorded, bit for bit; others where they are tables of signals."""

from __future__ import annotations

import math
import struct
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import pyarrow as arrow
import pytest
from pyarrow import parquet

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.measured.export import export
from robophm.measured.recordings import recordings, signal_of
from robophm.transports.recordings.opening import open_source
from robophm.transports.synthetic import SyntheticOta

from ..conftest import SIGNALS


def written(path: Path, **columns: Any) -> Path:
    parquet.write_table(arrow.table(columns), path, row_group_size=2)
    return path


def times(*seconds: float) -> Any:
    return arrow.array([int(one * SECOND) for one in seconds], arrow.timestamp("ns", "UTC"))


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_what_export_writes_is_what_was_recorded(tmp_path: Path, suffix: str) -> None:
    drive = SyntheticOta(seed=4, duration=3 * 3600 * SECOND)  # more than a group of rows with all signals
    (recorded,) = recordings([drive.record(tmp_path / "drive.mcap")])
    table = tmp_path / f"table{suffix}"
    export(recorded, [signal_of(signal, [recorded]) for signal in SIGNALS], table, Counter())
    table = table.rename(tmp_path / "table")
    with open_source(table) as source:
        found, expected = sorted(source.samples(SIGNALS)), sorted(drive.samples(SIGNALS))
        assert found == expected
        assert [struct.pack("<d", one.value) for one in found] == [struct.pack("<d", one.value) for one in expected]
        assert source.spans() == [(int(drive.times[0]), int(drive.times[-1]))]


def test_of_other_tables_no_value_is_no_sample_and_nan_is_one(tmp_path: Path) -> None:
    path = written(
        tmp_path / "t.parquet",
        **{"/a.x": [1, None, 3, None], "time": arrow.array([1, 2, 2, 9000], arrow.timestamp("s")),
           "/a.y": arrow.array([math.nan, None, 2.5, 1.0], arrow.float32()), "/b.on": [True, False, None, None]},
    )  # fmt: skip
    with open_source(path) as source:
        found = [(one.time // SECOND, one.signal, repr(one.value)) for one in source.samples(["/b.on", "/a.y", "/a.x"])]
        assert found == [
            (1, "/a.x", "1.0"), (1, "/a.y", "nan"), (1, "/b.on", "1.0"),
            (2, "/a.x", "3.0"), (2, "/a.y", "2.5"), (2, "/b.on", "0.0"), (9000, "/a.y", "1.0"),
        ]  # fmt: skip
        assert [(one.topic, one.messages, one.fields) for one in source.topics()] == [
            ("/a", 3, ("x", "y")), ("/b", 2, ("on",)),
        ]  # fmt: skip


NO_TABLES = {
    "no time": ({"/a.x": [1.0]}, "has no column 'time' of date and time"),
    "times are numbers": ({"time": [1.0], "/a.x": [1.0]}, "has no column 'time' of date and time"),
    "no time in a row": ({"time": arrow.array([None], arrow.timestamp("ns")), "/a.x": [1.0]}, "a row has no time"),
    "backwards": ({"time": times(1, 3, 2), "/a.x": [1.0, 2.0, 3.0]}, "time goes backwards"),
    "texts": ({"time": times(1), "/a.x": ["one"]}, "column '/a.x' holds string; expected numbers"),
    "no signal": ({"time": times(1), "voltage": [1.0]}, "signal 'voltage' names no field"),
    "nothing": ({"time": times(1), "/a.x": arrow.array([None], arrow.float64())}, "holds no values"),
    "out of range": ({"time": arrow.array([2**62], arrow.timestamp("us")), "/a.x": [1.0]}, "cannot be read"),
}


@pytest.mark.parametrize(("columns", "says"), NO_TABLES.values(), ids=NO_TABLES)
def test_what_is_no_table_is_refused_in_one_line(tmp_path: Path, columns: dict[str, Any], says: str) -> None:
    path = written(tmp_path / "t.parquet", **columns)
    with pytest.raises(SourceError, match=says) as raised:
        open_source(path)
    assert str(raised.value).startswith(str(path))
    assert "\n" not in str(raised.value)


def test_without_pyarrow_it_is_said_how_to_get_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = written(tmp_path / "t.parquet", **{"time": times(1), "/a.x": [1.0]})
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(SourceError, match=r"needs pyarrow; install it with `pip install 'robophm\[parquet\]'`"):
        open_source(path)
