"""Publishers, types and clocks that come, go and change while we listen."""

from __future__ import annotations

import struct
import time
from collections.abc import Callable
from itertools import pairwise

from robophm.core.signal import SECOND
from robophm.transports.ros2_dds import Ros2Dds
from robophm.transports.signals.source import LiveSource

from ..listener import Heard, within
from .conftest import FLOAT64, TEMPERATURE, Peer, published

CLOCK = "rosgraph_msgs::msg::dds_::Clock_"


def cdr(layout: str, *numbers: float) -> str:
    return (bytes.fromhex("00010000") + struct.pack("<" + layout, *numbers)).hex()


def test_a_publisher_that_is_killed_and_comes_back_in_another_process(
    start: Callable[[], Peer], live: LiveSource
) -> None:
    first = start()
    first.writer("/count", TEMPERATURE)
    published(live, "/count")
    heard = Heard(live, "/count.temperature")
    first.matched()
    first.tell("count w 20")
    within(5, lambda: heard.of("/count.temperature") == list(range(20)))
    first.ask("close w", "sent")  # of the count
    assert first.line() == "closed"
    within(5, lambda: live.notes["connection lost on /count"] == 1)
    clocks = len(heard.of("clock"))
    within(5, lambda: len(heard.of("clock")) >= clocks + 2)  # silence is heard
    other = start()
    other.writer("/count", TEMPERATURE, "reliable latched")
    other.tell("temperature w 0 0 - 77 0")
    within(5, lambda: heard.of("/count.temperature") == [*range(20), 77])
    within(5, lambda: live.notes["connected again to /count"] == 1)
    assert live.notes["type changed on /count"] == 0


def test_a_topic_whose_type_changes(start: Callable[[], Peer], live: LiveSource) -> None:
    first = start()
    first.writer("/changing", FLOAT64, "reliable latched")
    first.tell("float64 w 1.5")
    heard = Heard(live, "/changing.data")
    within(8, lambda: heard.of("/changing.data") == [1.5])
    first.ask("close w", "closed")
    other = start()
    other.writer("/changing", TEMPERATURE)
    within(8, lambda: live.notes["no field data on /changing"] == 1)
    other.ask("close w", "closed")
    third = start()
    third.writer("/changing", "std_msgs::msg::dds_::Int16_", "besteffort volatile")
    third.matched()
    third.tell(f"raw w {cdr('h', -3)}")
    within(8, lambda: heard.of("/changing.data") == [1.5, -3])
    assert live.notes["type changed on /changing"] == 1


def test_a_publisher_that_offers_less_than_those_before(start: Callable[[], Peer], live: LiveSource) -> None:
    first, other = start(), start()
    first.writer("/quality", FLOAT64, "reliable latched")
    first.tell("float64 w 1")
    heard = Heard(live, "/quality.data")
    within(8, lambda: heard.of("/quality.data") == [1])
    other.writer("/quality", FLOAT64, "besteffort volatile")
    other.matched()
    first.matched()
    other.tell("float64 w 2")
    within(5, lambda: heard.of("/quality.data") == [1, 2])
    first.tell("float64 w 3")
    within(5, lambda: heard.of("/quality.data") == [1, 2, 3])
    assert live.notes["subscribed again to /quality, for a publisher that offers less"] == 1


