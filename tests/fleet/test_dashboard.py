"""The fleet's dashboard for Grafana: each of its queries asked of a real PostgreSQL, by the role made for it."""

from __future__ import annotations

import json
import re
import statistics
import time
from pathlib import Path

import pytest

from robophm.core.signal import DAY, HOUR
from robophm.fleet.payload import Payload, PresentState, Report
from robophm.fleet.store import FleetStore
from robophm.stores.outbox import COLUMNS

DEPLOY = Path(__file__).parents[2] / "deploy"
WEEK = COLUMNS.index("failure_within.168")
ROBOTS, DAYS = 30, 40


def report(seq, at, chance):
    figures = [0.0] * len(COLUMNS)
    figures[WEEK] = chance
    return Report(seq, at, 0, tuple(figures))


@pytest.fixture(scope="module")
def told(server):
    """A store in which robots have told of forty days, and what each said first of each day."""
    psycopg = pytest.importorskip("psycopg")
    with psycopg.connect(server.address, autocommit=True) as base:
        base.execute("DROP SCHEMA IF EXISTS robophm_fleet CASCADE")
        base.execute("DROP ROLE IF EXISTS grafana")
    today, chances = time.time_ns() // DAY * DAY, {}
    with FleetStore(server.address, make=True) as store:
        for robot in range(ROBOTS):
            store.add_token(f"r{robot:02}", f"site {robot % 3}")
            some = []
            for day in range(DAYS):
                chances[robot, day] = ((robot * 37 + day * 11) % 100 + 1) / 256
                some.append(report(day + 1, today - (DAYS - day) * DAY + HOUR, chances[robot, day]))
            state = PresentState(1, "{}", {"robot": "courier", "design_hash": "d"}, ())
            store.commit([Payload(f"r{robot:02}", "a" * 16, time.time_ns(), robot % 2, tuple(some), state)])
        store.refuse("r01", "wrong token")
        store.refuse("", "wrong token")
    with psycopg.connect(server.address, autocommit=True) as base:
        for statement in (DEPLOY / "grafana-role.sql").read_text().split(";"):
            if statement.strip():
                base.execute(statement)
    yield chances, today
    with psycopg.connect(server.address, autocommit=True) as base:
        base.execute("DROP SCHEMA robophm_fleet CASCADE")
        base.execute("DROP ROLE grafana")


def test_each_query_of_the_dashboard_is_answered_to_its_role(server, told):
    psycopg = pytest.importorskip("psycopg")
    chances, today = told
    panels = json.loads((DEPLOY / "grafana-fleet.json").read_text())["panels"]
    since = today - 30 * DAY
    answers = {}
    with psycopg.connect(server.address.replace("user=robophm", "user=grafana"), autocommit=True) as base:
        for panel in panels:
            (target,) = panel["targets"]
            query = re.sub(
                r"\$__timeFilter\((to_timestamp\([^)]*\))\)",  # as Grafana writes it for its time range
                rf"\1 BETWEEN to_timestamp({since / 1e9}) AND to_timestamp({today / 1e9})", target["rawSql"],
            )  # fmt: skip
            assert "$__" not in query
            found = base.execute(query)
            names = [one.name for one in found.description]
            assert (target["format"] == "time_series") == (names[0] == "time")
            answers[panel["title"]] = found.fetchall()
            for override in panel["fieldConfig"]["overrides"]:
                assert override["matcher"]["options"] in names
        for secret in ("SELECT token FROM robophm_fleet.robot", "SELECT ledger FROM robophm_fleet.present"):
            with pytest.raises(psycopg.errors.InsufficientPrivilege):
                base.execute(secret)
        with pytest.raises(psycopg.errors.ReadOnlySqlTransaction):
            base.execute("CREATE TEMP TABLE one (a int)")

    numbers = {title: rows[0][0] for title, rows in answers.items() if len(rows) == 1 and len(rows[0]) == 1}
    assert numbers == {
        "Robots": ROBOTS, "Heard within ten minutes": ROBOTS, "Reports that wait at robots": ROBOTS // 2,
        "Reports missing": 0, "Clocks off by more than a minute": 0, "Refused": 2,
    }  # fmt: skip
    of_day = {day: [chances[robot, day] for robot in range(ROBOTS)] for day in range(DAYS - 30, DAYS)}
    expected = answers["Robots expected to fail within a week"]
    assert [one for _, one in expected] == pytest.approx([sum(some) for some in of_day.values()])
    assert [round(at.timestamp()) * 10**9 for at, _ in expected] == [today - (DAYS - day) * DAY for day in of_day]
    spread = answers["Probability of failing within a week, of robots"]
    for row, some in zip(spread, of_day.values(), strict=True):
        cuts = statistics.quantiles(some, n=20, method="inclusive")
        assert row[1:] == pytest.approx((cuts[0], statistics.median(some), cuts[-1]))
    newest = sorted(((chances[robot, DAYS - 1], f"r{robot:02}", f"site {robot % 3}") for robot in range(ROBOTS)),
                    reverse=True)[:20]  # fmt: skip
    assert [(row[2], row[0], row[1]) for row in answers["Will most probably fail within a week"]] == newest
    assert [row[1] for row in answers["Robots that told of the day"]] == [ROBOTS] * 30
    assert [row[:2] for row in answers["Refused, by reason"]] == [("wrong token", 2)]
    assert len(answers["Silent for longest"]) == 20
