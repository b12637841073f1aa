"""Rates by the ledgers that robots sent: failures, exposure and what was promised, each by hand."""

from __future__ import annotations

import json
import math
import time

import numpy as np
import pytest
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import DataError
from robophm.design.file import parse
from robophm.fleet.experience import experience
from robophm.fleet.payload import Payload, PresentState
from robophm.fleet.store import FleetStore
from robophm.health.ledger import Ledger
from robophm.health.service import ServiceNote, take_note
from robophm.learning.rates.gamma_poisson import update
from robophm.learning.rates.rate_update import learn, unstated

DESIGN = """
schema_version: 1
name: courier
components:
  motor: {life: {distribution: weibull, scale: 100 h, shape: 2}}
  arm: {rate: 0.001 /h, quantity: 2}
  eye: {rate: 0.01 /h}
  ear: {rate: 0.01 /h}
  box: {rate: unknown}
diagram: {series: [motor, arm, {parallel: [eye, ear]}, box]}
"""
YEAR_2025 = 1_750_000_000 * 10**9


def lived(robot, *stretches):
    """A ledger of hours that all parts worked, each stretch ended by what was done to a part."""
    ledger = Ledger.new(robot)
    ledger.started = ledger.integrated_to = YEAR_2025
    for hours, *notes in stretches:
        for total in (ledger.age, ledger.effective):
            total.add(np.full(len(ledger.modes), hours))
        ledger.integrated_to += round(hours * 3600e9)
        for note in notes:
            take_note(robot, ledger, note)
    return ledger


def send(store, name, ledger, design="courier", digest="d1", site=None):
    store.add_token(name, site)
    text = ledger if isinstance(ledger, str) else json.dumps(ledger.to_json())
    report = {"robot": design, "design_hash": digest, "time": 10**18}
    store.commit([Payload(name, "a" * 16, time.time_ns(), 0, (), PresentState(1, text, report, ()))])


NEW = ServiceNote("motor", failed=True)


@pytest.fixture
def robot():
    return parse(DESIGN)


@pytest.fixture
def store(address, robot):
    with FleetStore(address, make=True) as opened:
        send(
            opened,
            "r1",
            lived(robot, (80.0, NEW), (30.0, ServiceNote("motor"), ServiceNote("eye", failed=True)), (20.0,)),
        )
        send(opened, "r2", lived(robot, (60.0, NEW), (0.0, ServiceNote("box", failed=True)), (40.0,)), site="Kiel")
        send(opened, "r3", lived(robot, (500.0,)), digest="d2")
        opened.add_token("silent")
        yield opened


def test_lives_failures_and_what_was_promised_are_those_of_all_robots(store, robot):
    """Motors lived 80 (failed), 30 (replaced in time), 20, 60 (failed), 40 and 500 h."""
    found = experience(store, [robot])
    (one,) = found.designs
    assert [(each.robot, each.origin.site, each.origin.version, each.origin.year) for each in one.robots] == [
        ("r1", None, "d1", "2025"), ("r2", "Kiel", "d1", "2025"), ("r3", None, "d2", "2025"),
    ]  # fmt: skip
    assert found.left_out == {"silent": "has sent no ledger yet"}
    rates = {each.mode.path: each for each in learn(robot, one.seen)}
    assert rates.keys() == {"motor", "arm", "eye", "ear"}
    motor = rates["motor"]
    promised = sum(hours**2 for hours in (80, 30, 20, 60, 40, 500)) / 100.0**2
    assert (motor.failures, motor.exposure) == (2, 730.0)
    assert motor.expected == pytest.approx(promised)
    assert motor.factor == pytest.approx(math.sqrt(update(2, promised, 1.0).estimate))
    arm, eye, ear = (rates[name] for name in ("arm", "eye", "ear"))
    assert (arm.failures, arm.exposure, arm.expected) == (0, 1460.0, pytest.approx(1.46))  # of two in each robot
    assert (eye.failures, ear.failures, eye.exposure, ear.exposure) == (1, 0, 730.0, 730.0)  # though a robot goes on
    assert eye.factor == pytest.approx(update(1, 7.3, 1.0).estimate)
    (box,) = unstated(robot, one.seen)
    assert (box.failures, box.rate) == (1, pytest.approx(1 / 730))


def test_several_designs_are_learned_each_by_its_own_robots(store, robot):
    other = parse(DESIGN.replace("name: courier", "name: picker"))
    send(store, "p1", lived(other, (70.0,)), "picker")
    send(store, "x1", lived(other, (70.0,)), "unheard of")
    both = experience(store, [robot, other])
    assert [[each.robot for each in one.robots] for one in both.designs] == [["r1", "r2", "r3"], ["p1"]]
    assert both.left_out["x1"] == "is of another design, unheard of"
    with pytest.raises(DataError, match="two designs have the same name"):
        experience(store, [robot, robot])


@pytest.mark.parametrize(
    ("ledger", "why"),
    [
        ("{}", "ledger version None; expected"),
        ('{"version": 1, "modes": 7}', "a ledger that cannot be read"),
        ("infinite", "exposure that cannot be"),
        ("new", "has not worked yet"),
    ],
)
def test_what_is_no_ledger_of_work_stops_nobody_elses(tmp_path, robot, ledger, why):
    text = ledger
    if ledger == "new":
        text = json.dumps(Ledger.new(robot).to_json())
    elif ledger == "infinite":
        said = lived(robot, (10.0,)).to_json()
        said["totals"]["age"][0] = [math.inf] * len(robot.modes)
        text = json.dumps(said)
    with FleetStore(tmp_path / "fleet.db", make=True) as store:
        send(store, "good", lived(robot, (10.0,)))
        send(store, "bad", text)
        found = experience(store, [robot])
        assert [one.robot for one in found.designs[0].robots] == ["good"]
        assert why in found.left_out["bad"]


def test_as_people_ask(tmp_path, robot):
    (tmp_path / "robot.yaml").write_text(DESIGN)
    words = ["fleet", "learn", str(tmp_path / "robot.yaml"), "--store", str(tmp_path / "fleet.db")]
    with FleetStore(tmp_path / "fleet.db", make=True) as store:
        done = CliRunner().invoke(app, words)
        assert "no robot of courier has sent a ledger of its work; expected one" in str(done.exception)
        for name in ("r1", "r2"):
            send(store, name, lived(robot, (80.0, NEW), (20.0,)))
    (said,) = json.loads(CliRunner().invoke(app, [*words, "--json"]).stdout)["designs"]
    assert (said["design"], said["robots"]) == ("courier", ["r1", "r2"])
    motor = next(one for one in said["rates"] if one["mode"] == "motor")
    assert (motor["failures"], motor["expected"]) == (2, pytest.approx(2 * (0.64 + 0.04)))
    text = CliRunner().invoke(app, words).stdout
    assert "What the field says of courier, 2 robots" in text
    assert "box: its rate is unknown" in text
