"""Recordings as the service tells of them, beside the samples themselves and the command."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from robophm.cli.app import app
from robophm.core.signal import SECOND
from robophm.transports.synthetic import SyntheticOta

from .conftest import SMALL, Served, serving

VOLTAGE = "/ota/battery.voltage"
DRIVE = SyntheticOta(seed=3, duration=60 * SECOND)


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A minute of the synthetic robot."""
    return DRIVE.record(tmp_path_factory.mktemp("recorded") / "drive.mcap")


@pytest.fixture(scope="module")
def served(drive: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    design = tmp_path_factory.mktemp("served") / "courier.yaml"
    design.write_text(SMALL)
    with serving(design, recordings=(drive,)) as found:
        yield found


def test_topics_and_fields_are_those_of_the_command(
    served: Served, drive: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert served.get("/api/recordings") == {"names": ["drive.mcap"]}
    found = served.get("/api/recordings/topics", name="drive.mcap")
    app(["data", "list", str(drive)], standalone_mode=False)
    said = [line.split() for line in capsys.readouterr().out.splitlines()]
    topics, fields = found["tables"]
    for row in topics["rows"]:
        assert [word for cell in row for word in cell.split()] in said
    battery = next(row for row in fields["rows"] if row[0] == "/ota/battery")
    assert battery[1] == "sensor_msgs/BatteryState"
    assert "voltage [V]" in battery[2].split(", ")
    assert VOLTAGE in found["signals"]


def test_a_course_has_the_samples_themselves(served: Served) -> None:
    found = served.get("/api/recordings/signal", name="drive.mcap", signal=VOLTAGE)
    heard = [(one.time / SECOND, one.value) for one in DRIVE.samples([VOLTAGE]) if one.signal == VOLTAGE]
    values = [value for _, value in heard]
    assert min(low for low in found["lowest"] if low is not None) == pytest.approx(min(values))
    assert max(high for high in found["highest"] if high is not None) == pytest.approx(max(values))
    assert abs(found["times"][0] - heard[0][0]) < 0.1
    assert found["label"] == f"{VOLTAGE} [V]"


def test_a_silence_breaks_the_line(tmp_path: Path) -> None:
    table = tmp_path / "drive.csv"
    rows = [f"{time},{20 + time % 2}" for time in (*range(30), *range(600, 630))]
    table.write_text("time,/motor.temperature\n" + "\n".join(rows) + "\n")
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design, recordings=(table,)) as found:
        signal = found.get("/api/recordings/signal", name="drive.csv", signal="/motor.temperature")
    silent = [time for time, low in zip(signal["times"], signal["lowest"], strict=True) if low is None]
    assert len(silent) == 1
    assert 29 < silent[0] < 36  # a value holds for five seconds


@pytest.mark.parametrize(
    ("route", "query", "said"),
    [
        ("topics", {"name": "drve.mcap"}, "no recording 'drve.mcap'; did you mean 'drive.mcap'?"),
        ("signal", {"name": "drive.mcap", "signal": "/ota/batery.voltage"}, "no topic '/ota/batery'"),
        ("signal", {"name": "drive.mcap", "signal": "/ota/battery.voltge"}, "'voltage'"),
        ("signal", {"name": "drive.mcap", "signal": "x"}, "x"),
        ("signal", {"name": "drive.mcap", "signal": "/ota/battery.charge"}, "/ota/battery.charge: no samples in drive"),
    ],
)
def test_what_is_not_there_is_said_in_a_line(
    served: Served, drive: Path, route: str, query: dict[str, str], said: str
) -> None:
    answer = served.client.get(f"/api/recordings/{route}", params=query)
    assert answer.status_code == 422
    assert said in answer.json()["message"]
    assert str(drive.parent) not in answer.json()["message"]
    assert "\n" not in answer.json()["message"]


def test_what_is_too_large_for_a_page_is_refused(served: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robophm.web.routes.recordings.MOST_READ", 1000)
    answer = served.client.get("/api/recordings/topics", params={"name": "drive.mcap"})
    assert answer.status_code == 422
    assert "`robophm data` has the time" in answer.json()["message"]
