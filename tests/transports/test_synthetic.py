from __future__ import annotations

import ast
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robophm.core.errors import SourceError
from robophm.core.signal import HOUR, SECOND
from robophm.transports.recordings.recording import Recording
from robophm.transports.synthetic import SyntheticOta
from robophm.transports.synthetic.drive import STATIONS
from robophm.transports.synthetic.messages import MODULES
from robophm.transports.synthetic.ota import _first_order
from robophm.transports.tasks import DoneTask, PlannedTask, tasks_of

NOON = 1_709_553_600 * SECOND
DAY = 24 * HOUR


@pytest.fixture(scope="module")
def day() -> SyntheticOta:
    return SyntheticOta(seed=1)


def test_same_seed_same_values(day: SyntheticOta) -> None:
    again, other = SyntheticOta(seed=1), SyntheticOta(seed=2)
    assert again.fingerprint == day.fingerprint != other.fingerprint
    np.testing.assert_array_equal(again.temperature["mobility"], day.temperature["mobility"])


def test_the_day_has_its_night(day: SyntheticOta) -> None:
    hours = (day.times % DAY) / HOUR
    assert len(day.times) == 16 * 3600
    assert ((hours >= 6) & (hours < 22)).all()
    gaps = np.diff(day.times)
    assert sorted(gaps)[-2:] == [SECOND, 8 * HOUR + SECOND]
    at = int(gaps.argmax())
    for module in MODULES:  # it cools to the hall, and the sensors are not there to see it
        assert abs(day.temperature[module][at + 1] - day.ambient[at + 1]) < 0.5


def test_kinematics(day: SyntheticOta) -> None:
    steps = np.diff(day.times) == SECOND
    moved = np.hypot(np.diff(day.x), np.diff(day.y))[steps]
    between = (day.speed[1:] + day.speed[:-1])[steps] / 2
    # the trapezoid rule is exact but for the seconds in which the acceleration changes, 0.2 m/s² · (1 s)² / 4
    assert abs(moved - between).max() < 0.05 + 1e-9
    assert moved.sum() == pytest.approx(between.sum(), rel=1e-3)
    driving = day.speed > 0.249
    assert 0.25 <= np.median(day.speed[driving]) <= 0.35
    assert day.speed.max() <= 0.35
    turned = np.diff(day.heading)[steps]
    assert abs(turned).max() <= 0.6 + 1e-9
    standing = (day.speed == 0) & (day.turn_rate == 0)
    places = np.column_stack([day.x, day.y])[standing]
    distances = np.hypot(*(places[:, None, :] - np.array(STATIONS)).transpose(2, 0, 1)).min(axis=1)
    assert distances.max() < 1e-9
    assert set(np.unique(day.payload[driving] > 0)) == {False, True}


def test_it_drives_the_way_it_looks(day: SyntheticOta) -> None:
    moving = (day.speed[1:] > 0.1) & (day.speed[:-1] > 0.1)
    course = np.arctan2(np.diff(day.y), np.diff(day.x))[moving]
    assert np.cos(course - day.heading[1:][moving]).min() > 1 - 1e-9


def test_battery(day: SyntheticOta) -> None:
    charging = day.current > 0
    assert charging.any()
    assert (day.speed[charging] == 0).all()
    assert day.current[~charging].max() < 0
    assert 0.2 < day.state_of_charge.min() < 0.4 < 0.9 < day.state_of_charge.max() <= 1
    drawn = -day.current[1:] / 3600 / 40.0
    assert np.diff(day.state_of_charge) == pytest.approx(-drawn, abs=1e-12)


def test_modules_heat_up_with_their_load(day: SyntheticOta) -> None:
    for module in MODULES:
        rise = (day.temperature[module] - day.ambient)[3600:30000]
        assert 0 < rise.mean() < 30
    work = np.convolve(day.speed * (1 + 0.1 * day.payload), np.exp(-np.arange(6000) / 1200))[:30000]
    rise = (day.temperature["mobility"] - day.ambient)[:30000]
    assert np.corrcoef(work, rise)[0, 1] > 0.9


