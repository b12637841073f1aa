"""The history of a robot in every store: figures of all time, thinned reports, events; and stores of before."""

from __future__ import annotations

import json
import math
import random
import sqlite3
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robophm.core.errors import RobophmError, StoreError
from robophm.stores import open_store, restore_store, stores
from robophm.stores.alarm_log import AlarmsInMemory
from robophm.stores.events import Event
from robophm.stores.figures import FIGURES, STATES, FigureSeries
from robophm.stores.sqlite import SqliteStore
from robophm.stores.store import Store

from .test_alarm_log import alarm

SECOND = 10**9
MINUTE, HOUR, DAY = 60 * SECOND, 3600 * SECOND, 86_400 * SECOND
BEGIN = 1_700_000_000 * SECOND + 7


@pytest.fixture(params=stores())
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    with open_store(f"{request.param}:{tmp_path / 'robots'}") as opened:
        yield opened


def report(time: int, draw: random.Random | None = None, **more: Any) -> dict[str, Any]:
    """A report as it is kept, with figures that are drawn, some of them missing or infinite."""
    draw = draw or random.Random(time)

    def view() -> dict[str, Any]:
        life = draw.choice([None, {"median": "Infinity"}, {"median": draw.uniform(1, 1e5)}])
        done = draw.choice([None, {"probability": 0.9, "failure": draw.uniform(0, 0.1)}])
        rate, failed = draw.uniform(1e-12, 1e-3), draw.uniform(0, 1)
        return {
            "hazard_rate": rate, "unreliability": failed, "reliability": 1 - failed, "remaining_life": life,
            "completion": done,
        }  # fmt: skip

    robot = {"kind": "robot", "path": "R", "nominal": view(), "sensor_based": view(), "flags": [], "breaches": []}
    clocks = {"operating": draw.uniform(0, 1e4), "calendar": 1.0}
    return {"time": time, "state": draw.choice(STATES), "clocks": clocks, "subjects": [robot], **more}


def values(one: dict[str, Any]) -> list[float]:
    """The figures of a report, read by hand, in single precision as they are kept."""
    nominal, lived = one["subjects"][0]["nominal"], one["subjects"][0]["sensor_based"]
    row = [
        nominal["hazard_rate"], lived["hazard_rate"], nominal["unreliability"], lived["unreliability"],
        *((view["remaining_life"] or {"median": "nan"})["median"] for view in (nominal, lived)),
        *((view["completion"] or {"failure": "nan"})["failure"] for view in (nominal, lived)),
        one["clocks"]["operating"], {"ok": 0, "warn": 1, "stale": 2, "error": 3}[one["state"]],
    ]  # fmt: skip
    return [float(np.float32(float(value))) for value in row]


def is_right(series: FigureSeries, reports: Sequence[dict[str, Any]]) -> None:
    """Assert that each span of a series says what plain loops over its reports do."""
    by_time = {one["time"]: values(one) for one in reports}
    for i, start in enumerate(series.times.tolist()):
        inside = [row for time, row in by_time.items() if start <= time < start + max(series.width, 1)]
        assert inside
        for j in range(len(FIGURES)):
            known = [row[j] for row in inside if not math.isnan(row[j])]
            assert series.number[i, j] == len(known)
            if not known:
                assert np.isnan([series.low[i, j], series.mean[i, j], series.high[i, j]]).all()
                continue
            mean = sum(known) / len(known)
            assert (series.low[i, j], series.high[i, j]) == (min(known), max(known))
            assert series.mean[i, j] == mean or math.isclose(series.mean[i, j], mean, rel_tol=1e-6)


def sporadic(count: int, seed: int) -> list[dict[str, Any]]:
    """Reports of some weeks: a minute apart while the robot is on, with nights and a month off."""
    draw, time, found = random.Random(seed), BEGIN, []
    for _ in range(count):
        found.append(report(time, draw))
        time += draw.choice([MINUTE] * 60 + [10 * HOUR, 37 * SECOND, 31 * DAY if draw.random() < 0.05 else MINUTE])
    return found


