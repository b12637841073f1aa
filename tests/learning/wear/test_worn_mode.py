"""The wear of a failure mode by a table of readings: the trend that was put in, and when it reaches its threshold."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import DataError, DesignError
from robophm.design.file import parse
from robophm.learning.wear.readings_table import Readings
from robophm.learning.wear.worn_mode import WearOptions, worn_mode, worn_mode_of_table

ROBOT = parse("""
schema_version: 1
name: courier
components:
  battery: {rate: 120 FPMH, life: {distribution: weibull, shape: 3.5}}
  computer: {rate: 10 FPMH, wear: {topic: /c, field: i, threshold: 6}}
  wheels: {rate: 1 FPMH, quantity: 2}
""")


def table(path: Path, columns: str, rows: list[tuple[object, ...]]) -> Path:
    path.write_text("\n".join([columns, *(",".join(map(str, row)) for row in rows)]) + "\n")
    return path


@pytest.fixture
def falling(tmp_path: Path) -> Path:
    """A capacity that falls by 1e-4 an hour, read every five hours."""
    rng = np.random.default_rng(1)
    rows = [(5 * i, 1 - 5e-4 * i + 0.004 * rng.standard_normal()) for i in range(300)]
    return table(tmp_path / "capacity.csv", "time [h],value", rows)


def test_a_signal_that_falls_reaches_its_threshold_from_above(falling: Path) -> None:
    found = worn_mode_of_table(ROBOT, falling, "battery", threshold=0.7)
    assert found.unit == "h"
    assert found.wear.turned
    assert found.wear.trend.low < -1e-4 < found.wear.trend.high
    assert found.wear.remaining.low < (1 - 1e-4 * 1495 - 0.7) / 1e-4 < found.wear.remaining.high
    assert (found.wear.worn_out, found.wear.signal_threshold) == (False, 0.7)
    assert found.wear.never < 0.01
    assert found.wear.bend.direction is None
    assert found.wear.followed
    assert not found.critical
    later = table(
        falling.parent / "later.csv",
        "time [h],value",
        [
            (5 * i, 1 - 5e-4 * max(i - 100, 0) + 0.004 * one)
            for i, one in enumerate(np.random.default_rng(1).standard_normal(300))
        ],
    )
    found = worn_mode_of_table(ROBOT, later, "battery", threshold=0.7)
    assert 500 <= found.alarmed[0] <= 700  # the baseline ends at 495 h, and what comes then is wear
    assert found.detector is not None
    assert found.detector.promised
    assert found.alarmed == [found.readings.times[i] for i in found.alarms]


def test_a_threshold_that_is_passed_is_reached(falling: Path) -> None:
    found = worn_mode_of_table(ROBOT, falling, "battery", threshold=0.9)
    assert found.wear.worn_out
    assert found.critical
    assert found.wear.reached == pytest.approx(1000, abs=60)


def test_few_readings_have_a_trend_and_a_life_but_no_alarms(falling: Path) -> None:
    """Four suffice; changes are looked for as soon as there is one reading beyond the baseline."""
    few = table(falling.parent / "few.csv", "time [h],value", [(5 * i, 1 - 0.05 * i) for i in range(4)])
    found = worn_mode_of_table(ROBOT, few, "battery", threshold=0.7)
    assert found.wear.remaining.low < 15 < found.wear.remaining.high
    assert (found.detector, found.alarms) == (None, ())
    assert found.unlooked == "4 readings, and a baseline needs 100 before the first one judged"
    for baseline, looked in ((299, True), (300, False)):
        options = WearOptions(baseline=baseline)
        found = worn_mode_of_table(ROBOT, falling, "battery", threshold=0.7, options=options)
        assert (found.detector is not None) == looked
    still = [(5 * i, 1 if i < 100 else 0.9) for i in range(150)]
    found = worn_mode_of_table(
        ROBOT, table(falling.parent / "still.csv", "time [h],value", still), "battery", threshold=0.7
    )
    assert "the baseline is 1 all the time" in found.unlooked


def test_rising_and_falling_are_told_of_few_readings() -> None:
    """Of four readings that go on past the threshold the first one says from where."""
    for sign in (1, -1):
        readings = Readings(np.arange(4.0), sign * np.array([1.0, 2.0, 3.0, 4.0]), None, dated=False)
        found = worn_mode(ROBOT.modes[0], "the gauge", readings, sign * 1.5)
        assert found.wear.reached == pytest.approx(0.5)
        assert found.wear.turned == (sign < 0)


def test_dates_of_what_is_told(tmp_path: Path) -> None:
    rows = [(f"2024-03-{1 + i:02}", 1 + i) for i in range(12)]
    found = worn_mode_of_table(ROBOT, table(tmp_path / "d.csv", "when,value", rows), "battery", threshold=8.5)
    assert found.wear.reached is not None
    assert found.when(found.wear.reached) == datetime(2024, 3, 8, 12, tzinfo=UTC).timestamp() * 1e9
    assert worn_mode(ROBOT.modes[0], "", replace(found.readings, when=None), 8.5).when(3.0) is None


def test_dates_count_hours_and_what_is_around_is_taken_off(tmp_path: Path) -> None:
    """A bearing that runs ever hotter above the air: 0.1 K a day from 20 K."""
    rng = np.random.default_rng(2)
    rows = []
    for i in range(120):
        air = rng.uniform(10, 30)
        warm = air + 20 + 0.1 * i + 0.2 * rng.standard_normal()
        rows.append((f"2024-{1 + i // 28:02}-{1 + i % 28:02}", f"{warm:.3f}", f"{air:.3f}"))
    path = table(tmp_path / "bearing.csv", "when,value,ambient", rows)
    found = worn_mode_of_table(ROBOT, path, "battery", threshold=40, options=WearOptions(baseline=30))
    assert found.unit == "h"
    assert found.wear.remaining.low < (40 - 20 - 11.9) / 0.1 * 24 < found.wear.remaining.high


@pytest.mark.full
def test_what_the_load_does_is_not_taken_for_noise(tmp_path: Path) -> None:
    """A current that rises by 0.01 an hour, and by 3 with its load; its threshold is the design's."""
    rng = np.random.default_rng(3)
    load = rng.uniform(0, 1, 120)
    rows = [(i, 2 + 3 * x + 0.01 * i + 0.02 * rng.standard_normal(), x) for i, x in enumerate(load)]
    path = table(tmp_path / "current.csv", "time [h],value,load", rows)
    found = worn_mode_of_table(ROBOT, path, "computer", load=0.5, options=WearOptions(baseline=40))
    assert found.wear.threshold == 6
    assert found.wear.trend.low < 0.01 < found.wear.trend.high
    assert found.wear.noise < 0.1
    assert found.values[0] == pytest.approx(2 + 3 * 0.5, abs=0.3)


@pytest.mark.parametrize(
    ("path", "words", "says"),
    [
        ("wheels", {"threshold": 0.7}, "'wheels' is 2 equal parts"),
        ("battery", {}, "at which value is 'battery' worn out"),
        ("battery", {"threshold": 0.7, "load": 1.0}, "a column 'load', and the load at which"),
    ],
)
def test_what_says_too_little_is_refused(falling: Path, path: str, words: dict[str, object], says: str) -> None:
    with pytest.raises(DataError, match=says):
        worn_mode_of_table(ROBOT, falling, path, **words)  # type: ignore[arg-type]
    with pytest.raises(DesignError, match="no part 'batery'; did you mean 'battery'"):
        worn_mode_of_table(ROBOT, falling, "batery", threshold=1)


def test_a_signal_that_begins_at_its_threshold_is_refused_with_its_source() -> None:
    readings = Readings(np.arange(200.0), np.r_[np.ones(8), np.linspace(1, 2, 192)], None, dated=False)
    with pytest.raises(DataError, match="the gauge: the signal begins at its threshold, 1"):
        worn_mode(ROBOT.modes[0], "the gauge", readings, 1.0)
