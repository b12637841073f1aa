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


def fill(
    design: Path, path: Path, begin: int = BEGIN, count: int = COUNT, off: range = range(100 * 24, 110 * 24),
    every: int = 1,
) -> None:  # fmt: skip
    """Keep reports, one in ``every`` so many hours, whose sensor-based hazard rate is their hour's number.

    They are in a breach from the 200th to the 210th day.
    """
    robot = load(design)
    monitor = Monitor(robot)
    report = monitor.report(remaining_life="robot").to_json(failures_to_come=False)
    whole, rest = report["subjects"][0], report["subjects"][1:]
    reports = []
    for hour in range(0, count, every):
        if hour in off:
            continue
        told = ["hazard rate 2 /h is above 1 /h"] if 200 * 24 <= hour < 210 * 24 else []
        moved = {**whole, "sensor_based": {**whole["sensor_based"], "hazard_rate": float(hour)}, "breaches": told}
        state = "error" if told else "ok"
        one = {"time": begin + hour * DAY // 24, "subjects": [moved, *rest], "state": state, "breaches": told}
        reports.append({**report, **one, "signals": {"/casters.t": float(hour % 24)}})
    with SqliteStore(path) as store:
        restart = Event(begin + 110 * DAY, "restart", "", "watching began again")
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


def test_the_course_of_a_signal_over_any_stretch(lived: Served) -> None:
    assert lived.get("/api/history", points=2)["signals"] == {"/casters.t": None}  # the design binds it no more
    begin = BEGIN / SECOND + (COUNT - 48) * 3600
    day = lived.get("/api/history/signal", signal="/casters.t", start=begin, end=begin + 86_400)
    assert (day["width"], day["values"]["mean"]) == (0, [*range(24)])
    whole = lived.get("/api/history/signal", signal="/casters.t", points=100)
    assert (min(whole["values"]["low"]), max(whole["values"]["high"])) == (0, 23)
    assert set(whole["values"]["mean"]) == {11.5}
    assert lived.client.get("/api/history/signal", params={"signal": "/nobody.t"}).status_code == 404


def test_the_report_of_then(lived: Served) -> None:
    asked = BEGIN / SECOND + 205 * 86_400 + 1800
    found = lived.get("/api/history/report", time=asked)
    assert found["report"]["state"] == "error"
    assert 0 <= found["hours_before"] < 24
    assert found["hours_before"] == pytest.approx((asked - found["time"]) / 3600)
    assert lived.get("/api/history/report", time=0)["hours_before"] < 0


def test_trends_of_a_day_and_a_month(lived: Served) -> None:
    found = lived.get("/api/history/trends")
    assert found["until"] == BEGIN / SECOND + (COUNT - 1) * 3600
    assert found["times"] == [found["until"] - 3600 * before for before in range(24, -1, -1)]
    rate = found["figures"]["hazard_rate"]
    assert rate["course"] == [*range(COUNT - 25, COUNT)]
    assert rate["day"] == pytest.approx(24 / (COUNT - 25), rel=1e-12)
    assert rate["month"] == pytest.approx(720 / (COUNT - 721), rel=1e-12)
    for figure in ("reliability", "remaining_life", "completion"):
        assert (found["figures"][figure]["day"], found["figures"][figure]["month"]) == (0, 0)
    whole = lived.get("/api/history/report", time=9e9)["report"]["subjects"][0]["sensor_based"]
    assert found["figures"]["completion"]["course"] == pytest.approx([whole["completion"]["failure"]] * 25, rel=1e-6)
    assert found["figures"]["remaining_life"]["course"][0] == pytest.approx(whole["remaining_life"]["median"], rel=1e-6)


def test_without_a_past_there_is_none(shared_small: Served) -> None:
    found = shared_small.get("/api/history")
    assert (found["first"], found["times"], found["figures"], found["signals"]) == (None, [], {}, {})
    assert shared_small.get("/api/history/trends") == {"until": None, "times": [], "breaks": [], "figures": {}}
    assert shared_small.client.get("/api/history/report", params={"time": 0}).status_code == 404


@pytest.mark.parametrize("query", ["points=1", "points=2001", "start=x", "start=1e300", "end=nan"])
def test_what_is_no_window_is_refused(shared_small: Served, query: str) -> None:
    assert shared_small.client.get(f"/api/history?{query}").status_code == 422
