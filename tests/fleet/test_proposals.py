"""Designs that a fleet proposes: their evidence, who took them, and the file letter for letter."""

from __future__ import annotations

import json
import sqlite3
from contextlib import closing

import pytest
from tests.fleet.test_experience import DESIGN, NEW, lived, send
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.core.errors import RobophmError
from robophm.design.file import load, parse
from robophm.fleet.proposals import ACCEPTED, decide, proposals
from robophm.fleet.store import FleetStore
from robophm.health.service import ServiceNote
from robophm.learning.rates.gamma_poisson import update

EYE = ServiceNote("eye", failed=True)
TEXT = DESIGN.replace("eye: {rate: 0.01 /h}", "eye: {rate: 0.01 /h}  # as the maker says")


@pytest.fixture
def design(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(TEXT)
    return path


@pytest.fixture
def place(address):
    """Five robots whose eyes failed twice in 100 h, each in Kiel, and one elsewhere that has gone on."""
    robot = parse(DESIGN)
    with FleetStore(address, make=True) as store:
        for at in range(5):
            send(store, f"r{at}", lived(robot, (40.0, EYE), (40.0, EYE), (20.0,)), site="Kiel")
        send(store, "far", lived(robot, (80.0, NEW), (120.0,)), site="Bern")
    return address


def fleet(*words, code=0):
    done = CliRunner().invoke(app, ["fleet", *map(str, words)])
    assert done.exit_code == code, (done.output, done.exception)
    return done.stdout if not code else str(done.exception)


def test_proposed_accepted_and_rolled_back(place, design):
    made = json.loads(fleet("propose", design, "--store", place, "--json"))
    assert (made["number"], made["state"], made["design"], design.read_text()) == (1, "proposed", "courier", TEXT)
    eye = next(one for one in made["evidence"]["rates"] if one["mode"] == "eye")
    assert (eye["failures"], eye["exposure"], eye["unit"], eye["prior_failures"]) == (10, 700.0, "h", 1.0)
    assert eye["factor"] == pytest.approx(update(10, 7.0, 1.0).estimate)
    added = [line for line in made["diff"].splitlines() if line.startswith("+ ")]
    assert [line.split()[1] for line in added] == ["motor:", "arm:", "eye:", "ear:"]
    assert all("learned: {factor:" in line for line in added)
    assert fleet("accept", 1, design, "--store", place, "--by", "Ada").startswith("Proposal 1 is accepted by Ada")
    taken = design.read_text()
    assert load(design).modes[2].rate == pytest.approx(0.01 * eye["factor"], rel=1e-5)
    assert "# as the maker says" in taken
    assert "is accepted; expected one that is not" in fleet("accept", 1, design, "--store", place, "--by", "B", code=1)
    fleet("roll-back", 1, design, "--store", place, "--by", "Bo", "--json")
    assert design.read_text() == TEXT
    text = fleet("proposals", 1, "--store", place)
    assert "accepted by Ada" in text
    assert "rolled back by Bo" in text
    assert "eye: 10 failures where 7 were expected in 700 h" in text
    assert "rolled back" in fleet("proposals", "--store", place)
    fleet("accept", 1, design, "--store", place, "--by", "Ada")
    assert design.read_text() == taken


def test_of_one_cohort_alone(place, design):
    made = json.loads(fleet("propose", design, "--store", place, "--cohort", "site=Bern", "--json"))
    assert made["evidence"]["robots"] == ["far"]
    assert next(one for one in made["evidence"]["rates"] if one["mode"] == "motor")["failures"] == 1
    assert "did you mean 'Bern'?" in fleet("propose", design, "--store", place, "--cohort", "site=Berne", code=1)
    assert "expected KIND=NAME" in fleet("propose", design, "--store", place, "--cohort", "place=Bern", code=1)


def test_a_later_proposal_takes_the_place_of_one_that_nobody_decided_on(place, design):
    for number in (1, 2):
        assert json.loads(fleet("propose", design, "--store", place, "--json"))["number"] == number
    with FleetStore(place) as store:
        assert [one.number for one in proposals(store)] == [2]
        decide(store, 2, design, "Ada", ACCEPTED)
    assert "nothing to propose" in fleet("propose", design, "--store", place, code=1)
    with FleetStore(place) as store:
        send(store, "new", lived(parse(DESIGN), (500.0,)))
    assert json.loads(fleet("propose", design, "--store", place, "--json"))["number"] == 3
    assert [one["number"] for one in json.loads(fleet("proposals", "--store", place, "--json"))["proposals"]] == [3, 2]


def test_a_design_that_has_changed_since_is_left_as_it_is(place, design):
    fleet("propose", design, "--store", place)
    changed = TEXT.replace("0.001 /h", "0.002 /h")
    design.write_text(changed)
    said = fleet("accept", 1, design, "--store", place, "--by", "Ada", code=1)
    assert "has changed since the proposal was made; expected that design, or a new proposal" in said
    assert design.read_text() == changed
    assert "no proposal 7; expected one of 1 to 1" in fleet("accept", 7, design, "--store", place, "--by", "A", code=1)
    assert "expected the name of who decides" in fleet("accept", 1, design, "--store", place, "--by", " ", code=1)
    with FleetStore(place) as store:
        assert proposals(store)[0].decisions == ()


def test_what_cannot_be_written_is_not_decided(place, design):
    """Where the file cannot be written nobody has decided; where only the decision was lost, asking again goes on."""
    fleet("propose", design, "--store", place)
    with FleetStore(place) as store:
        made = proposals(store)[0]
        folder = design.parent / "gone"
        with pytest.raises(RobophmError):
            decide(store, 1, folder / "robot.yaml", "Ada", ACCEPTED)
        assert proposals(store)[0].state == "proposed"
        design.write_text(made.after)
        assert decide(store, 1, design, "Ada", ACCEPTED).state == ACCEPTED


def test_a_store_of_the_second_version_goes_on(place, design):
    """The tables of version 2 are those of this one without proposals, and without what was moved."""
    if place.startswith("postgresql"):
        psycopg = pytest.importorskip("psycopg")
        with psycopg.connect(place, autocommit=True) as base:
            for one in ("DROP TABLE proposal, decision", "ALTER TABLE epoch DROP COLUMN moved",
                        "UPDATE version SET number = 2"):  # fmt: skip
                base.execute("SET search_path = robophm_fleet")
                base.execute(one)
    else:
        with closing(sqlite3.connect(place)) as base:
            base.executescript("DROP TABLE proposal; DROP TABLE decision; ALTER TABLE epoch DROP COLUMN moved; "
                               "PRAGMA user_version = 2;")  # fmt: skip
    fleet("propose", design, "--store", place)
    fleet("accept", 1, design, "--store", place, "--by", "Ada")
