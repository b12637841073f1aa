"""A table's readings: dates, and a signal as it would be at one load."""

from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.learning.wear.readings_table import at_load, read_readings


def test_dates_are_hours_since_the_first_and_are_kept(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("when,value\n2024-03-01,1\n2024-03-02T12:00,2\n")
    found = read_readings(tmp_path / "t.csv", "h")
    assert found.times.tolist() == [0, 36]
    assert found.when is not None
    assert found.when[1] == datetime(2024, 3, 2, 12, tzinfo=UTC).timestamp() * 1e9


def test_a_table_is_of_one_unit(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text("unit,time [h],value\nA,1,1\nA,2,2\n")
    assert read_readings(path, "h").values.tolist() == [1, 2]
    path.write_text("unit,time [h],value\nA,1,1\nB,2,2\n")
    with pytest.raises(DataError, match=r"t\.csv:3: unit: is 'B', and 'A' before; expected readings of one part"):
        read_readings(path, "h")


def test_a_signal_is_brought_to_one_load() -> None:
    load = np.random.default_rng(1).uniform(0, 1, 200)
    current = 2 + 3 * load + np.r_[np.zeros(100), np.full(100, 0.5)]
    found = at_load(current, load, 100, 0.5)
    assert found[:100] == pytest.approx(3.5)
    assert found[100:] == pytest.approx(4.0)
    with pytest.raises(DataError, match="load does not change"):
        at_load(current, np.ones(200), 100, 0.5)
