"""A recording as if it were live: the same samples, at its pace, until somebody says stop."""

import threading
import time

import pytest

from robophm.core.errors import SourceError
from robophm.core.signal import SECOND
from robophm.transports.recordings.formats.csv import CsvRecording
from robophm.transports.recordings.paced import Paced


@pytest.fixture
def table(tmp_path):
    """Four seconds, a silence of an hour, and one more."""
    path = tmp_path / "drive.csv"
    times = [*range(5), 3604]
    path.write_text("time,/a.b\n" + "".join(f"{1_700_000_000 + at},{at}\n" for at in times))
    return path


def test_the_samples_are_the_recordings_own_and_come_at_its_pace(table):
    expected = list(CsvRecording(table).samples(["/a.b"]))
    begun, came = time.monotonic(), []
    for sample in Paced(CsvRecording(table), 10.0).samples(["/a.b"]):
        came.append((time.monotonic() - begun, sample))
        if len(came) == 5:
            break
    assert [sample for _, sample in came] == expected[:5]
    for late, sample in came:  # never early
        assert late >= (sample.time / SECOND - 1_700_000_000) / 10 - 1e-3


def test_nobody_waits_through_an_hour_of_silence(table):
    begun = time.monotonic()
    assert len(list(Paced(CsvRecording(table), 1000.0).samples(["/a.b"]))) == 6
    assert 2.0 <= time.monotonic() - begun < 10.0


def test_it_ends_when_it_is_closed_from_another_thread(table):
    source = Paced(CsvRecording(table), 0.001)
    threading.Timer(0.2, source.close).start()
    assert len(list(source.samples(["/a.b"]))) == 1
    source.close()


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan"), 1e7])
def test_a_speed_that_is_none_is_refused(table, speed):
    with pytest.raises(SourceError, match="expected above zero"):
        Paced(CsvRecording(table), speed)
