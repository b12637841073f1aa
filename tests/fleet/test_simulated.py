"""Simulated robots tell a fleet what they went through, beside the files that the simulator itself writes of them."""

from __future__ import annotations

import csv
import json
import time
from collections import Counter
from itertools import pairwise
from pathlib import Path

import pytest
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.design.file import load
from robophm.fleet.experience import experience
from robophm.fleet.questions import present, reports, status
from robophm.simulation.fleet import simulate
from robophm.stores.outbox import COLUMNS

DESIGN = Path(__file__).parents[2] / "examples" / "fleet" / "robot.yaml"
SEED, ROBOTS, TASKS = 69, 2, 6
TELL = {"Mobility/Motor Front", "Mobility/Motor Rear"}
"""The parts of this design that say when they fail."""
OTHERS = {"Power/Converter/corrosion"}
"""Modes that are renewed with their part, which failed by another."""


def said(*words, code=0):
    done = CliRunner().invoke(app, ["fleet", "simulate", str(DESIGN), *map(str, words)])
    assert done.exit_code == code, (done.output, done.exception)
    return done.stdout if not code else str(done.exception)


def path_of(row):
    """The path of the failure mode of a row of what truly happened."""
    return "/".join(filter(None, (row["part"], row["mode"])))


def rows_of(path):
    with path.open(encoding="utf-8", newline="") as stream:
        return [*csv.DictReader(stream)]


def hours_on(recording, until):
    """The hours for which a recording says that the robot is on, up to a time [s]."""
    rows = [(float(row["time"]), row["/power.on"]) for row in rows_of(recording)]
    return sum((min(later, until) - min(at, until)) / 3600 for (at, on), (later, _) in pairwise(rows) if on == "1")


def test_robots_that_really_fail_report_over_the_wire(fleet, store, tmp_path):
    begun = time.time_ns()
    found = json.loads(said("--store", fleet.path, "--fleet", fleet.address, "--robots", ROBOTS, "--tasks", TASKS,
                            "--every", "16 h", "--seed", SEED, "--json"))  # fmt: skip
    simulate(DESIGN, tmp_path / "truth", ROBOTS, TASKS, SEED)
    truth = rows_of(tmp_path / "truth" / "failures.csv")
    assert [one["robot"] for one in found["robots"]] == [f"simulated-{SEED}-{at}" for at in (1, 2)]
    assert {"", "chip"} <= {one["mode"] for one in truth if one["event"] == "replaced"}, "also one of several modes"
    assert any(one["event"] == "failed" and one["part"] in TELL for one in truth), "and a part that says so fails"
    for at, (robot, now) in enumerate(zip(found["robots"], status(store), strict=True), 1):
        own = [row for row in truth if row["robot"] == f"robot-{at}"]
        assert [(one["part"], one["what"]) for one in robot["events"]] == [(row["part"], row["event"]) for row in own]
        times, other = ([float(one) for one in each] for each in
                        ([one["time"] / 1e9 for one in robot["events"]], [row["time"] for row in own]))  # fmt: skip
        assert [one - times[0] for one in times] == pytest.approx([one - other[0] for one in other], abs=1e-6)
        (over,) = (one["time"] for one in robot["events"] if one["what"] == "end")
        assert begun <= over <= time.time_ns()
        there = [*reports(store, robot["robot"])]
        assert (now.robot, now.reports, now.missing, now.refused) == (robot["robot"], len(there), 0, {})
        assert [one.time for one in there] == sorted(one.time for one in there)
        assert there[-1].time <= over
        moved = over / 1e9 - next(float(row["time"]) for row in own if row["event"] == "end")
        on = hours_on(tmp_path / "truth" / "recordings" / f"robot-{at}.csv", there[-1].time / 1e9 - moved)
        assert there[-1].figures[COLUMNS.index("operating")] == pytest.approx(on)
        services = json.loads(present(store, robot["robot"])[0])["services"]
        said_so = [(mode.partition(" (")[0], kind) for _, mode, kind, *_ in services]
        assert [one for one in said_so if one[0] not in OTHERS] == [
            (path_of(row), row["event"]) for row in own
            if row["event"] == "replaced" or (row["event"] == "failed" and row["part"] in TELL)
        ]  # fmt: skip
    (learned,) = experience(store, [load(DESIGN)]).designs
    for at, robot in enumerate(learned.robots, 1):
        own = [row for row in truth if row["robot"] == f"robot-{at}"]
        over = [row["event"] for row in own].index("end")
        seen = Counter(
            path_of(row) for row in own[:over] if row["event"] == ("failed" if row["part"] in TELL else "replaced")
        )
        assert {one.mode.path: one.failures for one in robot.seen if one.failures} == seen
    assert "already; expected another --seed" in said("--store", fleet.path, "--fleet", fleet.address, "--robots", 1,
                                                      "--tasks", 1, "--seed", SEED, code=1)  # fmt: skip


def test_a_service_that_is_not_there_is_said(store, tmp_path):
    answer = said("--store", store.place, "--fleet", "http://127.0.0.1:9", "--robots", 1, "--tasks", 1, code=1)
    assert "fleet http://127.0.0.1:9: is not reached" in answer
    words = "--store", store.place, "--fleet", "http://127.0.0.1:9", "--every", "0 s"
    assert "expected a second or more" in said(*words, code=1)
