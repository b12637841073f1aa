"""Failures that robots promised over thirty days, against those noted: each robot by hand."""

from __future__ import annotations

import json
import math
import time

import pytest
from scipy.stats import poisson
from tests.fleet.test_experience import lived
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import DataError
from robophm.core.signal import DAY, HOUR
from robophm.design.file import parse
from robophm.fleet.calibration import calibrate
from robophm.fleet.page.proposed import proposal_page
from robophm.fleet.payload import Payload, PresentState, Report
from robophm.fleet.proposals import proposals
from robophm.fleet.store import FleetStore
from robophm.health.service import ServiceNote, take_note
from robophm.stores.outbox import COLUMNS

DESIGN = """
schema_version: 1
name: courier
components:
  motor: {rate: 0.002 /h}
  eye: {rate: 0.001 /h}
  ear: {rate: 0.001 /h}
diagram: {series: [motor, {parallel: [eye, ear]}]}
"""
RATE = 0.002
"""The hazard rate that robots promise [1/h]; each report is an hour after the one before."""
NOW = time.time_ns() // HOUR * HOUR


def tell(store, name, site, robot, begun, failures=(), note="motor", now=NOW):
    """Reports of every hour since some days ago, the probability of having failed falling to 0 at each failure."""
    ledger, newest = lived(robot), now - begun * DAY
    for at in failures:
        ledger.integrated_to = now - at * DAY + HOUR // 2
        take_note(robot, ledger, ServiceNote(note, failed=True))
    rows, last = [], newest
    for seq in range(1, begun * 24 + 2):
        at = now - begun * DAY + (seq - 1) * HOUR
        last = max([newest, *(one.time for one in ledger.services if one.time < at)])
        figures = [math.nan] * len(COLUMNS)
        for view in ("nominal", "sensor_based"):
            figures[COLUMNS.index(f"unreliability.{view}")] = -math.expm1(-RATE * (at - last) / HOUR)
        rows.append(Report(seq, at, 0, tuple(figures)))
    store.add_token(name, site)
    present = PresentState(1, json.dumps(ledger.to_json()),
                           {"robot": robot.name, "design_hash": "d1", "time": now}, ())  # fmt: skip
    for first in range(0, len(rows), 500):
        some = tuple(rows[first : first + 500])
        store.commit([Payload(name, "a" * 16, time.time_ns(), 0, some, present)])


@pytest.fixture
def robot():
    return parse(DESIGN)


@pytest.fixture
def store(tmp_path, robot):
    with FleetStore(tmp_path / "fleet.db", make=True) as opened:
        yield opened


def test_last_month_by_hand(store, robot):
    """Of 40 days the last 30 count, less the report with which they begin; the hour in which a part was served is of
    nobody; eyes do not stop a robot."""
    tell(store, "r1", "Kiel", robot, 40, failures=(35, 3))
    tell(store, "r2", "Kiel", robot, 10)
    tell(store, "r3", "Bern", robot, 10, failures=(4, 2), note="eye")
    store.add_token("silent")
    found = calibrate(store, [robot], "site")
    (bern, kiel) = found.cohorts
    assert (kiel.cohort, kiel.robots, kiel.counted.noted) == ("Kiel", 2, 1)
    assert kiel.counted.promised == pytest.approx(RATE * (30 * 24 - 1 - 1 + 10 * 24), rel=1e-5)
    assert (bern.robots, bern.counted.noted) == (1, 0)
    assert bern.counted.promised == pytest.approx(RATE * (10 * 24 - 2), rel=1e-5)
    assert (found.robots, found.together.noted) == (3, 1)
    assert found.not_told == {"silent": "has sent no ledger yet"}


def test_a_site_that_fails_too_often_is_told(store, robot):
    for at in range(4):
        tell(store, f"b{at}", "Bern", robot, 10, failures=(8, 5, 2))
        tell(store, f"k{at}", "Kiel", robot, 10)
    bern, kiel = calibrate(store, [robot], "site").cohorts
    promised = 4 * RATE * (10 * 24 - 3)
    assert bern.counted.chance == pytest.approx(2 * poisson.sf(11, promised), rel=1e-3)
    assert (bern.chance, bern.rejected) == (pytest.approx(2 * bern.counted.chance), True)  # the lesser of two
    assert not kiel.rejected


def test_what_does_not_tell_is_said(store, robot):
    unknown = parse(DESIGN.replace("motor: {rate: 0.002 /h}", "motor: {rate: unknown}").replace("courier", "picker"))
    tell(store, "p", None, unknown, 2)
    with pytest.raises(DataError, match="no robot of picker has promised anything that can be counted"):
        calibrate(store, [unknown], "site")
    tell(store, "r", None, robot, 2)
    tell(store, "brief", None, robot, 0)
    found = calibrate(store, [robot, unknown], "design")
    assert [one.cohort for one in found.cohorts] == ["courier"]
    assert found.not_told["p"] == "has parts of unknown rate in its figures"
    assert "fewer than two reports" in found.not_told["brief"]


def test_as_people_ask(store, robot, tmp_path):
    tell(store, "r", None, robot, 2)
    (tmp_path / "robot.yaml").write_text(DESIGN)
    words = ["fleet", "calibrate", str(tmp_path / "robot.yaml"), "--store", store.place]
    text = CliRunner().invoke(app, words).stdout
    assert "Promises of the last 30 days" in text
    assert "nothing against it" in text
    said = json.loads(CliRunner().invoke(app, [*words, "--by", "year", "--json"]).stdout)
    assert said["cohorts"][0]["promised"] == pytest.approx(RATE * 48, rel=1e-5)


def test_a_proposal_says_how_the_design_before_it_has_kept_its_promises(store, robot, tmp_path):
    tell(store, "r", "Kiel", robot, 10, failures=(8, 7, 6, 5, 4, 3, 2, 1))
    (tmp_path / "robot.yaml").write_text(DESIGN)
    words = ["fleet", "propose", str(tmp_path / "robot.yaml"), "--store", store.place]
    done = CliRunner().invoke(app, words)
    assert "Site Kiel: 0.464 failures promised in 30 days, 8 noted" in done.stdout
    assert "which does not hold" in done.stdout
    assert "Promises of the last 30 days" in proposal_page(proposals(store)[0])
