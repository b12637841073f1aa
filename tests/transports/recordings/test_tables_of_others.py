"""Tables that other programs write: what they hold is what the recording held from which they were made."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from pyulog.core import ULog
from pyulog.ulog2csv import convert_ulog2csv

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.table_heading import SINCE_START
from robophm.transports.synthetic import SyntheticOta

from .test_ulog import flight

SINGLE = ["voltage_v", "warning", "connected", "worst.number", "worst.left"]


def test_what_ulog2csv_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = tmp_path / "12_34_56.ulg"
    log.write_bytes(flight())
    convert_ulog2csv(str(log), "battery_status", "", ",", None, None)
    capsys.readouterr()
    for instance, topic in enumerate(("/battery_status", "/battery_status_1")):
        expected = ULog(str(log)).get_dataset("battery_status", instance).data
        with open_source(tmp_path / f"12_34_56_battery_status_{instance}.csv") as source:
            assert [info.topic for info in source.topics()] == [topic]
            for field in [*SINGLE, *(f"cell_v[{index}]" for index in range(3))]:
                found = list(source.samples([f"{topic}.{field}"]))
                assert [one.time for one in found] == [int(stamp) * 1000 for stamp in expected["timestamp"]]
                assert [str(one.value) for one in found] == [str(float(str(value))) for value in expected[field]]
            assert source.notes[SINCE_START] == 1


@pytest.mark.skipif(not Path("/usr/bin/rostopic").exists(), reason="needs ROS 1")
def test_what_rostopic_writes(tmp_path: Path, drive: SyntheticOta) -> None:
    bag = drive.record(tmp_path / "drive.bag")
    told = subprocess.run(
        ["/usr/bin/rostopic", "echo", "-b", str(bag), "-p", "/ota/battery"],
        env={**os.environ, "PYTHONPATH": "", "ROS_HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    (tmp_path / "battery.csv").write_text(told.stdout)
    with open_source(tmp_path / "battery.csv") as source, open_source(bag) as recorded:
        for field in ("voltage", "current"):
            found = [one.value for one in source.samples([f"/battery.{field}"])]
            assert found == [one.value for one in recorded.samples([f"/ota/battery.{field}"])]
        (info,) = source.topics()
        (whole,) = [one for one in recorded.topics() if one.topic == "/ota/battery"]
        assert (info.first, info.last, info.messages) == (whole.first, whole.last, whole.messages)


def test_what_plotjuggler_writes(tmp_path: Path) -> None:
    path = tmp_path / "plot"
    path.write_text(
        "__time,/joints/pan/effort,battery_status.01/voltage_v,/odom/pose/position/x,current,/text/data,/odd/a b\n"
        "1700000000.250000,1.5,,3,9,hello,1\n"
        "1700000000.500000,,2.5,,9,hello,1\n"
    )
    with open_source(path) as source:
        signals = [f"{info.topic}.{field}" for info in source.topics() for field in info.fields]
        assert signals == [
            "/battery_status_01.voltage_v", "/joints/pan.effort", "/odom/pose/position.x", "/plot.current",
        ]  # fmt: skip
        found = list(source.samples(signals[:3]))
        at = 1_700_000_000 * SECOND + SECOND // 4
        assert found == [
            (at, "/joints/pan.effort", 1.5),
            (at, "/odom/pose/position.x", 3),
            (at + SECOND // 4, "/battery_status_01.voltage_v", 2.5),
        ]
        assert source.notes == {"columns left out, without numbers or with names that are no signals: 2": 1}


BATTERY = "sensor_msgs/msg/BatteryState,/battery\n"
ROW = "17,250000000,base,24.5,nan,-2.0,5.0,9.0,10.0,0.5,2,1,2,True,"
"""A battery as ``ros2 topic echo --csv`` prints it, before the arrays of cells' voltages and temperatures."""


