"""Tasks in recordings of both generations of ROS, and what is said of messages that tell of none."""

from __future__ import annotations

import math
import random
import re
import subprocess
import sys
import time as clock
from collections import Counter
from collections.abc import Callable, Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import HOUR, SECOND
from robophm.transports import open_source
from robophm.transports.recordings.recording import Recording
from robophm.transports.synthetic import SyntheticOta
from robophm.transports.tasks import (
    LONGEST_MESSAGE,
    DoneLeg,
    DoneTask,
    PlannedLeg,
    PlannedTask,
    TaskListener,
    TaskTopics,
    driven_task,
    tasks_of,
)
from robophm.transports.tasks.recorded import told_in

T0 = 1_700_000_000 * SECOND
TEXT, PATH, ODOMETRY, POSE = (
    "std_msgs/msg/String",
    "nav_msgs/msg/Path",
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseStamped",
)
Content = str | list[tuple[float, float]] | tuple[float, float]
Message = tuple[str, float, Content]


def record(path: Path, messages: Iterable[Message], odometry: str = ODOMETRY) -> Path:
    """Topic, receipt [s after T0] and text, places of a path or place of a pose, with rosbags' writers."""
    from rosbags.rosbag1 import Writer as Writer1
    from rosbags.rosbag2 import StoragePlugin
    from rosbags.rosbag2 import Writer as Writer2
    from rosbags.typesys import Stores, get_typestore

    ros1 = path.suffix == ".bag"
    store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_JAZZY)
    types = store.types

    def header(at: int) -> Any:
        stamp = types["builtin_interfaces/msg/Time"](at // SECOND, at % SECOND)
        return types["std_msgs/msg/Header"](stamp=stamp, frame_id="map", **({"seq": 0} if ros1 else {}))

    def pose(x: float, y: float) -> Any:
        quaternion = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
        return types["geometry_msgs/msg/Pose"](types["geometry_msgs/msg/Point"](x, y, 5.0), quaternion)

    def made(at: int, content: Content) -> Any:
        if isinstance(content, str):
            return types[TEXT](content)
        if isinstance(content, list):
            return types[PATH](header(at), [types[POSE](header(at), pose(x, y)) for x, y in content])
        if odometry == POSE:
            return types[POSE](header(at), pose(*content))
        zero = types["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
        twist = types["geometry_msgs/msg/TwistWithCovariance"](
            types["geometry_msgs/msg/Twist"](zero, zero), np.zeros(36)
        )
        return types[ODOMETRY](
            header(at), "base", types["geometry_msgs/msg/PoseWithCovariance"](pose(*content), np.zeros(36)), twist
        )

    writer: Any
    if ros1:
        writer = Writer1(path)
    else:
        plugin = StoragePlugin.MCAP if path.suffix == ".mcap" else StoragePlugin.SQLITE3
        writer = Writer2(path.with_suffix(""), version=9, storage_plugin=plugin)
    with writer:
        connections: dict[str, Any] = {}
        for topic, after, content in messages:
            message = made(T0 + round(after * SECOND), content)
            type_ = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, type_, typestore=store)
            raw = store.serialize_ros1(message, type_) if ros1 else store.serialize_cdr(message, type_)
            writer.write(connections[topic], T0 + round(after * SECOND), raw)
    return path if ros1 else path.with_suffix("")


def read(path: Path, topics: list[str] | None = None) -> tuple[list[PlannedTask | DoneTask], Counter[str]]:
    with Recording(path) as recording:
        return list(tasks_of(recording, topics)), Counter(recording.notes)


def heard(*messages: Message) -> tuple[list[PlannedTask | DoneTask], Counter[str]]:
    """What a live listener makes of texts."""
    listener = TaskListener()
    found = [listener.hear(T0 + round(after * SECOND), topic, text) for topic, after, text in messages]  # type: ignore[arg-type]
    listener.end()
    return [task for task in found if task], listener.notes


@pytest.fixture(params=[".bag", ".mcap", ".db3"])
def new(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """The name of a recording that is not there yet, in each of the formats."""
    return tmp_path / f"new{request.param}"


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
    assert len(list(told_in(messages, listener))) == 1
    assert not listener.notes
    messages[1] = (T0, "/task_position", Other())  # a second publisher, of another type
    assert list(told_in(messages, listener)) == []
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


# All that was driven, as one task


@pytest.mark.parametrize("turtle", ["/turtle1/pose", "/turtle2/pose"])
def test_what_the_turtles_drove(turtle: str, shared: Path) -> None:
    from rosbags.highlevel import AnyReader

    path = shared / "recordings" / "turtlesim.bag"
    with AnyReader([path]) as reader:
        wanted = [connection for connection in reader.connections if connection.topic == turtle]
        poses = [(time, reader.deserialize(raw, c.msgtype)) for c, time, raw in reader.messages(wanted)]
    times = np.array([time for time, _ in poses])
    places = np.array([(pose.x, pose.y) for _, pose in poses], dtype=float)
    with Recording(path) as recording:
        for start, end in (
            (None, None),
            (int(times[200]), int(times[900])),
            (int(times[200]) - 1, int(times[900]) + 1),
        ):
            used = slice(200, 901) if start else slice(None)
            task = driven_task(recording, turtle, start, end)
            assert (task.start, task.end) == (times[used][0], times[used][-1])
            (leg,) = task.legs
            assert leg.duration == pytest.approx((times[used][-1] - times[used][0]) / HOUR, rel=1e-12)
            length = np.linalg.norm(np.diff(places[used], axis=0), axis=1).sum()
            assert leg.distance == pytest.approx(length, rel=1e-12)
        assert list(tasks_of(recording)) == []
    if turtle == "/turtle1/pose":  # 28.3520 m over 21.489 s: summed pose to pose by an independent reader
        with Recording(path) as recording:
            (leg,) = driven_task(recording, turtle).legs
        assert leg.distance == pytest.approx(28.3520, abs=5e-5)
        assert leg.duration * 3600 == pytest.approx(21.489, abs=5e-4)


@pytest.mark.parametrize("type_", [ODOMETRY, POSE])
def test_poses_of_every_format(type_: str, new: Path) -> None:
    square: list[Message] = [
        ("/where", float(n), place) for n, place in enumerate([(0.0, 0.0), (0.0, 3.0), (4.0, 3.0)])
    ]
    with Recording(record(new, square, type_)) as recording:
        assert driven_task(recording, "/where") == DoneTask(T0, T0 + 2 * SECOND, "/where", (DoneLeg(7.0, 2 / 3600),))
        assert driven_task(recording, "/where", T0 + 1).legs == (DoneLeg(4.0, 1 / 3600),)
        assert driven_task(recording, "/where", end=T0 + SECOND).legs == (DoneLeg(3.0, 1 / 3600),)
        for start, end, poses in ((T0 + 1, T0 + SECOND, 1), (T0 + 9 * SECOND, None, 0), (None, T0 - 1, 0)):
            with pytest.raises(SourceError, match=f"'/where' has {poses} poses in that time; expected at least two"):
                driven_task(recording, "/where", start, end)


def test_poses_that_are_left_out(tmp_path: Path) -> None:
    places = [(0, 0.0), (1, 1.0), (2, math.nan), (3, 2.0), (100, 50.0), (101, 51.0)]
    path = record(tmp_path / "new.bag", [("/odom", at, (x, 0.0)) for at, x in places])
    with Recording(path) as recording:
        task = driven_task(recording, "/odom")
        assert task.legs == (DoneLeg(3.0, 101 / 3600),)  # 0 → 1 → 2, and 50 → 51
        assert recording.notes == {"position on /odom is not finite": 1, "no pose for more than 60 s on /odom": 1}


def test_poses_of_a_table(tmp_path: Path) -> None:
    (tmp_path / "drive.csv").write_text("time,/r/pose.x,/r/pose.y\n0,0,0\n1,3,4\n2,5,\n3,,6\n4,3,5\n")
    with open_source(tmp_path / "drive.csv") as source:  # a row without both says not where the robot is
        assert driven_task(source, "/r/pose").legs == (DoneLeg(6.0, 4 / 3600),)


def test_the_synthetic_drive(drive: SyntheticOta) -> None:
    task = driven_task(drive, "/ota/odom")
    assert (task.start, task.end) == (drive.times[0], drive.times[-1])
    length = sum(math.dist(one, other) for one, other in pairwise(zip(drive.x, drive.y, strict=True)))
    assert task.legs[0].distance == pytest.approx(length, rel=1e-12)


def test_topics_that_do_not_say_where_the_robot_is(drive: SyntheticOta) -> None:
    with pytest.raises(
        SourceError, match=r"'/ota/battery' \(sensor_msgs/msg/BatteryState\) does not say where the robot"
    ):
        driven_task(drive, "/ota/battery")
    with pytest.raises(SourceError, match=r"no topic '/ota/odm'; did you mean '/ota/odom'"):
        driven_task(drive, "/ota/odm")


def test_the_guide_prints_what_it_says(tmp_path: Path) -> None:
    guide = Path(__file__).parents[3] / "docs" / "guides" / "tasks-from-recordings.md"
    code, printed = (block[1] for block in re.finditer(r"```(?:python|text)\n(.*?)```", guide.read_text("utf-8"), re.S))
    command = [sys.executable, "-W", "error", "-c", code]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert run.stdout == printed
