"""Logs of PX4: what they hold is what pyulog reads, bit for bit, at the time that the GPS tells."""

from __future__ import annotations

import math
import random
import struct
import sys
import time
from pathlib import Path

import pytest
from pyulog import ULog

import robophm
from robophm.core.errors import SourceError
from robophm.monitoring.recording_sessions import sessions_of
from robophm.transports.recordings.formats.ulog import NO_UTC, UlogRecording
from robophm.transports.recordings.opening import open_source

from ...drafting.px4_flight import fly
from ..written.ulog import GPS, START, data, head, listens, message

BATTERY = (
    "battery_status:uint64_t timestamp;float voltage_v;float[3] cell_v;uint8_t warning;"
    "bool connected;cell worst;char[4] serial;"
)
CELL = "cell:int16_t number;double left;"
LAYOUT = "Qf3fB?hd4s"
UTC = 1_750_000_000_000_000


def flight(seconds: int = 60, *, gps: bool = True, later: int = 0) -> bytes:
    """A flight with two batteries at 2 Hz and a GPS at 1 Hz, of which the first tells no time and one a wrong one."""
    chance = random.Random(later)
    log = [
        head(GPS, BATTERY, CELL),
        listens(0, "vehicle_gps_position"),
        listens(1, "battery_status"),
        listens(2, "battery_status", 1),
    ]
    for step in range(2 * seconds):
        stamp = START + step * 500_000
        if gps and step % 2 == 0:
            wrong = 3600_000_000 if step == 20 else 0
            log.append(
                data(0, "QQB", stamp, UTC + stamp + wrong + later * 1_000_000 if step > 4 else 0, 3 if step > 4 else 0)
            )
        for number in (1, 2):
            cells = [chance.uniform(3, 4) for _ in range(3)]
            volts = math.nan if step == 7 else sum(cells)
            log.append(data(number, LAYOUT, stamp, volts, *cells, step % 4, step > 2, number, chance.random(), b"A1"))
    return b"".join(log)


@pytest.fixture
def flown(tmp_path: Path) -> Path:
    path = tmp_path / "flight.ulg"
    path.write_bytes(flight())
    return path


def test_all_values_are_those_of_pyulog_bit_for_bit(flown: Path) -> None:
    fields = ["voltage_v", *(f"cell_v[{i}]" for i in range(3)), "warning", "connected", "worst.number", "worst.left"]
    peer = ULog(str(flown))
    with open_source(flown) as source:
        for topic, instance in (("/battery_status", 0), ("/battery_status_1", 1)):
            expected = peer.get_dataset("battery_status", instance).data
            for field in fields:
                found = list(source.samples([f"{topic}.{field}"]))
                assert [struct.pack("<d", one.value) for one in found] == [
                    struct.pack("<d", float(value)) for value in expected[field]
                ]
                assert [one.time for one in found] == [(int(stamp) + UTC) * 1000 for stamp in expected["timestamp"]]
        assert not source.notes
        infos = {info.topic: info for info in source.topics()}
        assert infos["/battery_status_1"].fields == (
            "timestamp", "voltage_v", "cell_v[]", "warning", "connected", "worst.number", "worst.left",
        )  # fmt: skip
        assert infos["/battery_status"].messages == 120
        assert source.spans() == [((UTC + START) * 1000, (UTC + START + 59_500_000) * 1000)]


def test_messages_that_were_never_published_are_left_out_and_said(tmp_path: Path) -> None:
    path = tmp_path / "flight.ulg"
    path.write_bytes(flight() + data(1, LAYOUT, 0, 1.0, 1.0, 1.0, 1.0, 9, True, 1, 0.5, b"A1"))
    source = open_source(path)
    assert 9.0 not in {one.value for one in source.samples(["/battery_status.warning"])}
    assert source.notes == {"message without a time on /battery_status": 1}
    assert source.spans() == [((UTC + START) * 1000, (UTC + START + 59_500_000) * 1000)]


def test_two_topics_come_in_order_of_time(flown: Path) -> None:
    names = ["/battery_status.voltage_v", "/battery_status_1.warning", "/battery_status.warning"]
    found = list(open_source(flown).samples(names))
    assert [one[:2] for one in found] == [
        (one, name) for one in sorted({s.time for s in found}) for name in sorted(names)
    ]


def test_without_a_gps_that_is_said(tmp_path: Path) -> None:
    path = tmp_path / "flight.ulg"
    path.write_bytes(flight(gps=False))
    source = open_source(path)
    assert [one.time for one in source.samples(["/battery_status.warning"])][:2] == [
        START * 1000,
        (START + 500_000) * 1000,
    ]
    assert source.notes == {NO_UTC: 1}


def test_what_is_cut_or_lost_is_said(tmp_path: Path) -> None:
    whole = flight() + message("O", struct.pack("<H", 120))
    dropped, cut, broken = (tmp_path / name for name in ("dropped.ulg", "cut.ulg", "broken.ulg"))
    dropped.write_bytes(whole)
    cut.write_bytes(whole[:-600])
    source = open_source(dropped)
    assert len(list(source.samples(["/battery_status.warning"]))) == 120
    assert source.notes == {"messages lost while the autopilot logged": 1}
    source = open_source(cut)
    assert 110 < len(list(source.samples(["/battery_status.warning"]))) < 120
    broken.write_bytes(whole[:3000] + bytes(40) + whole[3000:])
    source = open_source(broken)
    assert 118 < len(list(source.samples(["/battery_status.warning"]))) <= 120  # pyulog alone finds 26
    assert source.notes["damaged, and read as far as it is whole"] == 1


