"""Each page with a robot, without one, and with a design that is not complete; nothing serious for axe-core."""

import re
import time

import pytest

from ..conftest import OTA, ROOT, SMALL, serving
from .conftest import Visit

PAGES = sorted(file.stem.lower() for file in (ROOT / "ui" / "src" / "pages").glob("*.tsx"))
SAYS = {
    "overview": "What will fail it", "design": "Power", "parts": "Step Down Switching Regulator",
    "analysis": "Median remaining life", "live": "Hazard rate", "sensors": "/ota/power/temperature",
    "tasks": "Can I do this?", "reports": "Open the report", "settings": "Hazard rates in",
}  # fmt: skip
EMPTY = {
    "overview": "No robot yet", "design": "Add module", "parts": "No parts yet", "analysis": "Nothing to analyse yet",
    "live": "not complete", "sensors": "Nothing is bound", "tasks": "The list is empty", "reports": "nothing to report",
    "settings": "Hazard rates in",
}  # fmt: skip


BEYOND = """() => [...document.querySelectorAll("main *, header *")]
  .filter((one) => one.getBoundingClientRect().right > innerWidth + 1)
  .filter((one) => !one.closest(".scroll, .tabs, .react-flow, .hidden"))
  .map((one) => one.outerHTML.slice(0, 150))"""
"""What reaches beyond the right edge, and in nothing that scrolls."""


@pytest.fixture(scope="module")
def ota(tmp_path_factory):
    design = tmp_path_factory.mktemp("ota") / "robot.yaml"
    design.write_bytes(OTA.read_bytes())
    with serving(design, seed=3) as served:
        served.post("/api/monitoring/start", {"source": "synthetic", "speed": 10})
        until = time.monotonic() + 60
        while served.get("/api/health")["looks"] < 2 and time.monotonic() < until:
            time.sleep(0.2)
        yield served


@pytest.fixture(scope="module")
def nothing(tmp_path_factory):
    with serving(tmp_path_factory.mktemp("nothing") / "new.yaml", seed=3) as served:
        yield served


@pytest.fixture(scope="module")
def broken(tmp_path_factory):
    design = tmp_path_factory.mktemp("broken") / "courier.yaml"
    design.write_text(SMALL.replace("30 FPMH", "30 kg"))
    with serving(design, seed=3) as served:
        yield served


@pytest.fixture(scope="module")
def looks(ota, nothing, broken, browser):
    """A browser on each of them, which goes from page to page."""
    contexts = [browser.new_context(viewport={"width": 1400, "height": 900}) for _ in range(3)]
    yield [Visit(one.new_page(), served) for one, served in zip(contexts, (ota, nothing, broken), strict=True)]
    for one in contexts:
        one.close()


OFTEN = {"overview", "design", "live", "analysis"}


@pytest.mark.parametrize(
    "name", [name if name in OFTEN else pytest.param(name, marks=pytest.mark.full) for name in PAGES]
)
def test_a_page_with_a_robot_without_one_and_with_one_that_is_not_complete(looks, name):
    robot, nothing, broken = looks
    page = robot.open(name)
    page.locator(f"nav a[href='#/{name}'][aria-current=page]").wait_for()
    if name in SAYS:
        page.get_by_text(SAYS[name]).first.wait_for()
    if name == "design":
        page.locator(".react-flow__node-box").first.wait_for()
    if name in ("live", "analysis"):
        page.locator("canvas").first.wait_for()
    assert robot.serious() == []
    page = nothing.open(name)
    if name in EMPTY:
        page.get_by_text(EMPTY[name]).first.wait_for()
    assert nothing.serious() == []
    broken.open(name).get_by_role("button", name="Problems of the design: 1 to mend").wait_for()
    for look in looks:
        assert look.page.get_by_text("This page has failed").count() == 0
        assert look.wrong == []


def test_the_first_load_is_small(ota, visit):
    look, sizes = visit(ota), list[float]()
    session = look.page.context.new_cdp_session(look.page)
    session.send("Network.enable")
    session.on("Network.loadingFinished", lambda event: sizes.append(event["encodedDataLength"]))
    look.open("live")
    look.page.locator("canvas").first.wait_for()
    assert 20_000 < sum(sizes) < 150_000


