"""Cohorts of a fleet by the ledgers that robots sent: who is in each, and what is compared."""

from __future__ import annotations

import json

import pytest
from tests.fleet.test_experience import DESIGN, NEW, lived, send
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.design.file import parse
from robophm.fleet.cohorts import cohort_rates, compare
from robophm.fleet.experience import experience
from robophm.fleet.store import FleetStore
from robophm.health.service import ServiceNote
from robophm.learning.rates.gamma_poisson import update

EYE = {"Kiel": 0, "Bern": 9}


@pytest.fixture
def robot():
    return parse(DESIGN)


@pytest.fixture
def store(tmp_path, robot):
    """Eyes fail often in Bern and never in Kiel, each robot has worked 90 h; of one robot no site is stated."""
    eye = ServiceNote("eye", failed=True)
    with FleetStore(tmp_path / "fleet.db", make=True) as opened:
        for site, failures in EYE.items():
            for at in range(6):
                each = (10.0, eye) if failures else (10.0,)
                send(opened, f"{site} {at}", lived(robot, *[each] * 9), site=site)
        send(opened, "anywhere", lived(robot, (80.0, NEW), (10.0,)))
        yield opened


def test_sites_are_compared_by_what_they_went_through(store, robot):
    found = compare(experience(store, [robot]).designs)
    assert {(one.kind, one.mode) for one in found.compared} == {("site", "eye"), ("site", "motor")}
    assert found.never_failed == 2  # arm and ear; the box has no rate to be compared by
    bern = next(one for one in found.compared if (one.mode, one.cohort) == ("eye", "Bern"))
    assert (bern.robots, bern.exposure, bern.found.failures) == (6, 540.0, 54)
    assert bern.stated == pytest.approx(5.4)
    assert bern.found.others.expected == pytest.approx(5.4 * update(0, 5.4, 1.0).estimate)  # by Kiel alone
    assert bern.real
    assert bern.found.times[0] > 5
    first, second, *_ = found.compared  # by Holm the least of four chances counts four times, the next three times
    assert [first.chance, second.chance] == pytest.approx([4 * first.found.chance, 3 * second.found.chance])
    assert not any(one.real for one in found.compared if one.mode == "motor")


def test_rates_of_each_cohort_are_those_of_its_own_robots(store, robot):
    designs = experience(store, [robot]).designs
    rates = {(one.cohort, one.learned.mode.path): one for one in cohort_rates(designs, "site")}
    for site, each in EYE.items():
        one = rates[site, "eye"]
        assert (one.robots, one.learned.failures) == (6, 6 * each)
        assert one.learned.fleet.mean.times == pytest.approx(update(6 * each, 5.4, 1.0).estimate)
    assert {cohort for cohort, _ in rates} == {*EYE}


def test_a_part_of_several_designs_is_compared_where_it_is_the_same(store, robot):
    other = parse(DESIGN.replace("name: courier", "name: picker").replace("rate: 0.001", "rate: 0.002"))
    for at in range(3):
        send(store, f"p{at}", lived(other, (90.0,)), "picker")
    found = compare(experience(store, [robot, other]).designs)
    assert {one.mode for one in found.compared if one.kind == "design"} == {"motor", "eye"}
    assert found.never_failed == 3  # the arms of both designs are two parts, which promise unlike numbers


def test_a_robot_alone_is_no_cohort(store, robot):
    send(store, "far", lived(robot, (10.0,)), site="Oslo")
    found = compare(experience(store, [robot]).designs)
    assert {one.cohort for one in found.compared} == {*EYE}
    assert found.too_few == 2


def test_as_people_ask(store, tmp_path):
    (tmp_path / "robot.yaml").write_text(DESIGN)
    words = ["fleet", "learn", str(tmp_path / "robot.yaml"), "--store", store.place]
    text = CliRunner().invoke(app, [*words, "--by", "site"]).stdout
    assert "By site" in text
    assert "Cohorts that differ" in text
    assert "Of 4 cohorts' parts 2 differ from the others by more than robots do anyway" in text
    said = json.loads(CliRunner().invoke(app, [*words, "--by", "site", "--json"]).stdout)
    assert [one["real"] for one in said["compared"]] == [True, True, False, False]
    assert {one["cohort"] for one in said["cohorts"]} == {*EYE}
    done = CliRunner().invoke(app, [*words, "--by", "sites"])
    assert "--by 'sites': expected design or version or site or year; did you mean 'site'?" in str(done.exception)
