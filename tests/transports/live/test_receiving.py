"""Ten thousand damaged messages into a live source: none ends it, each is counted or read, memory is bounded."""

from __future__ import annotations

import random
import resource
from collections import Counter
from typing import Any

import numpy as np
import pytest

from robophm.core.signal import Sample
from robophm.transports.health_topics.definitions import definition, typestore
from robophm.transports.health_topics.message_of_fields import compose
from robophm.transports.live.decoding import TopicDecoder
from robophm.transports.live.receiving import Queue, Receiver
from robophm.transports.signals.incidents import MOST_KINDS, OTHER_KINDS, Incidents
from robophm.transports.signals.source import Gap, WholeMessage
from robophm.transports.tasks import TaskTopics

MESSAGES = 10_000
KINDS: dict[str, tuple[str, list[str], dict[str, Any]]] = {
    "/joints": ("sensor_msgs/msg/JointState", ["effort[1]", "position[0]"],
                {"name": ["a", "b"], "position": [1.0, 2.0], "effort": [3.0, 4.0]}),
    "/warm": ("sensor_msgs/msg/Temperature", ["temperature"], {"temperature": 30.0}),
    "/odom": ("nav_msgs/msg/Odometry", ["pose.pose.position.x"], {"child_frame_id": "base"}),
    "/robot_task_list": ("std_msgs/msg/String", [], {"data": "[[0, 0, 0.5], [3, 4, 0.5]]"}),
    "/plan": ("nav_msgs/msg/Path", [], {"poses": [{}, {"pose": {"position": {"x": 2.0}}}]}),
}  # fmt: skip
LITERALS = [
    "[" * 100_000, "[[0,0,1]" + ",[1,1,1]" * 200_000 + "]", "__import__('os').system('false')", "[[1e999, nan, -inf]]",
    "9" * 1_000_000, "[[0, 0, 0.5], [3, 4, lambda: 0]]", "\x00\udcff", "{'a': 1}", "[[0,0,0.5],[3,4]]",
]  # fmt: skip


def damaged(raw: bytes, chance: random.Random) -> bytes:
    """Bytes flipped, cut, repeated, or lengths that lie."""
    some = bytearray(raw)
    for _ in range(chance.choice([0, 1, 1, 4, 30])):
        match chance.randrange(4):
            case 0 if some:
                some[chance.randrange(len(some))] ^= 1 << chance.randrange(8)
            case 1:
                del some[chance.randrange(len(some) + 1) :]
            case 2 if len(some) > 4:
                at = chance.randrange(len(some) - 3)
                some[at : at + 4] = chance.choice([0, 1, 1 << 16, 1 << 31, 0xFFFFFFFF]).to_bytes(4, "little")
            case 3:
                at = chance.randrange(len(some) + 1)
                some[at:at] = some[: chance.randrange(64)]
    return bytes(some)


@pytest.mark.parametrize("generation", [1, 2])
def test_damaged_messages(generation: Any) -> None:
    from robophm.transports.ros1.definition import compiled
    from robophm.transports.ros2_dds.definition import defined

    chance, notes, heard = random.Random(generation), Incidents(), Counter[str]()
    listener = TaskTopics(notes)

    def put(some: Any) -> None:
        for one in some:
            if isinstance(one, WholeMessage):
                listener.hear(*one)
                heard["whole"] += 1
            elif isinstance(one, Sample):
                assert isinstance(one.value, float)
                heard["samples"] += 1

    hearing = Receiver(notes, put, ["/robot_task_list", "/plan", "/odom"], simulated=False)
    store = typestore(generation)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    readings, raws = {}, {}
    for topic, (name, fields, content) in KINDS.items():
        text = definition(name, generation)
        type_ = (
            compiled(topic, name.replace("/msg/", "/"), text) if generation == 1 else defined(topic, name, text).type
        )
        readings[topic] = TopicDecoder(topic, type_, [f"{topic}.{field}" for field in fields], "x")
        message = compose(store, name, content)
        raws[topic] = bytes((store.serialize_ros1 if generation == 1 else store.serialize_cdr)(message, name))
    for _ in range(MESSAGES):
        topic = chance.choice(list(KINDS))
        hearing.messages(readings[topic], [damaged(raws[topic], chance)], None)
    for literal in LITERALS:
        text = compose(store, "std_msgs/msg/String", {})
        text.data = literal
        try:
            raw = bytes((store.serialize_ros1 if generation == 1 else store.serialize_cdr)(text, "std_msgs/msg/String"))
        except UnicodeEncodeError:
            continue
        hearing.messages(readings["/robot_task_list"], [raw], None)
    unreadable = {topic: notes[f"unreadable message on {topic}"] for topic in KINDS}
    assert all(count > 200 for count in unreadable.values()), unreadable
    assert heard["samples"] > 1000
    assert heard["whole"] > 1000
    assert any(what.startswith("no task in a message on /robot_task_list") for what in notes)
    assert len(notes) < 40  # kinds, not messages
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 512 * 1024
    hearing.messages(readings["/warm"], [raws["/warm"]], None)
    assert np.isfinite(heard["samples"])


def test_a_queue_hands_on_whole_messages_in_order_and_counts_what_does_not_fit() -> None:
    notes = Incidents()
    queue = Queue(notes, 5)
    taken = queue.taken(lambda: None)
    messages = [[Sample(number, f"/t.{field}", float(number)) for field in "ab"] for number in range(3)]
    for message in messages:
        queue.put(message)
    queue.put([Sample(3, "/u.c", 3.0)])
    queue.hand_on()
    assert [next(taken) for _ in range(4)] == [*messages[0], *messages[1]]
    queue.put(messages[2])  # what was taken left room
    queue.hand_on()
    queue.end()
    assert list(taken) == [Gap("/t", "queue full"), Sample(3, "/u.c", 3.0), *messages[2]]
    assert notes == {"queue full, dropped /t.a": 1, "queue full, dropped /t.b": 1}


def test_kinds_of_incidents_have_a_bound_whatever_others_name() -> None:
    notes = Incidents()
    for number in range(3 * MOST_KINDS):
        notes.add(f"{number} {'x' * 10_000}")
        notes.add("known")
    assert len(notes) == MOST_KINDS + 1
    assert max(map(len, notes)) <= 500
    assert notes["known"] == 3 * MOST_KINDS
    assert notes[OTHER_KINDS] == 2 * MOST_KINDS + 1