@settings(deadline=None, max_examples=30)
@given(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=300), st.floats(0.0, 1.0))
def test_first_order_is_its_recursion(driven: list[float], keep: float) -> None:
    expected, y = [], 0.0
    for value in driven:
        y = keep * y + value
        expected.append(y)
    np.testing.assert_allclose(_first_order(np.array(driven), keep), expected, rtol=1e-9, atol=1e-8)


def test_first_order_steps_as_the_closed_form() -> None:
    keep = math.exp(-1 / 600)
    y = _first_order(np.full(86_400, 1 - keep), keep)
    np.testing.assert_allclose(y, 1 - keep ** np.arange(1, 86_401), rtol=1e-10)


def test_sensors_are_near_the_truth(drive: SyntheticOta) -> None:
    measured = [s.value for s in drive.samples(["/ota/mobility/temperature.temperature"])]
    assert 0 < np.abs(measured - drive.temperature["mobility"]).max() < 0.6
    x = [s.value for s in drive.samples(["/ota/odom.pose.pose.position.x"])]
    assert x == drive.x.tolist()


# What it says of its tasks


def told(path: Path, topic: str) -> list[tuple[int, str]]:
    """Receipt and text of each message, by rosbags alone."""
    from rosbags.highlevel import AnyReader

    with AnyReader([path]) as reader:
        wanted = [connection for connection in reader.connections if connection.topic == topic]
        return [
            (time, reader.deserialize(raw, connection.msgtype).data)
            for connection, time, raw in reader.messages(wanted)
        ]


@pytest.fixture(scope="module")
def recorded_day(day: SyntheticOta, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return day.record(tmp_path_factory.mktemp("day") / "day.mcap")


@pytest.mark.full
def test_tasks_are_true_to_the_drive(day: SyntheticOta, recorded_day: Path) -> None:
    """Times are those between looks, places those of the robot then, and the way between them was straight."""
    times, places = told(recorded_day, "/ota/task_time"), told(recorded_day, "/ota/task_position")
    assert len(times) == len(places) > 500
    path = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(day.x), np.diff(day.y)))])
    latest = 0
    for (receipt, text), (other, positions) in zip(times, places, strict=True):
        took, where = ast.literal_eval(text), ast.literal_eval(positions)
        end = int(np.searchsorted(day.times, receipt)) - 1
        assert 0 < receipt - day.times[end] < 10**6
        assert 0 < other - receipt < 10**6
        looks = [end - round(sum(took[number:])) for number in range(len(took) + 1)]  # a look a second
        assert latest <= day.times[looks[0]]
        assert day.times[end] - day.times[looks[0]] == round(sum(took)) * SECOND  # not across the night
        assert where == [[day.x[look], day.y[look]] for look in looks]
        driven = [math.dist(one, other) for one, other in pairwise(where)]
        np.testing.assert_allclose(np.diff(path[looks]), driven, rtol=1e-9)
        latest = day.times[end]
    assert {len(ast.literal_eval(text)) for _, text in times} == {1, 2}


def test_plans_are_followed(day: SyntheticOta, recorded_day: Path) -> None:
    with Recording(recorded_day) as recording:
        tasks = list(tasks_of(recording))
        paths = [task for task in tasks_of(recording, ["/ota/plan"]) if isinstance(task, PlannedTask)]
        assert not recording.notes
    assert [type(task) for task in tasks[:4]] == [PlannedTask, DoneTask] * 2
    plans = [task for task in tasks if isinstance(task, PlannedTask)]
    done = [task for task in tasks if isinstance(task, DoneTask)]
    assert len(plans) == len(done) == len(paths)
    assert 0 < plans[0].time - day.times[0] < 10**6
    for plan, task, whole in zip(plans, done, paths, strict=True):
        assert abs(plan.time - task.start) < 10**6
        assert [leg.distance for leg in plan.legs] == pytest.approx([leg.distance for leg in task.legs], abs=0.2)
        assert whole.legs[0].distance == pytest.approx(sum(leg.distance for leg in plan.legs), rel=1e-12)
        assert whole.legs[0].speed is None
        looks = slice(*np.searchsorted(day.times, [task.start, task.end]))
        fastest = max(leg.speed or 0.0 for leg in plan.legs)
        assert day.speed[looks].max() == pytest.approx(fastest, abs=1e-9)
        for leg, ahead in zip(task.legs, plan.legs, strict=True):  # it also turns, speeds up and waits
            assert leg.duration * 3600 > ahead.distance / (ahead.speed or 0.0) - 1


