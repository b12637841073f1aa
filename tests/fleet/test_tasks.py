"""Tasks for robots of different age, by the ledgers that they sent: each probability in closed form."""

from __future__ import annotations

import json
import math
import sqlite3
import time
from contextlib import closing
from itertools import permutations

import numpy as np
import pytest
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import RobophmError
from robophm.design.file import parse
from robophm.design.task import Leg, Task
from robophm.fleet.payload import Payload, PresentState
from robophm.fleet.store import FleetStore
from robophm.fleet.tasks import assign_tasks, candidates, log_completions
from robophm.health.ledger import Ledger

DESIGN = """
schema_version: 1
name: courier
components:
  motor: {life: {distribution: weibull, scale: 100 h, shape: 2}}
  arm: {rate: 0.001 /h}
functions: {drive: {series: [motor]}, pick: {series: [arm]}}
"""
AGES = {"old": 80.0, "middle": 30.0, "new": 0.0}
TASKS = [Task((Leg(8.0),), "long"), Task((Leg(2.0, functions=("drive",)),), "short"),
         Task((Leg(50.0, functions=("pick",)),), "at the shelf")]  # fmt: skip


def chance(age, task):
    """P(the task is completed | the robot works at its start): Weibull of shape 2, and exponential."""
    (leg,), fails = task.legs, 0.0
    if leg.functions != ("pick",):
        fails += ((age + leg.duration) ** 2 - age**2) / 100.0**2
    if leg.functions != ("drive",):
        fails += 0.001 * leg.duration
    return math.exp(-fails)


@pytest.fixture
def robot():
    return parse(DESIGN)


@pytest.fixture
def store(tmp_path, robot):
    with FleetStore(tmp_path / "fleet.db", make=True) as opened:
        for name, age in AGES.items():
            ledger = Ledger.new(robot)
            gained = np.array([age if key.startswith("motor") else 0.0 for key in ledger.modes])
            ledger.age.add(gained)
            ledger.effective.add(gained)
            send(opened, name, ledger, robot.design_hash)
        send(opened, "other", Ledger.new(robot), "another")
        opened.add_token("silent")
        yield opened


def send(store, name, ledger, digest):
    said(store, name, json.dumps(ledger.to_json()), digest)


def said(store, name, text, digest):
    """Whatever text a robot sends in place of its ledger."""
    store.add_token(name)
    report = {"robot": "courier", "design_hash": digest, "time": 10**18}
    state = PresentState(1, text, report, ())
    store.commit([Payload(name, "a" * 16, time.time_ns(), 0, (), state)])


def test_probabilities_are_those_of_each_robots_own_past(store, robot):
    found = candidates(store, robot, TASKS)
    assert [one.robot for one in found.robots] == ["middle", "new", "old"]
    assert found.left_out == {"other": "is of another version of courier", "silent": "has sent no ledger yet"}
    logs = log_completions(found.robots, len(TASKS))
    for one, row in zip(found.robots, logs, strict=True):
        assert np.exp(row) == pytest.approx([chance(AGES[one.robot], task) for task in TASKS], rel=1e-9)


def test_the_best_of_all_ways_is_taken_and_why(store, robot):
    found = assign_tasks(candidates(store, robot, TASKS).robots, TASKS)
    ways = {order: math.prod(chance(AGES[name], task) for name, task in zip(order, TASKS, strict=True))
            for order in permutations(AGES)}  # fmt: skip
    best = max(ways, key=ways.__getitem__)
    assert tuple(one.robot for one in found.assigned) == best == ("new", "middle", "old")
    assert found.all_completed == pytest.approx(ways[best], rel=1e-9)
    assert found.any_failure == pytest.approx(1 - ways[best], rel=1e-6)
    long, short, shelf = found.assigned
    assert (long.decided_by, short.decided_by, shelf.decided_by) == ("arm", "motor", "arm")
    assert (short.likeliest, long.likeliest) == ("new", "new")  # who is needed for the long one
    assert short.likeliest_completion == pytest.approx(chance(0.0, TASKS[1]))
    assert found.unassigned == []


def test_nobody_goes_below_the_least_that_is_accepted(store, robot):
    found = assign_tasks(candidates(store, robot, TASKS).robots, TASKS, least=0.96)
    assert [(one.task, one.robot) for one in found.assigned] == [(0, "new"), (1, "middle")]
    assert found.unassigned == [2]


def test_robots_that_are_free_are_named(store, robot):
    found = assign_tasks(candidates(store, robot, TASKS, {"old"}).robots, TASKS)
    assert [one.robot for one in found.assigned] == ["old"]
    assert len(found.unassigned) == 2
    with pytest.raises(RobophmError, match="no robot 'midle'; did you mean 'middle'"):
        candidates(store, robot, TASKS, {"midle"})


def test_whoever_sends_no_ledger_is_named_and_stops_nobody(store, robot, tmp_path):
    true = Ledger.new(robot).to_json()
    sums = {"age": [[math.nan] * 2, [0.0] * 2]}
    for name, text in {
        "empty": "{}",
        "numbers": json.dumps({**true, "modes": 7}),
        "texts": json.dumps({**true, "seen": {key: ["x"] * 4 for key in true["modes"]}}),
        "negative": json.dumps({**true, "totals": {**true["totals"], "effective": [[-1e9] * 2, [0.0] * 2]}}),
        "nan": json.dumps({**true, "totals": {**true["totals"], **sums}}),
        "never": json.dumps({**true, "started": 10**30, "integrated_to": 10**30, "newest": 10**30}),
    }.items():
        said(store, name, text, robot.design_hash)
    found = candidates(store, robot, TASKS)
    assert [one.robot for one in found.robots] == ["middle", "new", "old"]
    assert {name: why.partition(":")[0] for name, why in found.left_out.items() if name not in ("other", "silent")} == {
        "empty": "ledger version None; expected 2", "numbers": "has sent a ledger that cannot be read",
        "texts": "has sent a ledger that cannot be read", "negative": "has sent a ledger that tells no probability",
        "nan": "has sent a ledger that tells no probability", "never": "has sent a ledger that cannot be read",
    }  # fmt: skip
    with closing(sqlite3.connect(tmp_path / "fleet.db")) as base, base:
        base.execute("UPDATE present SET ledger = ? WHERE robot = ?", (b"x", store.number_of("old")))
    found = candidates(store, robot, TASKS)
    assert [one.robot for one in found.robots] == ["middle", "new"]
    assert "is damaged" in found.left_out["old"]


def test_the_command(store, tmp_path):
    (tmp_path / "robot.yaml").write_text(DESIGN)
    (tmp_path / "tasks.yaml").write_text(
        "schema_version: 1\ntasks:\n  - {name: long, legs: [{duration: 8 h}]}\n"
        "  - {name: short, legs: [{duration: 2 h, functions: [drive]}]}\n"
    )
    words = ["fleet", "assign", tmp_path / "tasks.yaml", "--design", tmp_path / "robot.yaml", "--store", store.place]
    done = CliRunner().invoke(app, [*map(str, words), "--json"])
    assert done.exit_code == 0, done.output
    said = json.loads(done.stdout)
    assert [(one["name"], one["robot"]) for one in said["assigned"]] == [("long", "new"), ("short", "middle")]
    assert said["all_completed"] == pytest.approx(chance(0.0, TASKS[0]) * chance(30.0, TASKS[1]), rel=1e-9)
    assert said["left_out"]["silent"] == "has sent no ledger yet"
    text = CliRunner().invoke(app, [*map(str, words), "--least", "0.99"]).stdout
    assert "Nobody takes: long" in text
    assert "new" in text
