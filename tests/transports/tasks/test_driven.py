"""All that was driven, as one task."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import HOUR, SECOND
from robophm.transports import open_source
from robophm.transports.recordings.recording import Recording
from robophm.transports.synthetic import SyntheticOta
from robophm.transports.tasks import (
    DoneLeg,
    DoneTask,
    driven_task,
    tasks_of,
)

from .told import ODOMETRY, POSE, T0, Message, record


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
