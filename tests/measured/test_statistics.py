"""Statistics, courses and time at level, as plain loops over the samples have them."""

import math
import tracemalloc
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.cases import examples

from robophm.core.errors import RobophmError
from robophm.core.signal import HOUR, SECOND
from robophm.measured.find import Condition, find
from robophm.measured.held_values import HeldValues
from robophm.measured.levels import MOST_STEPS, Levels, marginal
from robophm.measured.recordings import recordings, signal_of
from robophm.measured.series import MOST_COLUMNS, Series
from robophm.measured.statistics import Look, statistics, statistics_of
from robophm.transports.recordings.columns import chunked

from .plain import BARE, START, TEMPERATURE, samples, stretches, write


def windows(pairs, every, max_age):
    """Begin, samples, known, lowest, highest, mean and deviation of each window, one nanosecond of it after another."""
    pieces = {}
    for begin, end, value, _ in stretches(pairs, max_age):
        number = begin // every
        while True:
            low, high = max(begin, number * every), min(end, (number + 1) * every)
            pieces.setdefault(number, []).append((high - low, value, low == begin))
            number += 1
            if number * every >= end:
                break
    found = []
    for number, each in sorted(pieces.items()):
        known = sum(length for length, _, _ in each)
        mean = math.fsum(length * value for length, value, _ in each) / known if known else math.nan
        square = math.fsum(length * (value - mean) ** 2 for length, value, _ in each) / known if known else math.nan
        values = [value for _, value, _ in each]
        count = sum(sampled for _, _, sampled in each)
        found.append((number * every, count, known, min(values), max(values), mean, math.sqrt(square)))
    return found


drives = st.lists(
    st.tuples(
        st.sampled_from([0, 1, 300_000_000, SECOND, 4 * SECOND, 90 * SECOND]),
        st.sampled_from([0, -SECOND, 3 * SECOND]),
        st.floats(-50, 50) | st.just(math.nan) | st.just(1e6),
    ),
    min_size=1,
    max_size=30,
)


