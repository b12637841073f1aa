"""Recordings as recorders write them: each ends at its last message of any topic whose time is believed."""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterable
from pathlib import Path

import pytest
from rosbags.rosbag1 import Writer as Bag
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Folder
from rosbags.typesys import Stores, get_typestore

import robophm
from robophm.core.signal import HOUR, SECOND
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.measured.profile import stress_profiles
from robophm.measured.recordings import recordings
from robophm.monitoring.replay import kept_ledger, replay
from robophm.monitoring.task_history import judge_tasks
from robophm.monitoring.wear_from_recordings import wear_history, worn_modes
from robophm.stores.memory import MemoryStore

START = 1_709_553_600 * SECOND
IN_2038 = 2_147_483_000 * SECOND
DAY = 24 * HOUR
KINDS = ("bag", "db3", "mcap")
DESIGN = """
schema_version: 1
name: R
max_gap: 60 s
signals: {temperature: {topic: /battery, field: data, unit: degC, max_age: 10 s, range: [-40, 125]}}
components:
  motor: {rate: 0.01 /h, acceleration: {model: q10, reference_temperature: 25 degC}}
  shelf: {rate: 0.001 /h, clock: calendar}
  hinge: {rate: 0.001 /h, wear: {topic: /battery, field: data, unit: degC, every: 30 s, threshold: 60 degC}}
"""
Message = tuple[int, str]
"""When it is received [ns], and on which topic."""


@pytest.fixture(scope="module")
def design() -> Robot:
    return parse(DESIGN)


def run(begin: float, seconds: int, topic: str = "/battery", of: int = START) -> list[Message]:
    """One message a second, the first at ``begin`` [s]; they span a second less."""
    return [(of + round((begin + second) * SECOND), topic) for second in range(seconds)]


def write(path: Path, messages: Iterable[Message], kind: str = "", **options: object) -> Path:
    """Float64 messages of 30 in the order in which they came; a rosbag2 folder unless the path is of a bag."""
    ros1 = path.suffix == ".bag"
    types = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
    plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
    writer = Bag(path) if ros1 else Folder(path, version=8, storage_plugin=plugin)
    name, serialize = "std_msgs/msg/Float64", types.serialize_ros1 if ros1 else types.serialize_cdr
    raw = serialize(types.types[name](data=30.0), name)
    messages = list(messages)
    with writer:
        known = {
            topic: writer.add_connection(topic, name, typestore=types) for topic in {topic for _, topic in messages}
        }
        for at, topic in messages:
            writer.write(known[topic], at, raw)
    return path


def named(folder: Path, name: str, kind: str) -> Path:
    return folder / (f"{name}.bag" if kind == "bag" else name)


def seconds(robot: Robot, *paths: Path) -> float:
    return replay(robot, paths).clocks["operating"] * 3600


def jumped(ahead: int) -> list[Message]:
    """Ten minutes, of which 20 s say another time: as they come, in the middle."""
    whole = run(0, 600)
    return [(at + ahead if 300 <= i < 320 else at, topic) for i, (at, topic) in enumerate(whole)]


