"""A recording that was cut: what is whole of it is what was recorded."""

from __future__ import annotations

from pathlib import Path

import pytest

import robophm
from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.opening import open_source
from robophm.transports.recordings.recording import Recording
from robophm.transports.recordings.salvage import Salvage
from robophm.transports.synthetic import SyntheticOta

SIGNALS = ("/ota/power/temperature.temperature", "/ota/odom.pose.pose.position.x")


@pytest.mark.parametrize("suffix", [".bag", ".mcap"])
def test_what_is_whole_is_read_and_the_rest_is_said(tmp_path: Path, suffix: str) -> None:
    whole = SyntheticOta(seed=2, duration=7200 * SECOND).record(tmp_path / f"whole{suffix}")
    cut = tmp_path / f"cut{suffix}"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size * 2 // 3])
    with pytest.raises(SourceError):
        Recording(cut)
    with open_source(cut) as source, Recording(whole) as recording:
        assert isinstance(source, Salvage)
        assert {info.topic for info in source.topics()} <= {info.topic for info in recording.topics()}
        for signal in SIGNALS:
            found, recorded = list(source.samples([signal])), list(recording.samples([signal]))
            assert 100 < len(found) < len(recorded)
            assert found == recorded[: len(found)]
        assert any("damaged, and read as far as it is whole" in note for note in source.notes)
        assert any("lost" in note for note in source.notes)


def test_its_life_is_that_of_what_is_left(tmp_path: Path) -> None:
    robot = robophm.load(Path(__file__).parents[4] / "examples" / "ota" / "robot.yaml")
    whole = SyntheticOta(seed=2, duration=7200 * SECOND).record(tmp_path / "whole.mcap")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size * 2 // 3])
    report = robophm.replay(robot, cut, skip_missing=True)
    assert 0.2 < report.clocks["calendar"] < 7199 / 3600
    assert any("damaged" in note for note in report.notes)


@pytest.mark.parametrize("content", [b"", b"garbage", b"#ROSBAG V2.0\n", b"\x89MCAP0\r\n"])
@pytest.mark.parametrize("suffix", [".bag", ".mcap", ".db3"])
def test_what_holds_nothing_is_refused_in_the_words_of_its_reader(tmp_path: Path, suffix: str, content: bytes) -> None:
    path = tmp_path / f"none{suffix}"
    path.write_bytes(content)
    with pytest.raises(SourceError) as expected:
        Recording(path)
    with pytest.raises(SourceError) as found:
        open_source(path)
    assert str(found.value) == str(expected.value)
