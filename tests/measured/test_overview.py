"""What a recording holds is what its messages, one after the other, say."""

import itertools
import statistics

import pytest

from robophm.core.signal import SECOND
from robophm.measured.overview import MOST_GAPS, overview, per_second, within_bursts
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
        assert within_bursts(plan) == pytest.approx((len(times) - 1 - len(gaps)) * SECOND / heard)


def heard(path, times):
    """The topic of messages at these times [ns]."""
    (recorded,) = recordings([write(path, [(time, time, 1.0) for time in times], 200)])
    return next(one for one in overview(recorded).topics if one.messages == len(times))


@pytest.mark.full
@pytest.mark.parametrize("burst", [5, 100, 1000])
@pytest.mark.parametrize("bursts", [2, 3, 10, 11, 30])
def test_rates_of_bursts(tmp_path, burst, bursts):
    """So many within 20 ms, every minute: of eleven bursts on the rate is theirs over the whole span, before it may be
    either."""
    apart = 20_000_000 // burst
    topic = heard(tmp_path / "drive.mcap", [START + k * 60 * SECOND + i * apart for k in range(bursts)
                                            for i in range(burst)])  # fmt: skip
    whole = (bursts * burst - 1) * SECOND / ((bursts - 1) * 60 * SECOND + (burst - 1) * apart)
    within = SECOND / apart
    assert topic.bursts is (True if bursts > 10 else None)
    assert topic.burst_size == burst
    assert within_bursts(topic) == pytest.approx(within, rel=1e-12)
    assert per_second(topic) == pytest.approx((whole, whole if bursts > 10 else within), rel=1e-12)


@pytest.mark.full
def test_rates_without_gaps_and_with_few(tmp_path):
    """Ten a second for an hour; the same with ten seconds of silence, which is a thousandth of it."""
    steps = [START + step * SECOND // 10 for step in range(36_000)]
    even = heard(tmp_path / "even.mcap", steps)
    assert (even.bursts, per_second(even)) == (False, pytest.approx((10.0, 10.0), rel=1e-12))
    silent = heard(tmp_path / "silent.mcap", [one for one in steps if not 1000 <= (one - START) // SECOND < 1010])
    assert (silent.bursts, silent.gap_count) == (False, 1)
    assert per_second(silent) == pytest.approx((10.0, 10.0), rel=1e-12)


def test_nights_are_silence_or_not(tmp_path):
    """A message a second on three days of an hour: one a second while it spoke, 3 hours' of them in 49 hours."""
    at = [START + day * 86400 * SECOND + second * SECOND for day in range(3) for second in range(3600)]
    topic = heard(tmp_path / "drive.mcap", at)
    assert per_second(topic) == pytest.approx(((3 * 3600 - 1) / (2 * 86400 + 3599), 1.0), rel=1e-12)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_rates_of_messages_at_one_time_are_not_told(tmp_path, count):
    assert per_second(heard(tmp_path / "drive.mcap", [START] * count)) is None


def test_why_a_topic_has_no_numbers_is_told(tmp_path):
    from mcap.writer import Writer

    path = tmp_path / "drive.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        for topic, type_, encoding, definition in (
            ("/text", "std_msgs/msg/String", "cdr", b"string data\n"),
            ("/proto", "foo.Bar", "flexbuffer", b""),
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
    assert (
        why.pop("/proto")
        == "is encoded as 'flexbuffer'; expected cdr, ros1, json, cbor, msgpack, protobuf or flatbuffer"
    )
    assert why.pop("/broken") == "the definition of its type 'a_msgs/msg/B' is missing or damaged"
    assert not why
