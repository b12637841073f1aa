"""Tasks in recordings of both generations of ROS, and what is said of messages that tell of none."""

from __future__ import annotations

import math
import random
import re
import subprocess
import sys
import time as clock
from collections import Counter
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.recording import Recording
from robophm.transports.tasks import (
    LONGEST_MESSAGE,
    DoneLeg,
    DoneTask,
    PlannedLeg,
    PlannedTask,
    TaskListener,
    TaskTopics,
    tasks_of,
    told_by,
)
from robophm.transports.tasks.listener import topics_to_hear
from robophm.transports.tasks.recorded import tasks_in

from .told import ODOMETRY, T0, TEXT, Message, read, record


def heard(*messages: Message) -> tuple[list[PlannedTask | DoneTask], Counter[str]]:
    """What a live listener makes of texts."""
    listener = TaskListener()
    found = [listener.hear(T0 + round(after * SECOND), topic, text) for topic, after, text in messages]  # type: ignore[arg-type]
    listener.end()
    return [task for task in found if task], listener.notes


DAY: list[Message] = [
    ("/robot_task_list", 1, "[[0, 0, 0.5], [3, 4, 0.25], [3, 6, 0]]"),
    ("/plan", 1.5, [(0.0, 0.0), (3.0, 4.0), (3.0, 6.0)]),
    ("/r2/robot_task_list", 2, "([1, 1, 2], (1, 2, 9))"),
    ("/task_time", 21, "[10.5, 9]"),
    ("/r2/task_positions", 21.125, "[[1, 1], [1, 2]]"),
    ("/task_position", 21.25, "[[0, 0], [3, 4], [3, 6]]"),
    ("/chatter", 22, "hello"),
    ("/r2/task_time", 23, "(7.2,)"),
]
"""Legs of 5 m (3, 4, 5) and 2 m; of two robots, whose messages come in either order."""

EXPECTED = [
    PlannedTask(T0 + SECOND, "/robot_task_list", (PlannedLeg(5.0, 0.5), PlannedLeg(2.0, 0.25))),
    PlannedTask(T0 + 2 * SECOND, "/r2/robot_task_list", (PlannedLeg(1.0, 2.0),)),
    DoneTask(
        T0 + 1_750_000_000,  # 21.25 s − 19.5 s
        T0 + 21_250_000_000,
        "/task_time",
        (DoneLeg(5.0, 10.5 / 3600), DoneLeg(2.0, 9 / 3600)),
    ),
    DoneTask(T0 + 15_800_000_000, T0 + 23 * SECOND, "/r2/task_time", (DoneLeg(1.0, 7.2 / 3600),)),
]


def test_tasks_of_every_format(new: Path) -> None:
    path = record(new, DAY)
    assert read(path) == (EXPECTED, Counter())
    assert read(path, ["/r2/robot_task_list"]) == (EXPECTED[1:2], Counter())
    assert read(path, []) == ([], Counter())


def test_a_path_is_read_where_it_is_asked_for(new: Path) -> None:
    task = PlannedTask(T0 + 1_500_000_000, "/plan", (PlannedLeg(7.0, None),))
    assert read(record(new, DAY), ["/plan", "/robot_task_list"]) == ([EXPECTED[0], task], Counter())


def test_a_live_listener_hears_the_same() -> None:
    texts = [message for message in DAY if message[0] not in ("/plan", "/chatter")]
    assert heard(*texts) == (EXPECTED, Counter())
    listener = TaskListener()
    assert listener.hear_path(T0, "/plan", [(0, 0), (3, 4)]) == PlannedTask(T0, "/plan", (PlannedLeg(5.0, None),))


def test_a_pair_over_two_files(tmp_path: Path) -> None:
    one = record(tmp_path / "one.bag", [("/task_time", 10, "[2]")])
    two = record(tmp_path / "two.bag", [("/task_position", 11, "[[0, 0], [0, 3]]")])
    with Recording(two, one) as recording:
        assert list(tasks_of(recording)) == [
            DoneTask(T0 + 9 * SECOND, T0 + 11 * SECOND, "/task_time", (DoneLeg(3.0, 2 / 3600),))
        ]


