"""The fleet's page: its lists beside plain Python over what was sent, who may look, and in Chromium."""

from __future__ import annotations

import math
import random
import time
from typing import NamedTuple
from urllib.parse import urljoin

import httpx
import pytest
from tests.fleet.conftest import serving
from tests.fleet.test_experience import DESIGN, lived, send
from tests.web.page.conftest import Visit, browser
from typer.testing import CliRunner

from robophm.cli.app import app
from robophm.design.file import parse
from robophm.fleet.page.listing import DAY, Asked, count, groups, lines, totals
from robophm.fleet.payload import Ahead, Payload, PresentState, Report
from robophm.fleet.proposals import ACCEPTED, decide
from robophm.fleet.store import FleetStore
from robophm.health.service import ServiceNote
from robophm.stores.outbox import BOUNDS, COLUMNS
from robophm.web.access.file import AccessFile, access_path
from robophm.web.access.users import Users

__all__ = ["browser"]


@pytest.fixture
def kept(address):
    """A store in each engine, with a robot that has told nothing."""
    with FleetStore(address, make=True) as opened:
        opened.add_token("r")
        yield opened


class Told(NamedTuple):
    """A robot, and all that it has told."""

    name: str
    site: str | None
    design: str | None
    chance: float | None
    before: float | None
    """The same within the week that ends a week before its newest report."""


def figures(chance, bound=0):
    values = dict.fromkeys(COLUMNS, 0.25) | {"failure_within.168": math.nan if chance is None else chance,
                                             "state": 1.0, "bound": float(bound)}  # fmt: skip
    return tuple(values[name] for name in COLUMNS)


def filled(store, number, seed=1):
    """Robots that tell of all kinds of things, and nothing at all."""
    chance, now, told = random.Random(seed), time.time_ns(), []
    for at in range(number):
        site, design = chance.choice([None, "Kiel", "Lyon"]), chance.choice([None, "arm 1", "Cart %_!"])
        name = f"{chance.choice(['Cart', 'arm'])}-{at:03}"
        store.add_token(name, site)
        if chance.random() < 0.1:
            told.append(Told(name, site, None, None, None))
            continue
        now_chance = None if chance.random() < 0.1 else chance.uniform(0, 0.9)
        days = sorted(chance.sample(range(1, 20), chance.randint(0, 4)), reverse=True)
        past = [(ago, chance.uniform(0, 0.9)) for ago in days]
        reports = [Report(seq, now - ago * DAY, 0, figures(value)) for seq, (ago, value) in enumerate(past, 1)]
        reports.append(Report(len(past) + 1, now, 0, figures(now_chance)))
        whole = None if design is None else {"robot": design, "design_hash": "d", "time": now}
        state = PresentState(1, "{}", whole, (Ahead(168.0, now_chance or 0.0, "motor", 0.5),))
        store.commit([Payload(name, "a" * 16, now, 0, tuple(reports), state)])
        before = next((value for ago, value in reversed(past) if 7 <= ago <= 14), None)
        told.append(Told(name, site, design, now_chance, before if now_chance is not None else None))
    return told


def test_lists_are_those_of_plain_python(kept):
    """In both engines: order, search, filters, pages, and the report of a week before."""
    told = [*filled(kept, 60), Told("r", None, None, None, None)]
    known = sorted((one for one in told if one.chance is not None), key=lambda one: -one.chance)
    found = lines(kept, Asked(), 0, 1000)
    assert [(one.robot, one.site, one.design) for one in found] == [(one.name, one.site, one.design) for one in known]
    assert [one.chance for one in found] == [one.chance for one in known]
    assert [one.before for one in found] == [one.before for one in known]
    assert {one.first for one in found if one.design} == {"motor"}
    assert [one for at in range(0, len(known), 7) for one in lines(kept, Asked(), at, 7)] == found

    risen = sorted((one for one in known if one.before is not None), key=lambda one: one.before - one.chance)
    assert len(risen) > 5
    assert [one.robot for one in lines(kept, Asked(order="risen"), 0, 1000)] == [one.name for one in risen]
    unknown = sorted(one.name for one in told if one.chance is None)
    assert sorted(one.robot for one in lines(kept, Asked(order="unknown"), 0, 1000)) == unknown

    for search, holds in (("ART-0", lambda one: "art-0" in one.name.lower()), ("_", lambda one: False)):
        expected = [one.name for one in known if holds(one)]
        assert [one.robot for one in lines(kept, Asked(search=search), 0, 1000)] == expected
        assert count(kept, Asked(search=search)) == len(expected)
    filters = {
        Asked(design="Cart %_!"): lambda one: one.design == "Cart %_!",
        Asked(site=""): lambda one: one.site is None,
        Asked(design="", site="Kiel"): lambda one: (one.design, one.site) == (None, "Kiel"),
    }
    for asked, holds in filters.items():
        expected = [one.name for one in known if holds(one)]
        assert expected
        assert [one.robot for one in lines(kept, asked, 0, 1000)] == expected