@pytest.mark.full
@pytest.mark.parametrize("filling", [b"\0", b"\0\0D", b"\1\0\1\0"], ids=["zeros", "no content", "unknown"])
def test_megabytes_of_what_is_no_message_take_no_minutes(filling: bytes, tmp_path: Path) -> None:
    path = tmp_path / "filled.ulg"
    path.write_bytes(flight() + filling * ((1 << 24) // len(filling)))
    begun = time.process_time()
    with open_source(path) as source:
        assert len(list(source.samples(["/battery_status.warning"]))) == 120
        assert source.notes["bytes of a log that belong to no message"] > 1 << 23
    assert time.process_time() - begun < 5  # pyulog alone: up to half a minute


def test_more_topics_than_are_believed_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "many.ulg"
    path.write_bytes(flight() + listens(9, "battery_status") * 5000)
    with pytest.raises(SourceError, match=f"{path}: cannot be read: has messages of more than 4096 kinds or senders"):
        open_source(path)


NONE = {
    "head alone": (head(GPS)[:12], "cannot be read: Invalid file format"),
    "no messages": (head(GPS), "holds no messages"),
    "a message of itself": (head("a:uint64_t timestamp;a within;") + listens(0, "a"), "cannot be read"),
    "more than memory": (
        head("a:uint64_t timestamp;b[60000] x;", "b:c[60000] y;", "c:float[60000] z;") + listens(0, "a"),
        "messages of 'c' have 240000 bytes; at most 65535 can be",
    ),
    "an unknown type": (head("a:uint64_t timestamp;nothing x;") + listens(0, "a"), "cannot be read"),
}


@pytest.mark.parametrize(("content", "says"), NONE.values(), ids=NONE)
def test_what_is_no_log_is_refused_in_one_line(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "flight.ulg"
    path.write_bytes(content)
    with pytest.raises(SourceError, match=says) as raised:
        open_source(path)
    assert "\n" not in str(raised.value)


def test_hundreds_of_damaged_logs_are_read_or_refused(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    chance, whole = random.Random(5), flight(5)
    path = tmp_path / "flight.ulg"
    for _ in range(300):
        damaged = bytearray(whole[: chance.randrange(40, len(whole))])
        for _ in range(chance.randrange(4)):
            damaged[chance.randrange(8, len(damaged))] = chance.randrange(256)
        path.write_bytes(damaged)
        try:
            source = UlogRecording(path)
            for info in source.topics():
                field = info.fields[0].replace("[]", "[0]")
                assert all(isinstance(one.value, float) for one in source.samples([f"{info.topic}.{field}"]))
        except SourceError as error:
            assert str(error).startswith(str(path))  # noqa: PT017
            assert "\n" not in str(error)  # noqa: PT017
    assert capfd.readouterr() == ("", "")


def test_without_pyulog_it_is_said_how_to_get_it(flown: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyulog", None)
    with pytest.raises(SourceError, match=r"needs pyulog; install it with `pip install 'robophm\[px4\]'`"):
        open_source(flown)


DESIGN = """
schema_version: 1
name: drone
acceleration: {model: q10, reference_temperature: 40 degC}
signals:
  temperature: {topic: /battery_status, field: worst.left, unit: degC}
modules:
  Power:
    components:
      Battery: {mtbf: 100000 h}
"""


def test_a_topic_has_the_type_and_units_of_its_message_and_says_how_many_elements_there_are(tmp_path: Path) -> None:
    """As PX4's bridge names it in ROS 2, so that it is known there and here alike."""
    source = open_source(fly(tmp_path / "flight.ulg", 10))
    infos = {info.topic: info for info in source.topics()}
    assert infos["/battery_status"].type == "px4_msgs/msg/BatteryStatus"
    assert infos["/esc_status"].type == "px4_msgs/msg/EscStatus"
    assert [one for one in infos["/esc_status"].elements if "temperature" in one] == [
        f"esc[{number}].esc_temperature" for number in range(8)
    ]
    assert UlogRecording.type_of(source, "/vehicle_status_v1_1") == "px4_msgs/msg/VehicleStatus"
    (tmp_path / "robot.yaml").write_text(DESIGN.replace("worst.left", "voltage_v"))
    with pytest.raises(SourceError, match="voltage_v is in 'V'; the design expects 'degC'"):
        robophm.replay(robophm.load(tmp_path / "robot.yaml"), tmp_path / "flight.ulg")


def test_a_folder_of_flights_is_lived_in_order_of_time(tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(DESIGN)
    flights = tmp_path / "flights"
    flights.mkdir()
    for name, later in {"b.ulg": 0, "a": 3600}.items():
        (flights / name).write_bytes(flight(later=later))
    (flights / "notes.txt").write_text("two flights")
    robot = robophm.load(tmp_path / "robot.yaml")
    sessions = sessions_of(robot, flights)
    assert [Path(one.name).name for one in sessions] == ["b.ulg", "a"]
    report = robophm.replay(robot, flights)
    assert report.clocks["operating"] == pytest.approx(2 * 59.5 / 3600)