@pytest.mark.parametrize("kind", KINDS)
def test_a_jump_inside_does_not_let_a_recording_run_on(design: Robot, tmp_path: Path, kind: str) -> None:
    """599 s, and 299 s an hour later: together, one after the other into a store, and as one source."""
    first = write(named(tmp_path, "jump", kind), jumped(IN_2038 - START), kind)
    second = write(named(tmp_path, "after", kind), run(3600, 300), kind)
    assert seconds(design, first) == pytest.approx(599, rel=1e-12)
    assert seconds(design, first, second) == pytest.approx(599 + 299, rel=1e-12)
    assert seconds(design, second, first) == pytest.approx(599 + 299, rel=1e-12)
    store = MemoryStore()
    replay(design, first, store=store)
    report = replay(design, second, store=store)
    assert report.clocks["operating"] * 3600 == pytest.approx(599 + 299, rel=1e-12)
    assert report.clocks["calendar"] * 3600 == pytest.approx(3600 + 299, rel=1e-12)
    with robophm.open_source(first, second) as source:
        assert replay(design, source).clocks["operating"] * 3600 == pytest.approx(599 + 299, rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_what_goes_on_behind_a_jump_has_no_seam(design: Robot, tmp_path: Path, kind: str) -> None:
    """The next file begins 31 s after the true end, within max_gap: on throughout, 0 to 929 s."""
    first = write(named(tmp_path, "jump", kind), jumped(IN_2038 - START), kind)
    second = write(named(tmp_path, "next", kind), run(630, 300), kind)
    third = write(named(tmp_path, "later", kind), run(3600, 100), kind)
    assert seconds(design, first, second) == pytest.approx(929, rel=1e-12)
    store = MemoryStore()
    for path in (first, second):
        replay(design, path, store=store)
    assert replay(design, third, store=store).clocks["operating"] * 3600 == pytest.approx(929 + 99, rel=1e-12)


def test_a_file_that_is_all_of_another_time_ends_nothing(design: Robot, tmp_path: Path) -> None:
    """A recorder that begins a new file when the clock jumps: 0 to 599 s and 630 to 929 s have no seam."""
    store = MemoryStore()
    for i, messages in enumerate((run(0, 600), run(0, 20, of=IN_2038), run(630, 300), run(3600, 100))):
        report = replay(design, write(tmp_path / f"{i}.bag", messages), store=store)
    assert report.clocks["operating"] * 3600 == pytest.approx(929 + 99, rel=1e-12)


def test_what_another_recording_confirms_has_ended_too(design: Robot, tmp_path: Path) -> None:
    """Shelved for 500 days, five minutes that are set aside, an hour later ten more that confirm them."""
    later = 500 * 24 * 3600
    store = MemoryStore()
    for i, begin in enumerate((0, later, later + 3600)):
        report = replay(design, write(tmp_path / f"{i}.bag", run(begin, 300)), store=store)
    assert report.clocks["operating"] * 3600 == pytest.approx(3 * 299, rel=1e-12)


def test_stamps_that_jump_do_not_end_it(design: Robot, tmp_path: Path, write_messages: Callable[..., Path]) -> None:
    """By a day, and to 2038: the time of receipt counts then."""
    for i, ahead in enumerate((DAY, IN_2038 - START)):

        def temperature(at: int) -> Callable[[dict[str, type]], object]:
            def make(types: dict[str, type]) -> object:
                stamp = types["builtin_interfaces/msg/Time"](sec=at // SECOND, nanosec=at % SECOND)
                header = types["std_msgs/msg/Header"](stamp=stamp, frame_id="")
                return types["sensor_msgs/msg/Temperature"](header=header, temperature=30.0, variance=0.0)

            return make

        robot = parse(DESIGN.replace("field: data", "field: temperature"))
        stamps = [at for at, _ in jumped(ahead)]
        rows = [
            ("/battery", "sensor_msgs/msg/Temperature", receipt, temperature(stamp))
            for (receipt, _), stamp in zip(run(0, 600), stamps, strict=True)
        ]
        first = write_messages(tmp_path / f"{i}.mcap", rows)
        assert seconds(robot, first) == pytest.approx(599, rel=1e-12)


@pytest.mark.full
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("lasts", "on"), [(630, 629), (660, 659), (3600, 599 + 60)])
def test_a_sensor_dies_and_the_recording_goes_on(design: Robot, tmp_path: Path, kind: str, lasts: int, on: int) -> None:
    """On until the last sample + max_gap while the recording goes on; the calendar until its end."""
    both = sorted([*run(0, 600), *run(0, lasts, "/other")])
    first = write(named(tmp_path, "dies", kind), both, kind)
    second = write(named(tmp_path, "after", kind), run(7200, 300), kind)
    store = MemoryStore()
    clocks = replay(design, first, store=store).clocks
    assert clocks["operating"] * 3600 == pytest.approx(on, rel=1e-12)
    assert clocks["calendar"] * 3600 == pytest.approx(lasts - 1, rel=1e-12)
    kept = kept_ledger(design, store)
    assert kept is not None
    assert robophm.Monitor(design, kept).report().clocks == clocks  # as whoever asks the store is told
    clocks = replay(design, second, store=store).clocks
    assert clocks["operating"] * 3600 == pytest.approx(on + 299, rel=1e-12)
    assert seconds(design, first, second) == pytest.approx(on + 299, rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_a_sensor_dies_and_the_clock_jumps(design: Robot, tmp_path: Path, kind: str) -> None:
    """The jump is of all topics, the end is of the topic that goes on."""
    both = sorted([*jumped(IN_2038 - START), *run(0, 640, "/other"), *run(0, 20, "/other", of=IN_2038)])
    first = write(named(tmp_path, "dies", kind), both, kind)
    assert seconds(design, first) == pytest.approx(639, rel=1e-12)
    assert seconds(design, first, write(named(tmp_path, "after", kind), run(3600, 300), kind)) == pytest.approx(
        639 + 299, rel=1e-12
    )


@pytest.mark.parametrize("kind", KINDS)
def test_what_a_recording_goes_on_with_may_be_another_topic(design: Robot, tmp_path: Path, kind: str) -> None:
    """Split while the sensor is dead, from 100 s to 400 s: on until 159 s, and from 400 s to 499 s."""
    one = write(named(tmp_path, "one", kind), sorted([*run(0, 100), *run(0, 200, "/other")]), kind)
    two = write(named(tmp_path, "two", kind), sorted([*run(200, 300, "/other"), *run(400, 100)]), kind)
    assert seconds(design, one, two) == pytest.approx(99 + 60 + 99, rel=1e-12)
    store = MemoryStore()
    replay(design, one, store=store)
    assert replay(design, two, store=store).clocks["operating"] * 3600 == pytest.approx(99 + 60 + 99, rel=1e-12)


def test_what_metadata_says_of_the_end_is_not_believed(design: Robot, tmp_path: Path) -> None:
    """A folder says that it lasts for a day; its messages, 60 s."""
    path = write(tmp_path / "says", run(0, 61), "db3")
    metadata = path / "metadata.yaml"
    says = f"nanoseconds: {60 * SECOND}\n"
    assert metadata.read_text().count(says) == 2
    metadata.write_text(metadata.read_text().replace(says, f"nanoseconds: {DAY}\n"))
    assert seconds(design, path) == pytest.approx(60, rel=1e-12)
    assert seconds(design, path, write(tmp_path / "b.bag", run(3600, 61))) == pytest.approx(120, rel=1e-12)


def test_a_database_of_which_a_row_lies_by_decades(design: Robot, tmp_path: Path) -> None:
    """One row on an unbound topic says 2255: the recording ends with the last row before it."""
    path = write(tmp_path / "lies", sorted([*run(0, 600), *run(0, 640, "/other")]), "db3")
    with sqlite3.connect(next(path.glob("*.db3"))) as base:
        base.execute("UPDATE messages SET timestamp = ? WHERE id = 7", (9 * 10**18,))
        assert base.execute("SELECT max(timestamp) FROM messages").fetchone() == (9 * 10**18,)
    base.close()
    assert seconds(design, path) == pytest.approx(639, rel=1e-12)
    assert seconds(design, path, write(tmp_path / "b.bag", run(3600, 61))) == pytest.approx(639 + 60, rel=1e-12)


def test_a_bag_that_was_cut_ends_with_its_last_whole_message(design: Robot, tmp_path: Path) -> None:
    """Of a bag whose index and half of whose messages are gone, what is left says when it ends."""
    whole = write(tmp_path / "whole.bag", sorted([*run(0, 60), *run(0, 120, "/other")]))
    cut = tmp_path / "cut.bag"
    content = whole.read_bytes()
    counts = []
    for size in (len(content) // 2, 4 * len(content) // 5):
        cut.write_bytes(content[:size])
        with robophm.open_source(cut) as source:
            counts.append(max(info.messages for info in source.topics()))
        assert seconds(design, cut) == pytest.approx(counts[-1] - 1, rel=1e-12)
    assert counts[0] < 60 < counts[1] < 120


def test_columns_of_a_table_that_nobody_listens_to(design: Robot, tmp_path: Path) -> None:
    """A table ends with its last value of any column, but for one of another time."""

    def table(name: str, begin: int, *more: str) -> Path:
        rows = [f"{begin + second},{30 if second < 60 else ''},7" for second in range(90)]
        path = tmp_path / name
        path.write_text("\n".join(("time,/battery.data,/other.data", *rows, *more)) + "\n")
        return path

    at = START // SECOND
    first = table("first.csv", at, f"{IN_2038 // SECOND},,7", f"{IN_2038 // SECOND + 1},30,7")
    assert seconds(design, first) == pytest.approx(89, rel=1e-12)
    store = MemoryStore()
    replay(design, first, store=store)
    report = replay(design, table("second.csv", at + 3600), store=store)
    assert report.clocks["operating"] * 3600 == pytest.approx(2 * 89, rel=1e-12)


def test_six_bags_count_as_much_wherever_a_robot_lives_through_them(design: Robot, tmp_path: Path) -> None:
    """Six of 60 s, at intervals of an hour: 0.1 h, of a replay, of tasks, of wear and of the load that is measured."""
    paths = [write(tmp_path / f"{i}.bag", run(3600 * i, 61)) for i in range(6)]
    assert replay(design, paths).clocks["operating"] == pytest.approx(0.1, rel=1e-12)
    with robophm.open_source(*paths) as source:
        _, monitor = judge_tasks(design, source, [])
    assert monitor.report().clocks["operating"] == pytest.approx(0.1, rel=1e-12)
    worn = wear_history(design, paths, worn_modes(design))
    assert worn.monitor.report().clocks["operating"] == pytest.approx(0.1, rel=1e-12)
    (together,) = recordings(paths, together=True)
    assert stress_profiles(design, together, 20).ledger.clocks.value[0] == pytest.approx(0.1, rel=1e-12)
