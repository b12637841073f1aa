"""The robot's history as the service tells it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from robophm.core.signal import DAY, SECOND
from robophm.design.file import load
from robophm.monitoring.monitor import Monitor
from robophm.stores.events import Event
from robophm.stores.sqlite import SqliteStore

from .conftest import SMALL, Served, serving

BEGIN = 1_700_006_400 * SECOND  # the beginning of an hour
COUNT = 24 * 400
"""Reports, one an hour, of 400 days without the hundredth to the hundred and tenth."""


@pytest.fixture(scope="module")
def lived(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """The courier after 400 days, of which its store knows."""
    folder = tmp_path_factory.mktemp("lived")
    design = folder / "courier.yaml"
    design.write_text(SMALL)
    fill(design, folder / "past.db")
    with serving(design, seed=1, store=folder / "past.db") as served:
        yield served


def fill(design: Path, path: Path) -> None:
    """Keep reports whose sensor-based hazard rate is their number, in a breach from the 200th to the 210th day."""
    robot = load(design)
    monitor = Monitor(robot)
    report = monitor.report(remaining_life="robot").to_json(failures_to_come=False)
    whole, rest = report["subjects"][0], report["subjects"][1:]
    reports = []
    for hour in range(COUNT):
        if 100 * 24 <= hour < 110 * 24:
            continue
        told = ["hazard rate 2 /h is above 1 /h"] if 200 * 24 <= hour < 210 * 24 else []
        moved = {**whole, "sensor_based": {**whole["sensor_based"], "hazard_rate": float(hour)}, "breaches": told}
        state = "error" if told else "ok"
        one = {"time": BEGIN + hour * DAY // 24, "subjects": [moved, *rest], "state": state, "breaches": told}
        reports.append({**report, **one})
    with SqliteStore(path) as store:
        restart = Event(BEGIN + 110 * DAY, "restart", "", "watching began again")
        store.save(robot.identity, monitor.ledger.to_json(), (), reports, [restart])


def test_figures_gaps_and_events_of_any_stretch(lived: Served) -> None:
    whole = lived.get("/api/history", points=100)
    begin, end = BEGIN / SECOND, (BEGIN + (COUNT - 1) * DAY // 24) / SECOND
    assert (whole["first"], whole["last"]) == (begin, end)
    rates = whole["figures"]["hazard_rate.sensor_based"]
    assert (min(rates["low"]), max(rates["high"])) == (0, COUNT - 1)  # no peak is lost
    assert len(whole["times"]) <= 100
    assert whole["width"] == 5 * 86_400
    assert [whole["times"][place] - whole["times"][place - 1] for place in whole["breaks"]] in (
        [],
        [3 * whole["width"]],
    )
    assert [(one["kind"], (one["time"] - begin) / 86_400) for one in whole["events"]] == [
        ("restart", 110), ("breach", 200), ("breach ended", 210)
    ]  # fmt: skip
    assert set(whole["figures"]["state"]["high"]) == {0, 3}
    day = lived.get("/api/history", start=begin + 95 * 86_400, end=begin + 115 * 86_400)
    assert day["width"] == 0
    assert day["figures"]["hazard_rate.sensor_based"]["mean"] == [*range(95 * 24, 100 * 24), *range(110 * 24, 115 * 24)]
    assert day["breaks"] == [5 * 24]
    assert [one["kind"] for one in day["events"]] == ["restart"]


def test_the_report_of_then(lived: Served) -> None:
    asked = BEGIN / SECOND + 205 * 86_400 + 1800
    found = lived.get("/api/history/report", time=asked)
    assert found["report"]["state"] == "error"
    assert 0 <= found["hours_before"] < 24
    assert found["hours_before"] == pytest.approx((asked - found["time"]) / 3600)
    assert lived.get("/api/history/report", time=0)["hours_before"] < 0


def test_without_a_past_there_is_none(shared_small: Served) -> None:
    found = shared_small.get("/api/history")
    assert (found["first"], found["times"], found["figures"]) == (None, [], {})
    assert shared_small.client.get("/api/history/report", params={"time": 0}).status_code == 404


@pytest.mark.parametrize("query", ["points=1", "points=2001", "start=x", "start=1e300", "end=nan"])
def test_what_is_no_window_is_refused(shared_small: Served, query: str) -> None:
    assert shared_small.client.get(f"/api/history?{query}").status_code == 422