def test_groups_are_sums_over_all_robots(kept):
    told = [*filled(kept, 40, seed=2), Told("r", None, None, None, None)]
    never = {name for (name,) in kept.rows("SELECT name FROM robot WHERE number NOT IN (SELECT robot FROM heard)")}
    chances = [one.chance for one in told if one.chance is not None]
    assert totals(kept, 168.0, time.time_ns() - 10**12) == (len(told), len(chances), len(never))
    for by in ("design", "site"):
        found = {one.name: one for one in groups(kept, by, 168.0, time.time_ns() - 10**12)}
        assert found.keys() == {getattr(one, by) for one in told}
        for name, group in found.items():
            some = [one for one in told if getattr(one, by) == name]
            chances = [one.chance for one in some if one.chance is not None]
            assert (group.robots, group.known) == (len(some), len(chances))
            assert group.expected == pytest.approx(math.fsum(chances))
            assert group.worst == max(chances, default=None)
            assert group.silent == sum(one.name in never for one in some)
    assert all(one.silent == one.robots for one in groups(kept, "site", 168.0, time.time_ns() + 10**12))


def test_only_viewers_look_and_only_robots_report(tmp_path):
    path = tmp_path / "fleet.db"
    with FleetStore(path, make=True) as store:
        robot = store.add_token("r")
    users = AccessFile(access_path(path))
    viewer = Users(users).add_token("grafana", "viewer")
    Users(users).add_person("ann", "viewer", "a long password")
    users.close()
    with serving(path) as served, httpx.Client(base_url=served.address) as client:
        assert client.get("", headers={"accept": "text/html"}).status_code == 401
        for token, code in ((robot, 401), (viewer, 200)):
            assert client.get("", headers={"authorization": f"Bearer {token}"}).status_code == code
        said = client.post("robots/r/reports", headers={"authorization": f"Bearer {viewer}"}, content=b"")
        assert said.status_code == 401
        wrong = client.post("login", data={"name": "ann", "password": "another"})
        assert wrong.status_code == 401
        assert client.post("login", data={"name": "ann", "password": "a long password"}).status_code == 303
        assert client.get("").status_code == 200
        assert client.get("", headers={"host": "elsewhere.example"}).status_code == 421


def test_what_cannot_be_shown_is_said(fleet, store):
    store.add_token("<b>&'\"")
    with httpx.Client(base_url=fleet.address) as client:
        assert "no robot" in client.get("robot", params={"name": "nobody"}).text
        assert client.get("", params={"order": "best"}).status_code == 422
        listed = client.get("", params={"order": "unknown"}).text
        assert "<b>" not in listed
        assert "&lt;b&gt;" in listed
        policy = client.get("").headers["content-security-policy"]
        assert "default-src 'none'" in policy
        assert client.get("robot", params={"name": "<b>&'\""}).status_code == 200