def test_a_course_is_what_plain_loops_over_all_reports_say(store: Store) -> None:
    reports, draw = sporadic(1500, 1), random.Random(2)
    for first in range(0, len(reports), 700):
        store.save("R", {}, (), reports[first : first + 700])
    whole = store.history("R").figures(points=10_000)
    assert (whole.width, len(whole.times)) == (0, len(reports))
    is_right(whole, reports)
    for points in (2, 3, 10, 100, 1000):
        start, end = sorted(draw.randrange(BEGIN, reports[-1]["time"]) for _ in range(2))
        for window in ((None, None), (start, None), (None, end), (start, end)):
            found = store.history("R").figures(*window, points=points)
            assert len(found.times) <= points
            is_right(found, [one for one in reports if (window[0] or 0) <= one["time"] < (window[1] or 2**63)])
    assert len(store.history("R").figures(BEGIN + 1, BEGIN + 2).times) == 0
    assert len(store.history("nobody").figures().times) == 0


def test_long_windows_are_answered_by_coarser_levels(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robophm.stores.pyramid.MOST_ROWS", 100)
    reports = [report(BEGIN + i * MINUTE) for i in range(3000)]
    store.save("R", {}, (), reports)
    widths = {}
    for minutes in (90, 900, 3000):
        found = store.history("R").figures(BEGIN, BEGIN + minutes * MINUTE, points=1000)
        widths[minutes] = found.width
        is_right(found, reports)
        assert found.number[:, 0].sum() >= minutes  # the spans at both ends reach beyond the window
    assert widths == {90: 0, 900: 10 * MINUTE, 3000: HOUR}


def drawn_signal(days: int, seed: int) -> tuple[list[dict[str, Any]], dict[int, float]]:
    """Reports, four a day with days without any, and the values of a signal in them; some are missing."""
    draw, reports, values = random.Random(seed), [], {}
    for i in range(days * 4):
        time = BEGIN + i * 6 * HOUR
        if i % 12 > 9:
            continue
        said = {"/t.x": draw.gauss(20, 5)} if draw.random() < 0.9 else {}
        reports.append(report(time, draw, signals=said))
        values |= dict.fromkeys([time] if said else [], float(np.float32(said.get("/t.x", 0))))
    return reports, values


def test_the_course_of_a_signal_is_what_plain_loops_say_and_grows_coarse_with_age(store: Store) -> None:
    reports, values = drawn_signal(500, 7)
    for first in range(0, len(reports), 3000):
        store.save("R", {}, (), reports[first : first + 3000])
    history, newest = store.history("R"), reports[-1]["time"] // DAY * DAY
    if not history.signals():
        with pytest.raises(StoreError, match="keeps no courses of signals"):
            history.course("/t.x")
        return
    assert (history.signals(), store.history("other").signals()) == (["/t.x"], [])
    widths = {}
    for age in (10, 31, 32, 366, 367, 490):
        found = history.course("/t.x", newest - age * DAY, newest - (age - 1) * DAY, 10_000)
        widths[age] = found.width
        begins = found.times.tolist()
        for i, begin in enumerate(begins):
            inside = [one for time, one in values.items() if begin <= time < begin + max(found.width, 1)]
            assert (found.number[i, 0], found.low[i, 0], found.high[i, 0]) == (len(inside), min(inside), max(inside))
            assert found.mean[i, 0] == pytest.approx(sum(inside) / len(inside), rel=1e-6)
        told = [time for time in values if newest - age * DAY <= time < newest - (age - 1) * DAY]
        assert found.number.sum() == len(told)
    assert widths == {10: 0, 31: 0, 32: 10 * MINUTE, 366: 10 * MINUTE, 367: HOUR, 490: HOUR}
    assert store.upkeep().faults() == []


def test_a_signal_is_brought_back_too_whatever_was_let_go_of(store: Store) -> None:
    if type(store).bring_back is Store.bring_back:
        pytest.skip("this store cannot be brought back")
    reports, values = drawn_signal(120, 8)
    store.save("R", {}, (), reports)
    for days in (100, 30):  # to within what is kept of every report, then to before it
        last = BEGIN + days * DAY + 4 * HOUR
        store.bring_back("R", {}, last)
        found = store.history("R").course("/t.x", points=10_000)
        assert store.upkeep().faults() == []
        assert last - DAY <= found.times[-1] <= last
        again = [one for one in reports if last < one["time"] <= last + 3 * DAY]
        store.save("R", {}, (), again)
        assert store.upkeep().faults() == []
        told = store.history("R").course("/t.x", last + 1, last + 3 * DAY + 1, 1000)
        assert told.mean[:, 0].tolist() == [values[one["time"]] for one in again if one["time"] in values]


def test_a_store_that_is_made_anew_has_all_of_a_signal_that_was_kept(tmp_path: Path) -> None:
    """Also of the time of which only spans were kept: nothing is left there to work them out from."""
    path = tmp_path / "past.db"
    reports, _ = drawn_signal(60, 9)
    with SqliteStore(path) as store:
        store.save("R", {"age": 1}, (), reports)
        before = store.history("R").course("/t.x", points=10_000)
    with closing(sqlite3.connect(path)) as base, base:
        base.execute("UPDATE kept_report SET body = x'00' WHERE time = ?", (reports[-1]["time"],))
    assert restore_store(path)
    with SqliteStore(path) as store:
        assert store.upkeep().faults() == []
        after = store.history("R").course("/t.x", points=10_000)
    assert after.times.tolist() == before.times.tolist()
    for one, other in zip(before[1:], after[1:], strict=True):
        np.testing.assert_array_equal(one, other)


def test_of_more_signals_than_are_kept_it_is_the_first(store: Store) -> None:
    store.save("R", {}, (), [report(BEGIN, signals={f"/s.{i:03}": 1.0 * i for i in range(70)})])
    assert store.history("R").signals() in ([], [f"/s.{i:03}" for i in range(64)])


@pytest.mark.parametrize("points", [0, 1, 10_001, 2.5, None])
def test_a_number_of_points_that_is_none_is_refused(store: Store, points: Any) -> None:
    with pytest.raises(RobophmError, match=r"points .*: expected a whole number of at least 2 and at most 10000"):
        store.history("R").figures(points=points)


def same(one: Store, other: Store) -> None:
    """Assert that two stores have the same history of R."""
    assert list(one.history("R").reports()) == list(other.history("R").reports())
    assert one.history("R").events() == other.history("R").events()
    first, last = one.history("R").figures().times[[0, -1]].tolist()
    for days in (0.01, 1, 10, 400):
        for end in (first + round(days * DAY), last + 1):
            for a, b in zip(
                *(store.history("R").figures(end - round(days * DAY), end) for store in (one, other)), strict=True
            ):
                np.testing.assert_array_equal(a, b)


def test_how_it_was_saved_makes_no_difference(store: Store) -> None:
    """One by one, in batches, out of order, corrected later: what is kept is the same."""
    reports = sporadic(1500, 3)
    with open_store("memory:") as at_once:
        at_once.save("R", {}, (), reports)
        done = 0
        while done < len(reports):
            size = 1 + done % 37
            store.save("R", {}, (), reports[done : done + size])
            done += size
        same(store, at_once)
        store.save("R", {}, (), [report(one["time"]) for one in reports[-20:]])
        store.save("R", {}, (), reports[:-21:-1])
        same(store, at_once)


def test_what_came_after_a_time_can_be_taken_back(store: Store) -> None:
    reports = sporadic(900, 4)
    restart = [Event(one["time"], "restart", "", "again") for one in reports[::100]]
    last = reports[499]["time"]
    store.save("R", {}, (), reports, restart)
    kept = list(store.history("R").reports())
    if type(store).bring_back is Store.bring_back:
        with pytest.raises(StoreError, match="cannot be brought back to a time"):
            store.bring_back("R", {"n": 1}, last)
        return
    store.bring_back("R", {"n": 1}, last)
    found = store.history("R").figures(points=10_000)
    assert found.times.tolist() == [one["time"] for one in reports[:500]]
    for points in (5, 50):
        is_right(store.history("R").figures(points=points), reports[:500])
    assert store.history("R").events() == restart[:5]
    assert list(store.history("R").reports()) == [one for one in kept if one["time"] <= last]


def test_whole_reports_are_thinned_as_docs_say_and_figures_are_not(store: Store) -> None:
    """All of the last day, one an hour of the last 31 days, one a day before."""
    reports = [report(BEGIN + i * 20 * MINUTE) for i in range(72 * 34)]  # thirty-four days
    for first in range(0, len(reports), 500):
        store.save("R", {}, (), reports[first : first + 500])
    newest = reports[-1]["time"]
    expected = [one["time"] for one in reports]
    for age, span in ((DAY, HOUR), (31 * DAY, DAY)):
        before = [None, *(time // span for time in expected)]
        expected = [
            time for time, last in zip(expected, before, strict=False)
            if newest - time <= age or time // span != last
        ]  # fmt: skip
    kept = list(store.history("R").reports())
    assert [one["time"] for one in kept] == expected
    assert kept[0] == reports[0]
    assert kept[-1] == reports[-1]
    assert store.history("R").figures(points=10_000).times.tolist() == [one["time"] for one in reports]
    for asked in (0, BEGIN, BEGIN + 5 * DAY + 1, newest, newest + DAY):
        found = store.history("R").report_at(asked)
        assert found
        assert found["time"] == max((time for time in expected if time <= asked), default=expected[0])
    assert store.history("nobody").report_at(BEGIN) is None


def told(time: int, *, breaches: Sequence[str] = (), flags: Sequence[str] = (), design: str = "a") -> dict[str, Any]:
    arm = {"kind": "module", "path": "arm", "breaches": [], "flags": list(flags)}
    return report(
        time, design_hash=design, subjects=[{"kind": "robot", "path": "R", "breaches": list(breaches)}, arm]
    )  # fmt: skip


def test_a_silence_is_dated_to_when_the_signal_was_heard_last(store: Store) -> None:
    silent = told(BEGIN + 9, flags=["stale /t.x", "stale /never.y"]) | {"silent": {"/t.x": BEGIN + 4, "/never.y": None}}
    store.save("R", {}, (), [told(BEGIN), silent])
    assert [event[:3] for event in store.history("R").events()] == [
        (BEGIN + 4, "silence", "/t.x"), (BEGIN + 9, "silence", "/never.y"),
    ]  # fmt: skip


def test_events_are_told_from_what_changes_and_are_kept_for_ever(store: Store) -> None:
    quiet = [report(BEGIN + 400 * DAY + i * DAY) for i in range(3)]
    store.save("R", {}, (), [told(BEGIN), told(BEGIN + 1, breaches=["hazard rate 2e-05 /h is above 1e-05 /h"])])
    store.save(
        "R", {}, (), [told(BEGIN + 2, breaches=["hazard rate 3e-05 /h is above 1e-05 /h"], flags=["stale /t.x"])]
    )
    ledger = {
        "services": [[BEGIN + 4, "arm/motor", "replaced", True, [1, 1, 1], [0, 0, 0]]],
        "changes": [[BEGIN + 5, "arm/fan", "removed", ""]],
    }
    store.save("R", ledger, (), [told(BEGIN + 3, design="b")], [Event(BEGIN + 6, "restart", "", "begun again")])
    store.save("R", ledger, (), quiet)
    assert [event[:3] for event in store.history("R").events()] == [
        (BEGIN + 1, "breach", "hazard rate"),
        (BEGIN + 2, "silence", "/t.x"),
        (BEGIN + 3, "breach ended", "hazard rate"),
        (BEGIN + 3, "design change", ""),
        (BEGIN + 3, "silence ended", "/t.x"),
        (BEGIN + 4, "replacement", "arm/motor"),
        (BEGIN + 5, "design change", "arm/fan"),
        (BEGIN + 6, "restart", ""),
        (BEGIN + 400 * DAY, "design change", ""),
    ]
    assert store.history("R").events()[0].said == "hazard rate 2e-05 /h is above 1e-05 /h"
    assert [event.time for event in store.history("R").events(BEGIN + 1, BEGIN + 3)] == [BEGIN + 1, BEGIN + 2]
    assert [event.time for event in store.history("R").events(end=BEGIN + 6, most=2)] == [BEGIN + 4, BEGIN + 5]
    assert store.history("S").events() == []


def test_alarms_of_the_log_are_among_the_events(store: Store) -> None:
    draw = random.Random(8)
    store.save(
        "R", {}, (), [report(BEGIN)], [Event(draw.randrange(100), "restart", str(i), "begun") for i in range(40)]
    )
    log = store.alarm_log("R")
    log.keep([
        alarm(f"hot {i}", begin, draw.choice([None, begin, begin + draw.randrange(50)]), cause=f"λ {i}", ended_by="ok")
        for i in range(60) for begin in [draw.randrange(100)]
    ])  # fmt: skip
    every = [(e.time, e.kind, e.subject, e.said) for e in store.history("R").events() if e.kind == "restart"]
    assert len(every) == 40
    for one in log.alarms():
        every.append((one["begin"], "alarm", one["what"], one["cause"]))
        if one["end"] is not None:
            every.append((one["end"], "alarm ended", one["what"], "ok"))
    every.sort()
    windows = [(None, None), (20, None), (None, 70), (20, 70), (5, 6)]
    for (start, end), most in product(windows, (0, 1, 2, 9, 40, 500)):
        inside = []
        for one in every:
            if (start is None or one[0] >= start) and (end is None or one[0] < end):
                inside.append(one)
        while len(inside) > most:
            del inside[0]
        assert [tuple(event) for event in store.history("R").events(start, end, most)] == inside
    beside = AlarmsInMemory()
    beside.keep(log.alarms())
    assert beside.events(20, 70, 9) == log.events(20, 70, 9)
    log.acknowledge(3, "Ada", 77)
    assert [tuple(event) for event in store.history("R").events()] == every
    assert store.history("S").events() == []


# Stores of before.

OLD_TABLES = """
CREATE TABLE ledger (robot TEXT PRIMARY KEY, revision INTEGER NOT NULL, state TEXT NOT NULL) STRICT;
CREATE TABLE progress (
    robot TEXT NOT NULL, recording TEXT NOT NULL, position INTEGER NOT NULL, complete INTEGER NOT NULL,
    notes TEXT NOT NULL, PRIMARY KEY (robot, recording)
) STRICT;
CREATE TABLE report (
    robot TEXT NOT NULL, time INTEGER NOT NULL, body TEXT NOT NULL, PRIMARY KEY (robot, time)
) STRICT, WITHOUT ROWID;
PRAGMA user_version = 2;
"""
LEDGER = {"services": [[BEGIN, "arm/motor", "replaced", False, [1, 1, 1], [0, 0, 0]]]}


def of_before(path: Path, bodies: dict[int, str]) -> None:
    """A store as version 2 made it."""
    with closing(sqlite3.connect(path)) as base, base:
        base.executescript(OLD_TABLES)
        base.execute("INSERT INTO ledger VALUES ('R', 5, ?)", (json.dumps(LEDGER),))
        base.execute("""INSERT INTO progress VALUES ('R', 'drive', 7, 1, '{"a note": 2}')""")
        for robot in ("R", "S"):
            base.executemany(f"INSERT INTO report VALUES ('{robot}', ?, ?)", bodies.items())


def test_a_store_of_version_2_becomes_what_it_would_be_now(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    reports = sporadic(1800, 5)
    path = tmp_path / "robots.db"
    of_before(path, {one["time"]: json.dumps(one) for one in reports})
    large = path.stat().st_size
    monkeypatch.setattr("robophm.stores.migration.SAID_EVERY", 1000)
    with SqliteStore(path) as store, open_store("memory:") as now:
        now.save("R", LEDGER, (), reports)
        same(store, now)
        assert store.progress("R", "drive")[1:] == (7, True, {"a note": 2})
        assert store.ledger("R") == LEDGER
        assert store.history("S").figures().times.tolist() == now.history("R").figures().times.tolist()
        store.save("R", {"n": 1})
    assert caplog.messages == [
        f"a store of version 2 becomes one of version 4: {n} of 3600 reports" for n in (1000, 2300, 3300)
    ]
    assert path.stat().st_size < large
    with SqliteStore(path) as store:
        assert len(caplog.messages) == 3
        assert store.ledger("R") == {"n": 1}


def test_a_store_of_version_2_that_cannot_be_read_stays_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "robots.db"
    of_before(path, {BEGIN: json.dumps(report(BEGIN)), BEGIN + 1: '{"time": 1'})
    with pytest.raises(StoreError, match="expected a robophm store that can be read and written"):
        SqliteStore(path)
    with closing(sqlite3.connect(path)) as base:
        assert base.execute("PRAGMA user_version").fetchone() == (2,)
        assert base.execute("SELECT count(*) FROM report").fetchone() == (4,)
        names = {name for (name,) in base.execute("SELECT name FROM sqlite_schema WHERE type = 'table'")}
    assert names == {"ledger", "progress", "report"}


def test_a_past_is_read_at_one_moment_while_another_saves_it(tmp_path: Path) -> None:
    """Rows and the sums that tell whether all are there belong together, whoever saves between two looks."""
    path, over = tmp_path / "past.db", threading.Event()

    def save() -> None:
        with SqliteStore(path) as writing:
            for number in range(1_000_000):
                if over.is_set():
                    return
                writing.save("r", {"version": number}, reports=[report(BEGIN + number * 5 * HOUR)])

    with SqliteStore(path) as reading, ThreadPoolExecutor(1) as pool:
        writer = pool.submit(save)
        try:
            seen = 0
            until = time.monotonic() + 60
            while seen < 100 and time.monotonic() < until:
                ledger = reading.ledger("r")
                seen += ledger is not None
                reading.history("r").figures()
        finally:
            over.set()
        writer.result()
    assert seen == 100