def test_simulated_time_that_jumps_back(peer: Peer, live: LiveSource) -> None:
    peer.writer("/clock", CLOCK, "besteffort volatile", name="clock")
    peer.writer("/level", FLOAT64)
    peer.writer("/warm", TEMPERATURE, name="warm")
    published(live, "/clock", "/level", "/warm")
    heard = Heard(live, "/level.data", "/warm.temperature")
    for name in ("clock", "w", "warm"):
        peer.matched(name=name)

    def time_is(seconds: int) -> None:
        peer.tell(f"raw clock {cdr('iI', seconds, 500)}")
        within(5, lambda: any(s.time == seconds * SECOND + 500 and s.signal == "clock" for s in heard.samples))

    peer.tell("float64 w 1")
    within(5, lambda: live.notes["before the first time of /clock, dropped /level"] == 1)
    time_is(1000)
    peer.tell("float64 w 2")
    within(5, lambda: heard.of("/level.data") == [2])
    peer.tell("temperature warm 995 7 - 1 0", "temperature warm 500 7 - 2 0")
    within(5, lambda: len(heard.of("/warm.temperature")) == 2)
    began_anew = "/clock began anew; time goes on from where it was"

    def begins_anew() -> bool:
        peer.tell(f"raw clock {cdr('iI', 40, 500)}")
        return live.notes[began_anew] == 1

    within(10, begins_anew)
    peer.tell(f"raw clock {cdr('iI', 43, 500)}")
    within(5, lambda: any(s.time == 1003 * SECOND + 500 and s.signal == "clock" for s in heard.samples))
    peer.tell("float64 w 3", "temperature warm 42 500 - 3 0")
    within(5, lambda: heard.of("/level.data") == [2, 3] and len(heard.of("/warm.temperature")) == 3)
    assert [(s.signal, s.time) for s in heard.samples if s.signal != "clock"] == [
        ("/level.data", 1000 * SECOND + 500),
        ("/warm.temperature", 995 * SECOND + 7),
        ("/warm.temperature", 1000 * SECOND + 500),
        ("/level.data", 1003 * SECOND + 500),
        ("/warm.temperature", 1002 * SECOND + 500),
    ]
    assert live.notes["receipt time used for /warm"] == 1


def test_simulated_time_that_comes_late(peer: Peer, live: LiveSource) -> None:
    """80 s of a simulator that is started while one listens are 80 s, however fast it is."""
    peer.writer("/level", FLOAT64)
    published(live, "/level")
    heard = Heard(live, "/level.data")
    peer.matched()
    peer.tell("float64 w 1")
    within(5, lambda: heard.of("/level.data") == [1])
    peer.writer("/clock", CLOCK, "besteffort volatile", name="clock")
    peer.matched(name="clock")

    def counts() -> bool:
        peer.tell(f"raw clock {cdr('iI', 100, 0)}")
        return "/clock does not follow on what was heard before; time goes on from there, by /clock" in live.notes

    within(10, counts)
    peer.tell("float64 w 2")
    within(5, lambda: heard.of("/level.data") == [1, 2])
    before = len(heard.samples)

    def goes_on() -> bool:
        peer.tell(f"raw clock {cdr('iI', 180, 0)}")  # again and again, as a message that is lost is not sent anew
        return any(later.time - sooner.time > 79 * SECOND for sooner, later in pairwise(heard.samples[before - 1 :]))

    within(5, goes_on)
    peer.tell("float64 w 3")
    within(5, lambda: heard.of("/level.data") == [1, 2, 3])
    first, second, third = [s.time for s in heard.samples if s.signal == "/level.data"]
    assert first < second
    assert third - second == 80 * SECOND
    assert abs(second - time.time_ns()) < 3600 * SECOND  # on from where it was


def test_a_burst_beyond_the_queue_is_counted_to_the_last_message(peer: Peer, live: LiveSource) -> None:
    sent = 10_000
    peer.writer("/burst", TEMPERATURE)
    published(live, "/burst")
    with Ros2Dds(queue=1000) as source:
        samples = source.samples(["/burst.temperature"])
        peer.matched()
        peer.ask(f"count w {sent}", "sent")
        within(20, lambda: source.notes["receipt time used for /burst"] == sent)
        values = [sample.value for sample, _ in zip(samples, range(1000), strict=False) if sample.signal != "clock"]
        assert values == list(range(len(values)))  # the newest were dropped
        assert source.notes["queue full, dropped /burst.temperature"] == sent - len(values) > 0


def test_many_topics_at_once(peer: Peer, live: LiveSource) -> None:
    """As fast as Fast DDS sends them: all arrive, each topic's in order."""
    topics, each = 40, 250
    for number in range(topics):
        peer.writer(f"/many/t{number}", TEMPERATURE, name=str(number))
    published(live, *(f"/many/t{number}" for number in range(topics)))
    heard = Heard(live, *(f"/many/t{number}.temperature" for number in range(topics)))
    for number in range(topics):
        peer.matched(name=str(number))
    peer.tell(*(f"count {number} {each}" for number in range(topics)))
    within(30, lambda: sum(s.signal != "clock" for s in list(heard.samples)) == topics * each)
    for number in range(topics):
        assert heard.of(f"/many/t{number}.temperature") == list(range(each))
    assert {*live.notes} == {f"receipt time used for /many/t{number}" for number in range(topics)}