# Messages that tell of no task


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[[0, 0, 1], [1, 1, 0], [2, 2, 1]]", "leg 2 of 1.41421 m has a speed of 0 m/s; expected one above zero"),
        ("[[0, 0, -1], [1, 0, 1]]", "leg 1 of 1 m has a speed of -1 m/s; expected one above zero"),
        ("[[0, 0, 1e-320], [1, 0, 1]]", "leg 1 of 1 m has a speed of 9.99989e-321 m/s; expected one above zero"),
        ("[[0, 0, 1]]", "1 positions; expected at least 2"),
        ("[]", "0 positions; expected at least 2"),
        ("[[0, 0, 1], [1, 1]]", "position 2 has 2 numbers; expected [x, y, speed]"),
        ("[[0, 0, 1, 2], [1, 1, 1]]", "position 1 has 4 numbers; expected [x, y, speed]"),
        ("[[-1e308, 0, 1], [1e308, 0, 1]]", "a distance of inf m; expected a finite one"),
        ("[0, 0, 1]", "character 2: expected a list, '[' or '('; found '0, 0, 1]'"),
        ("__import__('os').system('touch broken')", "character 1: expected a list, '[' or '('; found \"__import__("),
    ],
)
def test_unreadable_plans(text: str, reason: str) -> None:
    tasks, notes = heard(("/robot_task_list", 1, text), ("/robot_task_list", 2, "[[0, 0, 1], [2, 0, 1]]"))
    assert tasks == [PlannedTask(T0 + 2 * SECOND, "/robot_task_list", (PlannedLeg(2.0, 1.0),))]
    ((note, count),) = notes.items()
    assert count == 1
    assert note.startswith(f"no task in a message on /robot_task_list (the first: {reason}")


@pytest.mark.parametrize(
    ("times", "positions", "reason"),
    [
        ("[1, 2]", "[[0, 0], [1, 1]]", "2 times with 2 positions; expected 1"),
        ("[5]", "[]", "0 positions; expected at least 2"),
        ("[5, 0]", "[[0, 0], [1, 0], [2, 0]]", "leg 2 of 1 m took 0 s; expected a time above zero"),
        ("[1e300]", "[[0, 0], [1, 0]]", "took 1e+300 s; expected no more than have passed since the epoch"),
        ("[1e308, 1e308]", "[[0, 0], [1, 0], [2, 0]]", "took inf s; expected no more than have passed since the epoch"),
        ("[5]", "[[-1e308, 0], [1e308, 0]]", "a distance of inf m; expected a finite one"),
    ],
)
def test_halves_that_do_not_fit(times: str, positions: str, reason: str) -> None:
    assert_refused(times, positions, {f"no task in a message on /task_time (the first: {reason})": 1})


@pytest.mark.parametrize(
    ("times", "positions", "broken", "reason"),
    [
        ("[5, -1]", "[[0, 0], [1, 0], [2, 0]]", "time", "leg 2 took -1 s; expected no negative time"),
        ("[5", "[[0, 0], [1, 0]]", "time", "character 3: expected ',' or ']'; found the end"),
        ("[5]", "[[0, 0], [1, 0, 0]]", "position", "position 2 has 3 numbers; expected [x, y]"),
        ("[5]", "[[0, 0]", "position", "character 8: expected ',' or ']'; found the end"),
    ],
)
def test_unreadable_halves(times: str, positions: str, broken: str, reason: str) -> None:
    """The half is counted, its other half too, and neither becomes part of the next task."""
    other = {"time": "position", "position": "time"}[broken]
    refused = f"no task in a message on /task_{broken} (the first: {reason})"
    assert_refused(times, positions, {refused: 1, f"/task_{other} without its other half": 1})


