"""What every source must do: each format of recordings, as ``written/<format>.py`` writes 30 s of the drive in it."""

from __future__ import annotations

import runpy
import shutil
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import CLOCK, Sample
from robophm.transports import SignalSource, open_source
from robophm.transports.recordings.formats.csv import CsvRecording
from robophm.transports.recordings.recognising import formats, suffixes
from robophm.transports.synthetic import SyntheticOta

from .conftest import SIGNALS


class Made(NamedTuple):
    """A format of recordings, or what makes a drive up: how it is opened, and what the drive's samples are in it."""

    open: Callable[[SyntheticOta, Path], SignalSource]
    names: Mapping[str, str] = {signal: signal for signal in SIGNALS}
    """What each signal of the drive is called: names are short in some formats."""
    stored: Callable[[float], float] = float
    """The value that a format has in the place of one."""

    def samples(self, drive: SyntheticOta, signals: Iterable[str]) -> list[Sample]:
        """The samples of the drive as they are in this format."""
        return sorted(
            Sample(time, self.names[one], self.stored(value)) for time, one, value in drive.samples([*signals])
        )


def written(name: str) -> Made:
    """What opens the drive as ``written/<name>.py`` writes it."""
    module = runpy.run_path(str(Path(__file__).parent / "written" / f"{name}.py"))
    told = {key: module[given] for key, given in (("names", "NAMES"), ("stored", "stored")) if given in module}
    return Made(lambda drive, folder: open_source(module["write"](drive, SIGNALS, folder)), **told)


SOURCES: dict[str, Made] = {name: written(name) for name in formats()} | {"synthetic": Made(lambda drive, _: drive)}


@pytest.fixture(params=SOURCES)
def make(request: pytest.FixtureRequest) -> Made:
    return SOURCES[request.param]


def test_yields_exactly_the_wanted_samples_in_time_order(make: Made, drive: SyntheticOta, tmp_path: Path) -> None:
    wanted = [make.names[signal] for signal in SIGNALS[1:4]]
    with make.open(drive, tmp_path) as source:
        found = [sample for sample in source.samples(wanted) if sample.signal != CLOCK]
        assert [sample.time for sample in found] == sorted(sample.time for sample in found)
        assert sorted(found) == make.samples(drive, SIGNALS[1:4])
        assert len(found) == 3 * len(drive.times)
        assert all(type(value) is float and type(time) is int for time, _, value in found)
        assert list(source.samples(wanted)) == list(source.samples(reversed(wanted * 2)))
        assert not source.notes


def test_nothing_is_wanted(make: Made, drive: SyntheticOta, tmp_path: Path) -> None:
    with make.open(drive, tmp_path) as source:
        assert [sample for sample in source.samples(()) if sample.signal != CLOCK] == []


def test_topics_name_what_can_be_asked_for(make: Made, drive: SyntheticOta, tmp_path: Path) -> None:
    with make.open(drive, tmp_path) as source:
        topics = {info.topic: info for info in source.topics()}
        assert list(topics) == sorted(topics)
        for signal in make.names.values():
            info = topics[signal.partition(".")[0]]
            assert signal.partition(".")[2] in info.fields
            assert info.messages == len(drive.times)
            assert info.first is not None
            assert info.last is not None
            assert 0 <= info.first - drive.times[0] < 10**9
            assert 0 <= info.last - drive.times[-1] < 10**9


@pytest.mark.parametrize("wrong", ["topic", "field", "no field", "element", "other field"])
def test_unknown_signal_is_an_error_before_the_first_sample(
    make: Made, drive: SyntheticOta, tmp_path: Path, wrong: str
) -> None:
    topic, _, field = make.names["/ota/battery.voltage"].partition(".")
    signal, hint = {
        "topic": (f"{topic[:-1]}.{field}", topic),
        "field": (f"{topic}.{field[:-1]}", field),
        "no field": (topic, ""),
        "element": (f"{topic}.{field}[0]", ""),
        "other field": (f"{topic}.header", ""),
    }[wrong]
    with make.open(drive, tmp_path) as source, pytest.raises(SourceError) as error:
        source.samples([make.names[SIGNALS[0]], signal])
    assert "\n" not in str(error.value)
    assert hint in str(error.value)


def test_fingerprint_is_of_the_content(make: Made, drive: SyntheticOta, tmp_path: Path) -> None:
    one, other, changed = (tmp_path / name for name in ("one", "other", "changed"))
    for folder in (one, other, changed):
        folder.mkdir()
    with make.open(drive, one) as first:
        written = next(one.iterdir(), None)
        again = first.fingerprint
        if written is None:
            again = SyntheticOta(seed=3, duration=30 * 10**9).fingerprint
        else:
            copy = other / ("copy" + written.suffix)
            (shutil.copytree if written.is_dir() else shutil.copy)(written, copy)
            with open_source(copy) as second:
                again = second.fingerprint
        assert again == first.fingerprint
        with make.open(SyntheticOta(seed=4, duration=30 * 10**9), changed) as third:
            assert third.fingerprint != first.fingerprint


def test_closing_twice_does_no_harm(make: Made, drive: SyntheticOta, tmp_path: Path) -> None:
    source = make.open(drive, tmp_path)
    next(source.samples([*make.names.values()]))
    source.close()
    source.close()


@pytest.mark.parametrize("name", ["drive.bag", "drive.db3", "drive.mcap", "drive.csv", "drive.journal", "drive"])
def test_missing_file(name: str, tmp_path: Path) -> None:
    (tmp_path / "drives.bag").touch()
    with pytest.raises(SourceError, match=r"drive.*no such file; (did you mean|known:) .*drives\.bag"):
        open_source(tmp_path / name)


@pytest.mark.parametrize("name", ["nope.bag", "nope.rosbag", "nope"])
def test_what_is_no_recording_is_not_offered_as_one(name: str, tmp_path: Path) -> None:
    for other in ("nope.py", "nope.html", "robot.yaml", "a.bag", "b.MCAP", "c.journal"):
        (tmp_path / other).touch()
    for folder in ("drives", "notes"):
        (tmp_path / folder).mkdir()
    (tmp_path / "drives" / "d.db3").touch()
    told = r"no such file; (known: a\.bag, b\.MCAP, c\.journal, drives|did you mean 'a\.bag'\?)$"
    with pytest.raises(SourceError, match=told):
        open_source(tmp_path / name)


@pytest.mark.parametrize("content", [b"", b"\0" * 5000, b"time;a\n", bytes(range(256)) * 40], ids=len)
@pytest.mark.parametrize("suffix", [*sorted(suffixes()), ".txt", ""])
def test_not_a_recording(content: bytes, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"drive{suffix}"
    path.write_bytes(content)
    with pytest.raises(SourceError) as error:
        open_source(path)
    assert str(error.value).startswith(str(path))
    assert "\n" not in str(error.value)


def test_what_holds_samples_is_read_alone(drive: SyntheticOta, tmp_path: Path) -> None:
    table = written("csv").open(drive, tmp_path)
    other = drive.record(tmp_path / "b.bag")
    assert isinstance(table, CsvRecording)
    with pytest.raises(SourceError, match="alone"):
        open_source(table.path, other)
