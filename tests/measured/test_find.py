"""What is found is what a plain loop over the samples finds, however the file is cut into chunks."""

import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.cases import examples

from robophm.core.errors import RobophmError, SourceError
from robophm.core.signal import SECOND
from robophm.measured.find import MOST_HITS, Condition, find
from robophm.measured.recordings import recordings, signal_of
from robophm.transports.recordings.recording import Recording

from .plain import BARE, START, TEMPERATURE, hits, samples, write

apart = st.sampled_from([0, 100_000_000, SECOND, 2 * SECOND, 3 * SECOND, 7 * SECOND, 40 * SECOND])
stamp = st.sampled_from([None, 0, -SECOND // 3, -2 * SECOND, 9 * SECOND, -9 * SECOND, 20 * SECOND])
level = st.sampled_from([0.0, 1.0, 2.0, 3.0, math.nan])
drives = st.lists(st.tuples(apart, stamp, level), min_size=1, max_size=40)
conditions = st.sampled_from([
    {"above": 1.0}, {"above": 0.5}, {"below": 2.0}, {"above": 0.5, "below": 2.5}, {"faster": 0.4}, {"faster": 0.0},
    {"stuck": True},
])  # fmt: skip


def messages_of(drive):
    received = START
    for wait, shift, value in drive:
        received += wait
        yield received, None if shift is None else received + shift, value


def says(condition):
    def holds(begin, value, after):
        if "stuck" in condition:
            return value if after and after[1] == value else None
        if "faster" in condition:
            change = (after[1] - value) / ((after[0] - begin) / SECOND) if after else 0.0
            return change if abs(change) > condition["faster"] else None
        low, high = condition.get("above", -math.inf), condition.get("below", math.inf)
        return value if low < value < high else None

    return holds


@settings(max_examples=examples(100), deadline=None)
@given(drives, conditions, st.sampled_from([1, 2 * SECOND, 5 * SECOND]), st.sampled_from([2 * SECOND, 5 * SECOND]))
def test_finds_are_those_of_a_plain_loop(tmp_path_factory, drive, condition, at_least, max_age):
    folder = tmp_path_factory.mktemp("drive")
    for name, chunk in (("whole", 1 << 20), ("cut", 100)):
        path = write(folder / f"{name}.mcap", messages_of(drive), chunk)
        (recorded,) = recordings([path])
        for signal in (TEMPERATURE, BARE):
            found = find([recorded], signal_of(signal, [recorded]), Condition(**condition, at_least=at_least), max_age)
            expected = hits(samples(path, signal), max_age, says(condition), at_least)
            assert [hit[1:] for hit in found.hits] == expected
            assert (found.count, found.length) == (len(expected), sum(hit[1] - hit[0] for hit in expected))


@settings(max_examples=examples(60), deadline=None)
@given(drives, st.sampled_from([SECOND, 5 * SECOND, 30 * SECOND]))
def test_missing_is_the_time_between_samples_and_to_the_ends(tmp_path_factory, drive, at_least):
    messages = list(messages_of(drive))
    path = write(tmp_path_factory.mktemp("drive") / "drive.mcap", messages, 100)
    each = recordings([path])
    for signal in (TEMPERATURE, BARE):
        found = find(each, signal_of(signal, each), Condition(missing=True, at_least=at_least), 1)
        times = [messages[0][0], *(time for time, _ in samples(path, signal)), messages[-1][0]]
        expected = [(a, b) for a, b in itertools.pairwise(times) if b - a >= at_least]
        assert [(hit.begin, hit.end) for hit in found.hits] == expected


def test_a_stretch_that_ends_with_its_gap_and_one_that_ends_with_the_recording(tmp_path):
    """By hand: 2 until the gap of 5 s after the second sample, and again from 20 s to the last sample."""
    at = [(0, 2.0), (1, 2.0), (20, 2.0), (21, 3.0), (24, 2.0)]
    path = write(tmp_path / "drive.mcap", [(START + t * SECOND, None, v) for t, v in at])
    each = recordings([path])
    found = find(each, signal_of(BARE, each), Condition(above=1.5), 5 * SECOND)
    spans = [((hit.begin - START) / SECOND, (hit.end - START) / SECOND, hit.lowest, hit.highest) for hit in found.hits]
    assert spans == [(0, 6, 2.0, 2.0), (20, 24, 2.0, 3.0)]


def test_a_days_temperatures(day):
    (recorded,) = recordings([day])
    name = "/ota/power/temperature.temperature"
    signal = signal_of(name, [recorded])
    found = find([recorded], signal, Condition(above=signal.level("75.2 degF"), at_least=10 * SECOND), 5 * SECOND)
    expected = hits(samples(day, name), 5 * SECOND, says({"above": 24.0}), 10 * SECOND)
    assert expected
    assert [hit[1:] for hit in found.hits] == expected


@pytest.mark.parametrize(
    ("file", "name", "condition"),
    [
        ("turtlesim.bag", "/turtle1/pose.linear_velocity", {"above": 0.5}),
        ("turtlesim.bag", "/turtle1/pose.x", {"stuck": True}),
        ("turtlesim.bag", "/turtle2/pose.theta", {"faster": 0.5}),
        ("temperature.bag", "/my_temperature.temperature", {"above": 0.0}),
    ],
)
def test_recordings_of_others(shared, file, name, condition):
    path = shared / "recordings" / file
    (recorded,) = recordings([path])
    found = find([recorded], signal_of(name, [recorded]), Condition(**condition, at_least=SECOND // 2), 5 * SECOND)
    expected = hits(samples(path, name), 5 * SECOND, says(condition), SECOND // 2)
    assert [hit[1:] for hit in found.hits] == expected
    assert expected


def drive_of(path, values, begin=0):
    return write(path, [(START + (begin + i) * SECOND, None, value) for i, value in enumerate(values)])


def test_each_recording_for_itself_or_all_as_one_drive(tmp_path):
    drive_of(tmp_path / "a.mcap", [0.0, 2.0, 2.0])
    drive_of(tmp_path / "b.mcap", [2.0, 2.0, 0.0], begin=3)
    write(tmp_path / "c.mcap", [(START + 100 * SECOND, START + 100 * SECOND, 9.0)])
    each = recordings([tmp_path])
    signal = signal_of(BARE, each)
    alone = find(each, signal, Condition(above=1.0), 5 * SECOND)
    spans = [(hit.recording.rpartition("/")[2], hit.begin - START, hit.end - START) for hit in alone.hits]
    assert spans == [("a.mcap", SECOND, 2 * SECOND), ("b.mcap", 3 * SECOND, 5 * SECOND)]
    # c.mcap registers the topic and has no message on it
    together = recordings([tmp_path], together=True)
    (hit,) = find(together, signal, Condition(above=1.0), 5 * SECOND).hits
    assert (hit.begin - START, hit.end - START) == (SECOND, 5 * SECOND)


def test_hits_are_counted_beyond_those_that_are_kept(tmp_path):
    path = drive_of(tmp_path / "drive.mcap", [float(i % 2) for i in range(2 * MOST_HITS + 200)])
    each = recordings([path])
    found = find(each, signal_of(BARE, each), Condition(above=0.5), 5 * SECOND)
    assert (len(found.hits), found.count) == (MOST_HITS, MOST_HITS + 100)


@pytest.mark.parametrize(
    ("condition", "says"),
    [
        ({}, "expected one thing to find"),
        ({"above": 1.0, "stuck": True, "at_least": 1}, "expected one thing to find"),
        ({"above": 2.0, "below": 1.0}, "nothing is above 2 and below 1"),
        ({"above": 2.0, "below": 2.0}, "nothing is above 2 and below 2"),
        ({"faster": -1.0}, "expected at least zero"),
        ({"above": 1.0, "at_least": -SECOND}, "-1 s is negative"),
        ({"stuck": True}, "expected for how long"),
        ({"missing": True}, "expected for how long"),
    ],
)
def test_nothing_that_could_not_be_found_is_looked_for(condition, says):
    with pytest.raises(RobophmError, match=says):
        Condition(**condition)


def test_names_that_are_not_there(tmp_path):
    each = recordings([drive_of(tmp_path / "drive.mcap", [1.0])])
    for name, hint in (
        ("/levle.data", "did you mean '/level'"),
        ("/level.dta", "no number 'dta'; did you mean 'data'"),
        ("/level", "names no field; expected '/topic.field'; e.g. '/level.data'"),
        ("/motor/temperature.header.frame_id", "has no number 'header.frame_id'"),
    ):
        with pytest.raises(SourceError, match=hint):
            signal_of(name, each)


def test_the_same_recording_twice_is_refused(tmp_path):
    path = drive_of(tmp_path / "drive.mcap", [1.0])
    drive_of(tmp_path / "alike.mcap", [2.0])  # another of the same size
    assert (tmp_path / "alike.mcap").stat().st_size == path.stat().st_size
    assert len(recordings([tmp_path])) == 2
    (tmp_path / "last.mcap").write_bytes(path.read_bytes())
    with pytest.raises(SourceError, match=r"drive.mcap and .*last.mcap are the same recording"):
        recordings([tmp_path])
    with pytest.raises(SourceError, match="are the same recording"):
        recordings([path, path])


def test_a_cut_recording_is_read_as_far_as_it_is_whole(tmp_path):
    path = drive_of(tmp_path / "drive.mcap", [2.0] * 2000)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(SourceError):
        Recording(path)
    each = recordings([path])
    found = find(each, signal_of(BARE, each), Condition(above=1.0), 5 * SECOND)
    assert any("lost" in note or "cut" in note for note in found.notes)
