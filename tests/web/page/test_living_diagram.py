"""Blocks of the diagram coloured by their share of the failures to come, and by their state now."""

from __future__ import annotations

import math

import pytest

from ..conftest import serving

DRIVE, LIDAR, CAMERA = 18e-6, 30e-6, 90e-6  # hazard rates of the courier [1/h]


def share_of_drive(hours: float) -> float:
    """In closed form: the drive, in series with a pair of which one is enough, fails first."""
    terms = ((1, LIDAR), (1, CAMERA), (-1, LIDAR + CAMERA))
    first = DRIVE * sum(n * -math.expm1(-(DRIVE + rate) * hours) / (DRIVE + rate) for n, rate in terms)
    pair = sum(n * math.exp(-rate * hours) for n, rate in terms)
    return first / (1 - math.exp(-DRIVE * hours) * pair)


def test_blocks_show_their_share_of_the_failures_to_come(visit, small):
    found = small.get("/api/condition")
    shares = {one["path"]: one["share"] for one in found["blocks"]}
    drive = share_of_drive(found["horizon"])
    assert shares == {"drive": pytest.approx(drive, rel=1e-4), "see": pytest.approx(1 - drive, rel=1e-4)}
    inside = {one["path"]: one["share"] for one in small.get("/api/condition", path="drive")["blocks"]}
    assert inside["drive/motor"] == pytest.approx(drive * 16 / 18, rel=1e-4)
    every = small.get("/api/condition", whole=True)["blocks"]
    assert sum(one["share"] for one in every) == pytest.approx(1, rel=1e-4)
    assert {one["state"] for one in every} == {"idle"}
    look = visit(small)
    page = look.open("design")
    page.get_by_label("Coloured by").select_option("share")
    page.locator(".box.share", has_text="drive").get_by_text("% of failures").wait_for()
    page.get_by_text("the median remaining life").wait_for()
    assert look.serious() == []
    page.set_viewport_size({"width": 390, "height": 800})
    size = page.locator(".react-flow").bounding_box()
    assert size["width"] > 350
    assert size["height"] > 300
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert look.serious() == []


def test_a_level_of_many_parts_is_no_strip(small):
    many = {f"part {i}": {"rate": "1 FPMH"} for i in range(200)}
    small.edit({"op": "put", "path": ["modules", "drive", "components"], "value": many})
    drawn = small.get("/api/design/drawing", path="drive", width=450)
    assert len(drawn["boxes"]) == 200
    assert drawn["height"] <= drawn["width"]


@pytest.fixture
def large(tmp_path):
    """A robot of 2,000 parts in 20 modules, of which the last fails a hundred times as often as any other."""
    design = tmp_path / "large.yaml"
    parts = "".join(f"      part {i}: {{rate: 1 FPMH}}\n" for i in range(100))
    modules = "".join(f"  module {m}:\n    components:\n{parts}" for m in range(20))
    before, _, rest = modules.rpartition("rate: 1 FPMH")
    design.write_text(f"schema_version: 1\nname: large\nmodules:\n{before}rate: 2000 FPMH{rest}")
    with serving(design) as served:
        yield served


@pytest.mark.full
def test_two_thousand_parts_are_tiles_from_afar_and_boxes_from_near(visit, large):
    drawn = large.get("/api/design/drawing", whole=True, width=1200)
    assert len(drawn["boxes"]) == 2000
    assert 0.5 < drawn["width"] / drawn["height"] < 2
    look = visit(large)
    page = look.open("design")
    page.get_by_label("down to the parts").check()
    page.get_by_label("Coloured by").select_option("share")
    tiles = page.locator(".tile")
    page.locator(".tile.share-4").wait_for()  # half of all failures and more
    assert tiles.count() == 2000
    assert page.locator(".tile.share-0").count() == 1999
    assert page.locator(".tiles text").all_text_contents() == [f"module {m}" for m in range(20)]
    assert page.locator(".box").count() == 0
    assert look.serious() == []
    page.locator(".tile.share-4").click()
    page.locator(".box.chosen", has_text="part 99").get_by_text("of failures").wait_for()
    assert tiles.count() == 0
    assert page.locator(".box").count() < 100  # what can be seen
    page.get_by_role("heading", name="part 99").wait_for()
    # what is found in the tree is gone to
    page.get_by_placeholder("Find a part").fill("part 42")
    page.get_by_role("treeitem", name="part 42").nth(6).click()
    page.locator(".box.chosen", has_text="part 42").wait_for()
    page.get_by_role("button", name="Fit View").click()
    page.locator(".tile.chosen").wait_for()
    assert look.wrong == []


def test_of_five_thousand_parts_of_one_level_the_one_that_is_sought_is_gone_to(visit, tmp_path):
    design = tmp_path / "broad.yaml"
    parts = "".join(f"  part {i}: {{rate: 1e-9 /h}}\n" for i in range(5000))
    design.write_text(f"schema_version: 1\nname: broad\ncomponents:\n{parts}")
    with serving(design) as served:
        drawn = served.get("/api/design/drawing", around="part 4321")
        assert {box["part"] for box in drawn["boxes"]} == {f"part {i}" for i in range(4000, 4400)} | {None}
        assert (drawn["earlier"], drawn["later"]) == ("part 3600", "part 4400")
        look = visit(served)
        page = look.open("design")
        page.get_by_text("Not drawn are 0 parts before these and 4,600 behind.").wait_for()
        page.get_by_placeholder("Find a part").fill("part 4321")
        page.get_by_role("treeitem", name="part 4321").click()
        page.locator(".box.chosen", has_text="part 4321").wait_for()
        page.get_by_text("Not drawn are 4,000 parts before these and 600 behind.").wait_for()
        page.get_by_role("button", name="Later parts").click()
        page.get_by_text("Not drawn are 4,400 parts before these and 200 behind.").wait_for()
        page.locator(".tile title", has_text="part 4799").wait_for(state="attached")
        assert look.serious() == []


def test_a_block_beyond_its_limit_is_an_error(small):
    limit = {"hazard_rate": "1e-9 /h"}
    small.edit({"op": "put", "path": ["modules", "drive", "thresholds"], "value": limit})
    states = {one["path"]: one["state"] for one in small.get("/api/condition")["blocks"]}
    assert states == {"drive": "error", "see": "idle"}


@pytest.mark.full
def test_parts_that_depend_on_each_other_have_a_share_together_alone(small):
    spares = {"standby": {"of": ["lidar", "camera"]}}
    small.edit({"op": "put", "path": ["modules", "see", "diagram"], "value": spares})
    above = {one["path"]: one["share"] for one in small.get("/api/condition")["blocks"]}
    assert above["drive"] + above["see"] == pytest.approx(1, rel=1e-4)
    assert [one["share"] for one in small.get("/api/condition", path="see")["blocks"]] == [None, None]