def test_proposals_with_their_evidence_and_who_decided(fleet, store, browser, tmp_path):
    """In Chromium: from the list to a proposal, whose part has a name that would be HTML."""
    design = tmp_path / "robot.yaml"
    design.write_text(DESIGN)
    robot, eye = parse(DESIGN), ServiceNote("eye", failed=True)
    with httpx.Client(base_url=fleet.address) as client:
        assert "None was made yet" in client.get("proposals").text
        assert client.get("proposal", params={"number": 1}).status_code == 404
        assert client.get("proposal", params={"number": "x"}).status_code == 422
    for at in range(12):
        worked = [(10.0, eye)] * 9 if at % 2 else [(90.0,)]
        send(store, f"r{at}", lived(robot, *worked), site="Bern <b>" if at % 2 else "Kiel")
    done = CliRunner().invoke(app, ["fleet", "propose", str(design), "--store", store.place])
    assert done.exit_code == 0, done.exception
    decide(store, 1, design, "Ada & co", ACCEPTED)
    context = browser.new_context(viewport={"width": 390, "height": 800})
    visit = Visit(context.new_page(), fleet)
    page = visit.page
    page.goto(fleet.address)
    page.get_by_role("link", name="Proposals").click()
    assert page.locator("main tbody tr").inner_text().split("\t")[-2:] == ["accepted", "Ada & co"]
    assert visit.serious() == []
    page.get_by_role("link", name="1", exact=True).click()
    text = page.inner_text("main")
    assert "site Bern <b>" in text
    assert "54" in page.locator("main tbody tr", has_text="eye").first.inner_text()
    assert "learned: {factor:" in page.locator("pre").inner_text()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert visit.serious() == []
    context.close()
    assert visit.wrong == []


def test_a_person_finds_which_fail_first_and_why(fleet, store, browser):
    """In Chromium: from the list by design to a robot's past, without a script and without a request elsewhere."""
    told = filled(store, 180, seed=3)
    now = time.time_ns()
    bound = figures(0.95, BOUNDS.index("at least"))
    state = PresentState(1, "{}", {"robot": "arm 1", "design_hash": "d", "time": now,
                                   "failure_within": [{"horizon": 168.0, "sensor_based_failure": 0.95,
                                                       "first": "Arm/Joint", "share": 0.8}]},
                         (Ahead(168.0, 0.95, "Arm/Joint", 0.8),))  # fmt: skip
    store.add_token("worst of all", "Kiel")
    rows = tuple(Report(seq, now - (30 - seq) * 3600 * 10**9, 0, bound) for seq in range(1, 31))
    store.commit([Payload("worst of all", "b" * 16, now, 0, rows, state)])
    context = browser.new_context(viewport={"width": 1400, "height": 900})
    visit = Visit(context.new_page(), fleet)
    page = visit.page
    page.goto(fleet.address)
    first = page.locator("main section tbody tr").first.inner_text()
    assert "worst of all" in first
    assert "at least 95 %" in first
    assert "Arm/Joint (80 %)" in first
    unknown = 180 - sum(one.chance is not None for one in told)
    assert f"Of {unknown} it is not known" in page.inner_text("main")
    silent = store.rows("SELECT count(*) FROM robot WHERE number NOT IN (SELECT robot FROM heard)")[0][0]
    assert f"{silent} are silent: not heard for 1 h or more, or never" in page.inner_text("main")
    assert visit.serious() == []

    page.get_by_role("link", name="Next").click()
    assert "101 to" in page.get_by_label("Pages of the list").inner_text()
    page.goto(fleet.address)
    page.get_by_role("link", name="By design").click()
    assert visit.serious() == []
    page.get_by_role("link", name="arm 1").click()
    expected = 1 + sum(one.design == "arm 1" and one.chance is not None for one in told)
    assert page.inner_text("main h2").startswith(f"{expected} robots, design arm 1")
    page.get_by_label("Robot’s name has").fill("WORST")
    page.get_by_role("button", name="Show").click()
    assert page.inner_text("main h2").startswith("1 robots, design arm 1")
    page.get_by_role("link", name="worst of all").click()
    assert page.inner_text("main h1") == "worst of all"
    assert page.locator("main svg").count() >= 2
    assert "bbbbbbbbbbbbbbbb" in page.inner_text("main")
    assert visit.serious() == []
    page.set_viewport_size({"width": 390, "height": 800})
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    page.get_by_role("link", name="Fleet").click()
    assert page.inner_text("main h1") == "Fleet"
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert urljoin(page.url, ".") == fleet.address
    context.close()
    assert visit.wrong == []