def test_what_ros2_topic_echo_writes(tmp_path: Path) -> None:
    path = tmp_path / "battery.csv"
    lost = "A message was lost!!!\n\ttotal count change:1\n\ttotal count: 1\n"
    path.write_text(f"{BATTERY}{ROW}4.5,4.25,,slot,7\n{lost}{ROW.replace('17', '18', 1)}4.0,...,30.5,slot,7\n")
    with open_source(path) as source:
        (info,) = source.topics()
        assert (info.topic, info.type, info.messages) == ("/battery", "sensor_msgs/msg/BatteryState", 2)
        assert {"voltage", "percentage", "present"} < {*info.fields}
        assert not any("cell" in field for field in info.fields)  # where one array ends nothing says
        found = list(source.samples(["/battery.voltage", "/battery.present"]))
        at = 17 * SECOND + SECOND // 4
        assert found[:2] == [(at, "/battery.present", 1), (at, "/battery.voltage", 24.5)]
        assert [one.time for one in found[2:]] == [at + SECOND] * 2
        assert source.notes["/battery: lost by the subscriber, as `ros2 topic echo` says"] == 1
        assert any("arrays left out" in note for note in source.notes)


def test_of_one_array_alone_each_element_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a b.csv"
    joy = "sensor_msgs/msg/Joy\n"
    ranges = "sensor_msgs/msg/ChannelFloat32\n"
    path.write_text(f"{ranges}r,1.5\n")
    with pytest.raises(SourceError, match=r"begin with a header, so that .* writes no time; expected a recording"):
        open_source(path)
    path.write_text(f"{joy}1,0,x,0.5,1,0\n")  # axes and buttons
    with pytest.raises(SourceError, match="holds no values"):
        open_source(path)
    status = "diagnostic_msgs/msg/DiagnosticArray\n1,0,,b'\\x00',motor,ok,id,\n"
    path.write_text(status)
    with pytest.raises(SourceError, match="holds no values"):
        open_source(path)
    points = "geometry_msgs/msg/PolygonStamped\n1,0,map,0.0,1.0,2.0,3.0,4.0,5.0\n2,0,map,\n3,0,map,6.0,7.0,8.0,...\n"
    path.write_text(points)
    with open_source(path) as source:
        assert [(*one,) for one in source.samples(["/a_b.polygon.points[1].y"])] == [
            (SECOND, "/a_b.polygon.points[1].y", 4.0)
        ]
        assert [one.value for one in source.samples(["/a_b.polygon.points[0].x"])] == [0.0, 6.0]
        assert any("--full-length" in note for note in source.notes)


NONE = {
    "a type that nobody knows": (
        "no_msgs/msg/Thing,/a\n1,0,x,2.0\n",
        "line 1: topic '/a' has the type 'no_msgs/msg/Thing', whose",
    ),
    "no topic": ("sensor_msgs/msg/Temperature,/a.b\n1,0,x,2.0,0.0\n", "line 1: '/a.b' is not a topic"),
    "a text with a comma": (
        f"{BATTERY}{ROW.replace('base', 'a,b')}4.0,4.0,x,y\n",
        "line 2: 'b' is no float32, as 'voltage'",
    ),
    "cells too few": ("sensor_msgs/msg/Temperature,/a\n1,0,x,2.0\n", "line 2: 4 cells; expected 5 of sensor_msgs"),
    "cells of no whole element": (
        "geometry_msgs/msg/PolygonStamped,/a\n1,0,m,0.0,1.0\n",
        "2 cells of the array 'polygon.points'; expected 3 for",
    ),
    "times that go backwards": (
        "sensor_msgs/msg/Temperature,/a\n2,0,x,2.0,0.0\n1,0,x,2.0,0.0\n",
        "line 3: time goes backw",
    ),
    "no names of columns": (
        "1700000000,250,base,1.5\n1700000001,250,base,1.5\n",
        r"of `ros2 topic echo --csv` type and topic, e\.g\. sensor_msgs",
    ),
    "another program": (
        "Date,Volts\n1,2\n",
        "first column is 'Date'; expected 'time' and commas, or '__time' of PlotJ",
    ),
    "texts alone": ("__time,/a/b\n1,x\n", "holds no column of numbers"),
    "a text later": ("__time,/a/b\n1,1\n2,x\n", r"line 3, column 2 \(/a\.b\): 'x' is not a number"),
    "a time beyond all": ("%time,field.b\n99999999999999999999,1\n", "out of range"),
}


@pytest.mark.parametrize(("content", "says"), NONE.values(), ids=NONE)
def test_what_is_none_of_them_is_refused_in_one_line(tmp_path: Path, content: str, says: str) -> None:
    path = tmp_path / "table.csv"
    path.write_text(content)
    with pytest.raises(SourceError, match=says) as raised:
        list(open_source(path).samples(["/a.b"]))
    assert "\n" not in str(raised.value)