@pytest.mark.full
def test_every_page_in_the_dark(ota, visit):
    look = visit(ota, color_scheme="dark")
    for name in ("overview", "design", "live", "tasks"):
        look.open(name).get_by_text(SAYS[name]).first.wait_for()
        assert look.serious() == [], name


@pytest.mark.full
@pytest.mark.parametrize("size", [(1024, 768), (768, 1024)])
def test_no_page_is_wider_than_a_tablet(ota, visit, size):
    look = visit(ota, has_touch=True)
    look.page.set_viewport_size({"width": size[0], "height": size[1]})
    for name in PAGES:
        page = look.open(name)
        page.locator(f"nav a[href='#/{name}'][aria-current=page]").wait_for()
        if name in SAYS:
            page.get_by_text(SAYS[name]).first.wait_for()
        assert page.evaluate(BEYOND) == [], name
        assert look.serious() == [], name


def test_what_is_wrong_in_a_design_is_found_and_mended(broken, visit):
    look = visit(broken)
    page = look.open("overview")
    page.get_by_text("does not measure what '1/h' does").first.wait_for()
    page.get_by_role("button", name="modules / see / components / lidar / rate").click()
    page.get_by_label("Stated rate of one").fill("30 FPMH")
    page.get_by_label("Stated rate of one").press("Enter")
    page.get_by_role("button", name="Problems of the design: No problems").wait_for()
    page.get_by_role("button", name="Undo").click()
    page.get_by_role("button", name="Problems of the design: 1 to mend").wait_for()


@pytest.mark.full
def test_a_page_whose_service_ends_says_so_and_comes_back(tmp_path, visit):
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as served:
        look = visit(served)
        page = look.open("overview")
        served.edit({"op": "put", "path": ["name"], "value": "express"})
        page.get_by_role("heading", name="express").wait_for()
    page.get_by_text("The service does not answer.").wait_for()
    look.wrong.clear()  # the browser reports that it could not connect


@pytest.mark.full
def test_what_if_of_several_changes(tmp_path, visit):
    """Two motors at 8 FPMH and an encoder at 2: at 4 and 1, half of that; what is redundant does not fail yet."""
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as served:
        page = visit(served).open("analysis")
        page.get_by_role("tab", name="What if").click()
        for part, rate in (("drive/motor", "4 FPMH"), ("drive/encoder", "1 FPMH")):
            page.get_by_label("What if this part").select_option(part)
            page.get_by_label("Rate of one").fill(rate)
            page.get_by_role("button", name="And also…").click()
        page.get_by_role("list", name="Changes that are compared together").get_by_text("drive/motor").wait_for()
        page.get_by_role("button", name="Compare").click()
        row = page.get_by_role("row")
        row.filter(has_text=re.compile("^nominal9e-6 /h")).wait_for()
        row.filter(has_text=re.compile("^nominal, baseline1.8e-5 /h")).wait_for()
        page.get_by_role("button", name="Remove: drive/encoder: a rate of 1 FPMH").click()
        page.get_by_role("button", name="Compare").click()
        row.filter(has_text=re.compile("^nominal1e-5 /h")).wait_for()
        page.get_by_role("button", name="Apply").click()
        page.get_by_text("courier.yaml, not saved").wait_for()
        parts = served.get("/api/design")["document"]["modules"]["drive"]["components"]
        assert [parts[one]["rate"] for one in ("motor", "encoder")] == ["4 FPMH", "2 FPMH"]


@pytest.mark.full
def test_a_table_taken_along_holds_no_formula(tmp_path, visit):
    """Names that a spreadsheet would compute are told to be text, numbers are not."""
    design = tmp_path / "robot.yaml"
    design.write_text(
        "schema_version: 1\nname: robot\ncomponents:\n"
        + "".join(f"  '{name}': {{rate: 8 FPMH}}\n" for name in ("=1+1", "+a", "-a", "@a", "-5", "a=1"))
    )
    with serving(design) as served:
        page = visit(served).open("parts")
        with page.expect_download() as download:
            page.get_by_role("button", name="Parts as CSV").click()
    rows = download.value.path().read_text().splitlines()[1:]
    assert sorted(row.split(",")[0] for row in rows) == ["'+a", "'-a", "'=1+1", "'@a", "-5", "a=1"]
    assert {float(row.split(",")[3]) for row in rows} == {8e-6}