def test_tasks_read_alike_in_three_formats(tmp_path: Path) -> None:
    drive = SyntheticOta(seed=4, duration=600 * SECOND)
    found = []
    for suffix in (".bag", ".mcap", ".db3"):
        with Recording(drive.record(tmp_path / f"drive{suffix}")) as recording:
            found.append((list(tasks_of(recording)), list(tasks_of(recording, ["/ota/plan"]))))
    assert found[0] == found[1] == found[2]
    assert len(found[0][0]) > 5


def test_tasks_between_two_looks_are_not_told() -> None:
    slow = SyntheticOta(duration=2 * DAY, period=60 * SECOND)
    counts = {info.topic: info.messages for info in slow.topics()}
    assert 0 < counts["/ota/task_time"] == counts["/ota/task_position"] < counts["/ota/robot_task_list"]


def test_period_and_hours() -> None:
    slow = SyntheticOta(duration=60 * SECOND, period=10 * SECOND)
    assert slow.times.tolist() == [NOON + n * 10 * SECOND for n in range(6)]
    always = SyntheticOta(duration=2 * DAY, period=60 * SECOND, working_hours=(0, 24))
    assert len(always.times) == 2 * 24 * 60


def test_errors(tmp_path: Path, drive: SyntheticOta) -> None:
    for bad in ({"duration": 0}, {"start": NOON + 11 * HOUR, "duration": HOUR}, {"period": 0}):
        with pytest.raises(SourceError):
            SyntheticOta(**bad)
    with pytest.raises(SourceError, match=r"expected a name that ends in \.mcap"):
        drive.record(tmp_path / "drive.txt")
    for suffix in (".mcap", ".bag", ".db3"):
        drive.record(tmp_path / f"drive{suffix}")
        with pytest.raises(SourceError, match="is there already"):
            drive.record(tmp_path / f"drive{suffix}")


def test_missing_elements_are_noted_as_in_a_recording(drive: SyntheticOta, recorded: dict[str, Path]) -> None:
    wanted = ["/ota/battery.cell_voltage[0]", "/ota/battery.charge", "/ota/odom.twist.covariance[3]"]
    found = list(drive.samples(wanted))
    with Recording(recorded[".mcap"]) as recording:
        assert repr(list(recording.samples(wanted))) == repr(found)
        assert recording.notes == drive.notes == {"no element for /ota/battery.cell_voltage[0]": 30}


def test_other_readers_agree(recorded: dict[str, Path], drive: SyntheticOta) -> None:
    """Every numeric field, as rosbags and mcap-ros2-support decode it."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory
    from rosbags.highlevel import AnyReader

    def numbers(message: Any, path: str) -> float:
        for step in path.split("."):
            name, _, index = step.partition("[")
            message = getattr(message, name)
            message = message[int(index[:-1])] if index else message
        return float(message)

    fields = {
        info.topic: [
            field.replace("[]", "[1]" if "poses" in field else "[7]") for field in info.fields if "cell" not in field
        ]
        for info in drive.topics()
    }
    ours: dict[tuple[str, str], list[float]] = {}
    for sample in drive.samples([f"{topic}.{field}" for topic in fields for field in fields[topic]]):
        topic, _, field = sample.signal.partition(".")
        ours.setdefault((topic, field), []).append(sample.value)
    with recorded[".mcap"].open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        theirs: dict[tuple[str, str], list[float]] = {}
        for _, channel, _, message in reader.iter_decoded_messages():
            for field in fields[channel.topic]:
                theirs.setdefault((channel.topic, field), []).append(numbers(message, field))
    assert repr(sorted(theirs.items())) == repr(sorted(ours.items()))
    for path in recorded.values():
        theirs = {}
        with AnyReader([path]) as any_reader:
            for connection, _, raw in any_reader.messages():
                message = any_reader.deserialize(raw, connection.msgtype)
                for field in fields[connection.topic]:
                    theirs.setdefault((connection.topic, field), []).append(numbers(message, field))
        assert repr(sorted(theirs.items())) == repr(sorted(ours.items()))