def assert_refused(times: str, positions: str, expected: dict[str, int]) -> None:
    """In either order; and the task after it is read."""
    halves: list[Message] = [("/task_time", 10, times), ("/task_position", 10.5, positions)]
    later: list[Message] = [("/task_time", 100, "[5]"), ("/task_position", 101, "[[0, 0], [1, 0]]")]
    for one, other in (halves, halves[::-1]):
        tasks, notes = heard(one, other, *later)
        assert tasks == [DoneTask(T0 + 96 * SECOND, T0 + 101 * SECOND, "/task_time", (DoneLeg(1.0, 5 / 3600),))]
        assert notes == expected


def test_standing_still_for_no_time_is_a_leg() -> None:
    (task,), notes = heard(("/task_time", 10, "[0, 5]"), ("/task_position", 10, "[[0, 0], [0, 0], [1, 0]]"))
    assert isinstance(task, DoneTask)
    assert task.legs == (DoneLeg(0.0, 0.0), DoneLeg(1.0, 5 / 3600))
    assert not notes


def test_halves_of_two_tasks_are_no_task() -> None:
    """Whatever is lost or broken: every task has its own times and places, and every other message is counted."""
    chance = random.Random(1)
    complete = 0
    for _ in range(300):
        messages: list[tuple[str, float, str | None]] = []
        whole = []
        now = 0.0
        for number in range(1, 20):
            legs, duration = chance.randint(1, 2), chance.uniform(10, 20)
            now += 21 + chance.uniform(0, 30)
            fates = [chance.choices(["well", "lost", "broken"], [8, 1, 1])[0] for _ in range(2)]
            texts = (str([duration / legs] * legs), str([[number * i, 0] for i in range(legs + 1)]))
            halves: list[tuple[str, float, str | None]] = [
                (topic, now + chance.uniform(0, 1), text if fate == "well" else None)
                for topic, text, fate in zip(("/task_time", "/task_position"), texts, fates, strict=True)
                if fate != "lost"
            ]
            messages += sorted(halves, key=lambda half: half[1])
            if fates == ["well", "well"]:
                whole.append((float(number), legs, duration))
        listener = TaskListener()
        found = [listener.hear(T0 + round(after * SECOND), topic, text) for topic, after, text in messages]
        listener.end()
        tasks = [task for task in found if isinstance(task, DoneTask)]
        for task in tasks:
            key = (task.legs[0].distance, len(task.legs), sum(leg.duration for leg in task.legs) * 3600)
            assert any(key == pytest.approx(one) for one in whole)
        well = sum(text is not None for *_, text in messages)
        assert 2 * len(tasks) + sum(listener.notes.values()) == well
        complete += len(tasks) / max(len(whole), 1)
    assert complete / 300 > 0.95


def test_notes_have_a_bound() -> None:
    _, notes = heard(*[("/robot_task_list", number, f"[{number}]") for number in range(1000)])
    assert list(notes.values()) == [1000]


def test_hostile_messages_are_counted_and_the_rest_is_read(new: Path) -> None:
    hostile = [
        "[" * 100_000,
        "[" + "9," * 600_000,
        "[1e999, 1]",
        "[nan, 1]",
        "__import__('os').system('touch broken')",
        "[１, ２]",
        "\0" * 100,
        "[" * (LONGEST_MESSAGE + 1),
    ]
    topics = ("/robot_task_list", "/task_time", "/task_position")
    messages: list[Message] = [(topic, 1, text) for topic in topics for text in hostile]
    path = record(new, messages + [(topic, after + 100, content) for topic, after, content in DAY])
    begun = clock.process_time()
    tasks, notes = read(path)
    assert clock.process_time() - begun < 10
    assert len(tasks) == 4
    assert sum(notes.values()) == len(messages)
    assert {key: count for key, count in notes.items() if "longer" in key} == {
        f"message on {topic} longer than {LONGEST_MESSAGE} bytes": 1 for topic in topics
    }
    assert not Path("broken").exists()