@settings(max_examples=examples(60), deadline=None)
@given(drives, st.sampled_from([SECOND // 2, 2 * SECOND, 60 * SECOND]), st.sampled_from([2 * SECOND, 5 * SECOND]))
def test_windows_are_those_of_a_plain_loop(tmp_path_factory, drive, every, max_age):
    received, messages = START, []
    for wait, shift, value in drive:
        received += wait
        messages.append((received, received + shift, value))
    path = write(tmp_path_factory.mktemp("drive") / "drive.mcap", messages, 100)
    (recorded,) = recordings([path])
    signal = signal_of(TEMPERATURE, [recorded])
    got = [window for _, window in statistics(recorded, [signal], every, max_age, Counter())]
    expected = windows(samples(path, TEMPERATURE), every, max_age)
    assert [(one.begin, one.samples, one.held, one.lowest, one.highest) for one in got] == [one[:5] for one in expected]
    for one, (*_, mean, deviation) in zip(got, expected, strict=True):
        assert one.mean == pytest.approx(mean, rel=1e-12, abs=1e-9, nan_ok=True)
        assert one.deviation == pytest.approx(deviation, rel=1e-7, abs=1e-9, nan_ok=True)


def test_recordings_one_after_the_other(tmp_path):
    """Of each recording what it says by itself; a signal that says nothing there is not listed."""
    drives = [[(0, 20.0), (1, 30.0), (4, 10.0)], [], [(100, 5.0), (102, 7.0)]]
    paths = [
        write(
            tmp_path / f"{k}.mcap",
            [(START, None, 1.0)] + [(START + t * SECOND, START + t * SECOND, v) for t, v in drive],
        )
        for k, drive in enumerate(drives)
    ]
    each = recordings(paths)
    signal, heard, told = signal_of(TEMPERATURE, each), [], []
    found = statistics_of(
        each, [signal], 2 * SECOND, 10 * SECOND, on_window=lambda *one: heard.append(one),
        advance=lambda done, total: told.append((done, total)),
    )  # fmt: skip
    assert [one.recording for one in found.seen] == [str(paths[0]), str(paths[2])]
    first, last = (one.whole for one in found.seen)
    assert (first.samples, first.held, first.lowest, first.highest) == (3, 4 * SECOND, 10.0, 30.0)
    assert first.mean == pytest.approx((20 * 1 + 30 * 3) / 4)
    assert (last.begin, last.mean) == (START + 100 * SECOND, 5.0)
    own = [(str(path), signal, one) for path, (recorded,) in ((path, recordings([path])) for path in paths)
           for _, one in statistics(recorded, [signal], 2 * SECOND, 10 * SECOND, Counter())]  # fmt: skip
    assert found.windows == heard == own
    assert found.count == len(own) == 3 + 2
    assert told == [(0, 3), (1, 3), (2, 3)]


def looked_at(path, name, levels=20):
    (recorded,) = recordings([path])
    signal = signal_of(name, [recorded])
    look = Look.new(levels)
    list(statistics(recorded, [signal], None, 5 * SECOND, Counter(), {name: look}))
    look.levels.finish()
    return look


def test_a_days_time_at_level(day):
    name = "/ota/power/temperature.temperature"
    look = looked_at(day, name)
    begins, hours = marginal(look.levels, 0)
    (width,) = look.levels.widths
    held = stretches(samples(day, name), 5 * SECOND)
    for begin, time in zip(begins, hours, strict=True):
        expected = sum(end - start for start, end, value, _ in held if begin <= value < begin + width) / HOUR
        assert time == pytest.approx(expected, rel=1e-12)
    values = [value for _, _, value, _ in held]
    half = width / 2
    assert len(begins) <= 20 < math.floor(max(values) / half) - math.floor(min(values) / half) + 1


def test_a_days_course(day):
    name = "/ota/battery.voltage"
    series = looked_at(day, name).series
    begins, lowest, highest = series.columns
    assert len(begins) <= MOST_COLUMNS
    assert np.all(np.diff(begins) == series.width)
    pairs = samples(day, name)
    for begin, low, high in list(zip(begins.tolist(), lowest, highest, strict=True))[::97]:
        here = [value for start, end, value, _ in stretches(pairs, 5 * SECOND)
                if start < begin + series.width and max(end, start + 1) > begin]  # fmt: skip
        assert (low, high) == (min(here), max(here))


cells = st.lists(
    st.tuples(st.floats(-1e6, 1e6), st.floats(-3, 3), st.floats(0, 10), st.floats(0, 5)), min_size=1, max_size=60
)


@settings(max_examples=examples(100), deadline=None)
@given(cells, st.integers(2, 30), st.data())
def test_levels_do_not_depend_on_the_blocks(rows, wanted, data):
    table = np.array(rows)
    whole, parts = Levels(2, 1, wanted), Levels(2, 1, wanted)
    whole.add(table[:, :2], table[:, 2:3], table[:, 3])
    at = sorted(data.draw(st.lists(st.integers(0, len(table)), max_size=5)))
    for part in np.split(table, at):
        parts.add(part[:, :2], part[:, 2:3], part[:, 3])
    for one in (whole, parts):
        one.finish()
    assert (whole.widths == parts.widths).all()
    assert (whole.keys == parts.keys).all()
    assert whole.sums == pytest.approx(parts.sums, rel=1e-12, abs=1e-300)
    assert (whole.least == parts.least).all()
    assert (whole.greatest == parts.greatest).all()
    for cell, (sums,), least, greatest in zip(whole.keys, whole.sums, whole.least, whole.greatest, strict=True):
        inside = table[(np.floor(table[:, :2] / whole.widths) == cell).all(axis=1)]
        assert sums == pytest.approx(math.fsum(inside[:, 2]), rel=1e-12)
        assert (least[0], greatest[0]) == (inside[:, 3].min(), inside[:, 3].max())
    for d in range(2):
        keys = whole.keys[:, d]
        assert keys.max() - keys.min() < wanted


def test_one_level_alone_and_too_many():
    levels = Levels(1, 1, 20)
    levels.add(np.full((3, 1), 25.0), np.ones((3, 1)), np.zeros(3))
    levels.finish()
    begins, sums = marginal(levels, 0)
    assert sums.tolist() == [3.0]
    assert begins[0] <= 25.0 < begins[0] + levels.widths[0]
    for wanted in (1, MOST_STEPS + 1):
        with pytest.raises(RobophmError, match="levels; expected 2 to"):
            Levels(1, 1, wanted)


@settings(max_examples=examples(100), deadline=None)
@given(st.lists(st.tuples(st.integers(1, 10**13), st.floats(-5, 5)), min_size=1, max_size=50), st.data())
def test_courses_do_not_depend_on_the_blocks(rows, data):
    times = START + np.cumsum([wait for wait, _ in rows])
    values = np.array([value for _, value in rows])
    ends = np.append(np.minimum(times[1:], times[:-1] + 5 * SECOND), times[-1])
    following, after = np.append(times[1:], times[-1]), np.append(values[1:], values[-1])
    whole, parts = Series(), Series()
    whole.add(HeldValues(times, values, ends, following, after))
    for at in np.split(np.arange(len(times)), sorted(data.draw(st.lists(st.integers(0, len(times)), max_size=5)))):
        parts.add(HeldValues(times[at], values[at], ends[at], following[at], after[at]))
    assert parts.begin == whole.begin == times[0]
    assert parts.width == whole.width
    for one, other in zip(whole.columns, parts.columns, strict=True):
        assert (one == other).all()


def test_windows_so_short_that_there_would_be_no_end_of_them(tmp_path):
    path = write(tmp_path / "drive.mcap", [(START + i * SECOND, None, 1.0) for i in range(3)])
    (recorded,) = recordings([path])
    with pytest.raises(RobophmError, match=r"more than 1,000,000 windows of 1e-09 s; expected longer ones"):
        list(statistics(recorded, [signal_of(BARE, [recorded])], 1, 5 * SECOND, Counter()))


@pytest.mark.full
def test_memory_does_not_grow_with_the_recording(tmp_path, monkeypatch):
    """Of eight times the messages, far less is kept than even their times and values would take."""
    monkeypatch.setattr(chunked, "BATCH", 1 << 16)  # else all of it would be handled at once
    peaks, counts = [], (5_000, 40_000)
    for count in (counts[0], *counts):  # the first warms up
        path = write(tmp_path / f"{len(peaks)}.mcap",
                     [(START + i * 10**8, START + i * 10**8, i % 97) for i in range(count)], 1 << 16)  # fmt: skip
        (recorded,) = recordings([path])
        signal = signal_of(TEMPERATURE, [recorded])
        tracemalloc.start()
        look = Look.new(20)
        for _ in statistics(recorded, [signal], SECOND, 5 * SECOND, Counter(), {TEMPERATURE: look}):
            pass
        find([recorded], signal, Condition(above=1000.0), 5 * SECOND)  # hits are kept, up to a number of them
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[2] - peaks[1] < 0.25 * 16 * (counts[1] - counts[0])


def test_samples_too_far_apart_are_said_to_be(tmp_path):
    path = write(tmp_path / "drive.mcap", [(START + i * 10 * SECOND, None, 1.0) for i in range(5)])
    (recorded,) = recordings([path])
    notes = Counter()
    (window,) = [one for _, one in statistics(recorded, [signal_of(BARE, [recorded])], None, 5 * SECOND, notes)]
    assert window.held == 4 * 5 * SECOND
    assert any("more than 5 s apart" in note for note in notes)
