"""How a fleet was, day by day, beside plain Python over what its robots sent; as a command, a page and in bulk."""

from __future__ import annotations

import json
import statistics
import time

import numpy as np
import pytest
from tests.fleet.conftest import serving
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.signal import DAY, HOUR
from robophm.fleet.payload import Payload, Report
from robophm.fleet.store import FleetStore
from robophm.fleet.tables import DAY as DAYS
from robophm.fleet.trend import first_day, trend
from robophm.stores.outbox import COLUMNS

WEEK = COLUMNS.index("failure_within.168")


def report(seq, at, chance):
    figures = [0.0] * len(COLUMNS)
    figures[WEEK] = chance
    return Report(seq, at, 0, tuple(figures))


def test_each_day_is_told_by_the_first_report_of_each_robot(address):
    today, chance = time.time_ns() // DAY * DAY, np.random.default_rng(5)
    first: dict[int, list[float]] = {}
    with FleetStore(address, make=True) as store:
        assert first_day(store) is None
        assert [*trend(store, 168.0, 0, today)] == []
        for robot in range(30):
            store.add_token(f"r{robot}")
            told, seq = [], 0
            for day in range(1, 71):
                if chance.random() < 0.3 or 40 < day < 45:
                    continue
                known = chance.random() < 0.9
                values = [float(np.float32(chance.random())) if known else float("nan") for _ in range(2)]
                for at, value in zip((3, 9), values, strict=True):
                    told.append(report(seq := seq + 1, today - day * DAY + at * HOUR + robot, value))
                if known:
                    first.setdefault(today - day * DAY, []).append(values[0])
            told = sorted(told, key=lambda one: one.time)
            told = [one._replace(seq=at) for at, one in enumerate(told, 1)]
            store.commit([Payload(f"r{robot}", "a" * 16, today, 0, tuple(told), None)])
        found = [*trend(store, 168.0, today - 65 * DAY + HOUR, today)]
        begun = first_day(store)
    assert begun == today - 70 * DAY
    expected = {day: sorted(some) for day, some in first.items() if day >= today - 65 * DAY}
    assert [one.begin for one in found] == sorted(expected)
    for one in found:
        some = expected[one.begin]
        assert (one.robots, one.worst) == (len(some), some[-1])
        assert one.expected == pytest.approx(sum(some), rel=1e-6)
        quarters = statistics.quantiles(some, n=20, method="inclusive")
        assert one.quantiles == pytest.approx((quarters[0], statistics.median(some), quarters[-1]), rel=1e-6)


def test_as_people_ask_and_on_the_page(tmp_path):
    now, path = time.time_ns(), tmp_path / "fleet.db"
    with FleetStore(path, make=True) as store:
        for robot, chances in (("a", (0.1, 0.2)), ("b", (0.3, 0.5))):
            store.add_token(robot)
            told = tuple(report(at, now - (3 - at) * DAY, one) for at, one in enumerate(chances, 1))
            store.commit([Payload(robot, "a" * 16, now, 0, told, None)])

    def asked(*words):
        done = CliRunner().invoke(app, ["fleet", "trend", "--store", str(path), *words])
        assert done.exit_code == 0, (done.output, done.exception)
        return done.stdout

    days = json.loads(asked("--json"))["days"]
    assert [one["expected"] for one in days] == pytest.approx([0.4, 0.7], rel=1e-6)
    text = asked()
    assert "expected to fail" in text
    assert "P(fails within 7 days), by day in UTC" in text
    assert "mean P of a robot: ▁█" in text
    assert "No robot has told of that time" in asked("--to", "2020-01-01")
    import httpx

    with serving(path) as served:
        page = httpx.get(f"{served.address}days", timeout=60)
        assert page.status_code == 200
        assert ">0.4<" in page.text
        assert ">0.7<" in page.text
        assert "<svg" in page.text
        assert "./days?horizon=168" in httpx.get(served.address, timeout=60).text


@pytest.mark.full
def test_a_year_of_a_thousand_robots_takes_at_most_two_seconds(tmp_path):
    with FleetStore(tmp_path / "fleet.db", make=True) as store:
        chance = np.random.default_rng(1).random((365, 1000))
        with store.writing() as engine:
            engine.merge(DAYS, [(robot, day, day * DAY, None, float(chance[day, robot]), None)
                                for day in range(365) for robot in range(1000)])  # fmt: skip
        begun = time.process_time()
        found = [*trend(store, 168.0, 0, 365 * DAY)]
        took = time.process_time() - begun
    assert len(found) == 365
    assert [one.quantiles[1] for one in found] == pytest.approx(np.median(chance, axis=1).tolist())
    print(f"a year of a thousand robots by day: {took:.2f} s of a processor")
    assert took < 2