def test_a_damaged_message_is_counted(tmp_path: Path, write_messages: Callable[..., Path]) -> None:
    from mcap.reader import make_reader
    from mcap.writer import Writer

    messages = [
        (topic, TEXT, T0 + number * SECOND, lambda types, text=text: types[TEXT](text))
        for number, (topic, text) in enumerate([("/task_time", "[5]"), ("/task_position", "[[0, 0], [1, 0]]")])
    ]
    good = write_messages(tmp_path / "good.mcap", messages)
    with good.open("rb") as old, (tmp_path / "bad.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        channels: dict[str, int] = {}
        whole = []
        for schema, channel, message in make_reader(old).iter_messages():
            assert schema
            id_ = writer.register_schema(schema.name, schema.encoding, schema.data)
            channels[channel.topic] = writer.register_channel(channel.topic, channel.message_encoding, id_)
            whole.append((channel.topic, message.data))
        broken = [(topic, data[:6] if topic == "/task_time" else data) for topic, data in whole]
        for number, (topic, data) in enumerate(broken + whole):
            writer.add_message(channels[topic], T0 + number * SECOND, data, T0)
        writer.finish()
    tasks, notes = read(tmp_path / "bad.mcap")
    assert tasks == [DoneTask(T0 - 2 * SECOND, T0 + 3 * SECOND, "/task_time", (DoneLeg(1.0, 5 / 3600),))]
    assert notes == {"unreadable message on /task_time": 1, "/task_position without its other half": 1}


def test_paths_that_lead_nowhere(new: Path) -> None:
    paths: list[Message] = [("/plan", 1, []), ("/plan", 2, [(1.0, 1.0)]), ("/plan", 3, [(0.0, 0.0), (math.nan, 0.0)])]
    tasks, notes = read(record(new, [*paths, ("/plan", 4, [(0.0, 0.0), (0.0, 2.0)])]), ["/plan"])
    assert tasks == [PlannedTask(T0 + 4 * SECOND, "/plan", (PlannedLeg(2.0, None),))]
    assert notes == {"no task in a message on /plan (the first: 0 positions; expected at least 2)": 3}


def test_a_path_that_is_planned_anew_is_no_new_task() -> None:
    """As navigation plans on the way, to about the same end; elsewhere, later, or round from there, is new."""
    topics = TaskTopics()
    ways = [
        (0, [(0.0, 0.0), (8.0, 0.0)]), (1, [(1.0, 0.0), (4.0, 2.0), (8.0, 0.1)]), (50, [(7.0, 0.0), (8.0, 0.0)]),
        (51, [(7.0, 0.0), (7.0, 5.0)]), (52, [(7.0, 0.0), (8.0, 0.0)]), (113, [(0.0, 0.0), (8.0, 0.0)]),
        (140, [(8.0, 0.1), (8.0, 4.0), (8.0, 0.0)]),
    ]  # fmt: skip
    found = [topics.texts.hear_path(T0 + second * SECOND, "/plan", way) for second, way in ways]
    assert [one.legs[0].distance if one else None for one in found] == pytest.approx(
        [8.0, None, None, 5.0, 1.0, 8.0, 7.9]
    )
    assert topics.texts.hear_path(T0 + 114 * SECOND, "/other", [(5.0, 0.0), (8.0, 0.0)])


def test_a_broken_path_is_no_half_of_a_task() -> None:
    texts = [("/task_time", "[5]"), ("/plan", None), ("/task_position", "[[0, 0], [1, 0]]")]

    class Text:
        __msgtype__ = TEXT

        def __init__(self, data: str) -> None:
            self.data = data

    class Other:
        __msgtype__ = "std_msgs/msg/Empty"

    listener = TaskTopics()
    messages: list[tuple[int, str, Any]] = [(T0, topic, text and Text(text)) for topic, text in texts]
    assert len(list(tasks_in(messages, listener))) == 1
    assert not listener.notes
    messages[1] = (T0, "/task_position", Other())  # a second publisher, of another type
    assert list(tasks_in(messages, listener)) == []
    assert listener.notes == {
        "/task_time without its other half": 1,
        "message of type std_msgs/msg/Empty on /task_position": 1,
        "/task_position without its other half": 1,
    }


def test_topics_that_tell_of_no_tasks(new: Path) -> None:
    path = record(new, [*DAY, ("/odd/task_time", 40, (1.0, 2.0))])
    tasks, notes = read(path)
    assert tasks == EXPECTED
    assert notes == {f"/odd/task_time is left out: {ODOMETRY}; expected {TEXT}": 1}
    with Recording(path) as recording:
        for topic, message in (
            (
                "/odd/task_time",
                r"topic '/odd/task_time' \(nav_msgs/msg/Odometry\) tells of no tasks; expected nav_msgs",
            ),
            ("/chatter", r"topic '/chatter' \(std_msgs/msg/String\) tells of no tasks; expected nav_msgs"),
            ("/task_times", r"no topic '/task_times'; did you mean '/task_time'"),
        ):
            with pytest.raises(SourceError, match=message):
                tasks_of(recording, [topic])


def test_the_guide_prints_what_it_says(tmp_path: Path) -> None:
    guide = Path(__file__).parents[3] / "docs" / "guides" / "tasks-from-recordings.md"
    code, printed = (block[1] for block in re.finditer(r"```(?:python|text)\n(.*?)```", guide.read_text("utf-8"), re.S))
    command = [sys.executable, "-W", "error", "-c", code]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert run.stdout == printed


def test_all_that_a_recording_tells_by_the_time_of_it(tmp_path: Path) -> None:
    """What was driven stands where it ended, between a plan that came before and one that came after."""
    messages: list[Message] = [("/odom", second, (float(second), 0.0)) for second in range(3)]
    for second in (1, 5):
        messages.append(("/robot_task_list", second, f"[[0, 0, 1], [{second}, 0, 1]]"))
    messages.append(("/robot_task_list", 6, "nonsense"))
    with Recording(record(tmp_path / "drive.mcap", sorted(messages, key=lambda one: one[1]))) as recording:
        told, unread = told_by(recording, ["/odom", "/robot_task_list"])
        assert [type(one) for one in told] == [PlannedTask, DoneTask, PlannedTask]
        assert isinstance(told[1], DoneTask)
        assert told[1].legs == (DoneLeg(2.0, 2 / 3600),)
        assert sum(unread.values()) == 1
        assert told_by(recording)[0] == [one for one in told if isinstance(one, PlannedTask)]
        assert told_by(recording, ["/odom"])[0] == [told[1]]


def test_a_recording_that_tells_nothing_is_refused(tmp_path: Path) -> None:
    path = record(tmp_path / "drive.mcap", [("/odom", second, (float(second), 0.0)) for second in range(3)])
    with Recording(path) as recording, pytest.raises(SourceError, match="tells of no task; expected topics named"):
        told_by(recording)
    path = record(tmp_path / "bad.mcap", [("/robot_task_list", 1, "nonsense")])
    with (
        Recording(path) as recording,
        pytest.raises(SourceError, match="tells of no task that can be read: no task in"),
    ):
        told_by(recording)


@pytest.mark.parametrize(
    ("named", "namespace", "some", "count"),
    [
        ((), "", "/robot_task_list", 4 + 4 * 7),
        ((), "/", "/robot_task_list", 4 + 4 * 7),
        ((), "/r1/", "/r1/robot_task_list", 2 * (4 + 4 * 7)),
        (["/my_list"], "/r1", "/my_list/goal", 7),
    ],
)
def test_topics_to_hear_are_the_named_or_the_known_ones(
    named: Collection[str], namespace: str, some: str, count: int
) -> None:
    """Four topics of the 2020 tool, four actions, each under its own name or as one of its six topics."""
    found = topics_to_hear(named, namespace)
    assert some in found
    assert len(found) == len(set(found)) == count
