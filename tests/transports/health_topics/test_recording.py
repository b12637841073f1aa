"""Health in a file: a name that is taken, a file that was not ended, and a disk that is full."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.monitoring.monitor import Monitor
from robophm.transports.health_topics import HealthRecording, HealthTopics
from robophm.transports.recordings.opening import open_source

ROBOT = parse("schema_version: 1\nname: R\ncomponents: {motor: {rate: 0.01 /h}, wheel: {rate: 0.02 /h}}\n")


def publish(recording: HealthRecording, times: int, robot: Robot = ROBOT) -> HealthTopics:
    monitor = Monitor(robot)
    sink = HealthTopics(robot, recording)
    for second in range(times):
        monitor.observe(Sample((1_700_000_000 + second) * SECOND, "clock", 0.0))
        sink.publish(monitor.report(remaining_life=False))
    return sink


def test_what_is_published_is_in_the_file(tmp_path: Path) -> None:
    """By the definitions in it: the rates of a series system are those of its parts together."""
    publish(HealthRecording(tmp_path / "h.mcap"), 3).close()
    with (tmp_path / "h.mcap").open("rb") as file:
        found = list(make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages("/phm/r"))
    assert [one.decoded_message.hazard_rate_nominal for one in found] == pytest.approx([0.03] * 3, rel=1e-15)
    assert [one.decoded_message.header.stamp.sec for one in found] == [1_700_000_000 + n for n in range(3)]


def test_reports_may_be_published_further_apart_than_they_come(tmp_path: Path) -> None:
    sink = publish(HealthRecording(tmp_path / "h.mcap"), 3)
    sink.every = 3600.0
    monitor = Monitor(ROBOT)
    for second in range(3, 8):
        monitor.observe(Sample((1_700_000_000 + second) * SECOND, "clock", 0.0))
        sink.publish(monitor.report(remaining_life=False))
    sink.every = 0.0
    sink.publish(monitor.report(remaining_life=False))
    sink.close()
    with (tmp_path / "h.mcap").open("rb") as file:
        found = list(make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages("/phm/r"))
    assert [one.decoded_message.header.stamp.sec - 1_700_000_000 for one in found] == [0, 1, 2, 7]


def test_a_robot_whose_name_is_that_of_a_topic(tmp_path: Path) -> None:
    """A robot called "Markers" has the next name that is free; its figures alone are beside it."""
    robot = parse("schema_version: 1\nname: Markers\ncomponents: {motor: {rate: 0.01 /h}, wheel: {rate: 0.02 /h}}\n")
    publish(HealthRecording(tmp_path / "h.mcap"), 3, robot).close()
    with (tmp_path / "h.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        types = {one.channel.topic: one.schema.name for one in reader.iter_decoded_messages() if one.schema}
        file.seek(0)
        rates = [one.decoded_message.data for one in reader.iter_decoded_messages("/phm/hazard_rate")]
    assert types["/phm/markers_2"] == "phm_msgs/msg/Health"
    assert types["/phm/markers"] == "visualization_msgs/msg/MarkerArray"
    assert rates == pytest.approx([0.03] * 3, rel=1e-15)


def test_a_name_that_is_taken_is_refused_and_left_as_it_is(tmp_path: Path) -> None:
    (tmp_path / "h.mcap").write_text("mine")
    with pytest.raises(SourceError, match=r"h\.mcap: exists; expected a new name"):
        HealthRecording(tmp_path / "h.mcap")
    assert (tmp_path / "h.mcap").read_text() == "mine"
    with pytest.raises(SourceError, match="cannot be written: No such file or directory"):
        HealthRecording(tmp_path / "none" / "h.mcap")


def test_a_recording_that_was_not_ended_is_read_as_far_as_it_goes(tmp_path: Path) -> None:
    recording = HealthRecording(tmp_path / "h.mcap")
    sink = publish(recording, 60)
    recording._file.flush()  # as the system has it when a process is killed, at the most
    killed = tmp_path / "killed.mcap"
    killed.write_bytes((tmp_path / "h.mcap").read_bytes())
    sink.close()
    with killed.open("rb") as file, pytest.raises(McapError):
        make_reader(file).get_summary()
    with open_source(killed) as source:
        values = [one.value for one in source.samples(["/phm/r.hazard_rate_nominal"]) if one.signal != "clock"]
    assert 0 < len(values) < 60
    assert values == pytest.approx([0.03] * len(values), rel=1e-15)


FULL = """
import resource, sys
from pathlib import Path
from tests.transports.health_topics.test_recording import publish
from robophm.transports.health_topics import HealthRecording
resource.setrlimit(resource.RLIMIT_FSIZE, (3_000, 3_000))
sink = publish(HealthRecording(Path(sys.argv[1])), 60)
sink.close()
print(dict(sink.notes))
"""


def test_where_no_more_can_be_written_that_is_noted_and_ends_nothing(tmp_path: Path) -> None:
    """The system refuses a file of over 3 kB."""
    command = [sys.executable, "-c", FULL, str(tmp_path / "h.mcap")]
    done = subprocess.run(command, capture_output=True, text=True, cwd=Path(__file__).parents[3], check=False)
    assert done.returncode == 0, done.stderr
    assert "not recorded: File too large" in done.stdout
    assert (tmp_path / "h.mcap").stat().st_size <= 3_000
