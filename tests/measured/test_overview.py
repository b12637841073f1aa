"""What a recording holds is what its messages, one after the other, say."""

import itertools
import statistics

import pytest

from robophm.core.signal import SECOND
from robophm.measured.overview import MOST_GAPS, overview, per_second
from robophm.measured.recordings import recordings
from robophm.transports.recordings.recording import Recording

from .plain import START, write


def told(path):
    with Recording(path) as recording:
        topics = [info.topic for info in recording.topics()]
        found = {topic: [] for topic in topics}
        for received, topic, _ in recording.messages(topics, 1 << 20):
            found[topic].append(received)
        return recording.topics(), found


def check(path):
    (recorded,) = recordings([path])
    infos, received = told(path)
    seen = overview(recorded)
    assert [(one.name, one.type, tuple(one.fields), one.messages, one.first, one.last) for one in seen.topics] == [
        (info.topic, info.type, info.fields, info.messages, info.first, info.last) for info in infos
    ]
    for one in seen.topics:
        times = received[one.name]
        apart = [b - a for a, b in itertools.pairwise(times)]
        if not apart:
            continue
        assert one.interval == int(statistics.median(apart))
        gaps = [(a, wait) for a, wait in zip(times, apart, strict=False) if wait >= max(10 * one.interval, 1)]
        longest = sorted(gaps, key=lambda gap: -gap[1])[:MOST_GAPS]
        assert sorted(one.gaps) == sorted(longest)
        assert one.gap_count == len(gaps)
        assert one.gap_length == sum(length for _, length in gaps)
        assert one.longest_gap == max(gaps, key=lambda gap: gap[1], default=None)
        assert one.span == (min(times), max(times))
    every = [time for times in received.values() for time in times]
    assert seen.span == (min(every), max(every))
    return seen


def test_a_drive(tmp_path):
    at = [0, 1, 2, 3, 40, 41, 42, 200]
    messages = [(START + t * SECOND, START + t * SECOND if t % 2 else None, 1.0) for t in at]
    messages += [(START + 300 * SECOND + i, None, 0.0) for i in range(3000)]
    seen = check(write(tmp_path / "drive.mcap", messages, 200))
    assert seen.topics[1].fields["temperature"] == "degC"


@pytest.mark.parametrize("file", ["turtlesim.bag", "temperature.bag"])
def test_recordings_of_others(shared, file):
    check(shared / "recordings" / file)


def test_a_day(day):
    seen = overview(*recordings([day]), gap=20 * SECOND)
    plan = next(one for one in seen.topics if one.name == "/ota/plan")
    (_, received) = told(day)
    times = received["/ota/plan"]
    gaps = [(a, b - a) for a, b in itertools.pairwise(times) if b - a >= 20 * SECOND]
    assert plan.gaps == gaps
    heard = times[-1] - times[0] - sum(length for _, length in gaps)
    if heard:
        assert per_second(plan) == pytest.approx((len(times) - 1 - len(gaps)) * SECOND / heard)


@pytest.mark.parametrize("burst", [5, 100, 1000])
def test_messages_in_bursts_are_not_silence_between_them(tmp_path, burst):
    """So many within 20 ms, every minute for half an hour: the rate is theirs over the whole span."""
    at = [START + minute * 60 * SECOND + i * 20_000_000 // burst for minute in range(30) for i in range(burst)]
    (recorded,) = recordings([write(tmp_path / "drive.mcap", [(time, time, 1.0) for time in at], 200)])
    (topic,) = [one for one in overview(recorded).topics if one.messages == len(at)]
    assert topic.bursts
    assert per_second(topic) == pytest.approx((len(at) - 1) * SECOND / (at[-1] - at[0]))


def test_nights_are_silence(tmp_path):
    """A message a second on three days of an hour: a message a second."""
    at = [START + day * 86400 * SECOND + second * SECOND for day in range(3) for second in range(3600)]
    (recorded,) = recordings([write(tmp_path / "drive.mcap", [(time, time, 1.0) for time in at], 200)])
    (topic,) = [one for one in overview(recorded).topics if one.messages == len(at)]
    assert not topic.bursts
    assert per_second(topic) == pytest.approx(1.0)


def test_why_a_topic_has_no_numbers_is_told(tmp_path):
    from mcap.writer import Writer

    path = tmp_path / "drive.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        for topic, type_, encoding, definition in (
            ("/text", "std_msgs/msg/String", "cdr", b"string data\n"),
            ("/proto", "foo.Bar", "flatbuffer", b""),
            ("/broken", "a_msgs/msg/B", "cdr", b"b_msgs/C[] gone\n"),
            ("/number", "std_msgs/msg/Float64", "cdr", b"float64 data\n"),
        ):
            schema = writer.register_schema(type_, "ros2msg", definition)
            channel = writer.register_channel(topic, encoding, schema)
            writer.add_message(channel, START, b"\0\1\0\0" + bytes(8), START)
        writer.finish()
    (recorded,) = recordings([path])
    why = {one.name: one.no_numbers for one in overview(recorded).topics}
    assert why.pop("/number") == ""
    assert why.pop("/text") == "its type has none"
    assert why.pop("/proto") == "is encoded as 'flatbuffer'; expected cdr, ros1, json, cbor or protobuf"
    assert why.pop("/broken") == "the definition of its type 'a_msgs/msg/B' is missing or damaged"
    assert not why
