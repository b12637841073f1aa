"""A design that is wrong is mended on the page: one value leaves the diagram; broken YAML says line and column."""

from __future__ import annotations

import pytest

from ..conftest import SMALL, serving

WRONG = [  # what is put where, what is said of it, and at which box of the level
    (["components", "lidar", "rate"], "30 FPMHH", "unknown unit 'FPMHH'", "lidar"),
    (["diagram"], {"parallel": ["lidar", "camra"]}, "unknown part 'camra'", "camra"),
    (["components", "lidar", "depends_on"], "encodr", "unknown part 'encodr'", "lidar"),
    (["diagram"], {"parallel": ["lidar", "lamp"]}, "unknown part 'lamp'", "lamp"),
]


def test_one_wrong_value_leaves_the_diagram_and_is_said_at_its_box(visit, small):
    look = visit(small)
    page = look.open("design/see")
    boxes, canvas = page.locator(".box"), page.locator(".canvas")
    for place, value, said, box in WRONG:
        boxes.first.wait_for()
        small.edit({"op": "put", "path": ["modules", "see", *place], "value": value})
        drawn = small.get("/api/design/drawing", path="see")
        wrong = {one["title"]: one["wrong"] for one in drawn["boxes"] if one["wrong"]}
        assert wrong.keys() == {box}
        assert wrong[box][0].startswith(said)
        assert drawn["wires"]
        (above,) = (one for one in small.get("/api/design/drawing")["boxes"] if one["title"] == "see")
        assert above["wrong"] == wrong[box]
        page.locator(".box.wrong", has_text=box).get_by_text(said).wait_for()
        small.post("/api/design/undo", {"revision": small.get("/api/design")["revision"]})
        page.locator(".box.wrong").wait_for(state="detached")
    value = {"k_of_n": {"k": 3, "of": ["lidar", "camera"]}}
    small.edit({"op": "put", "path": ["modules", "see", "diagram"], "value": value})
    drawn = small.get("/api/design/drawing", path="see")
    assert {one["title"] for one in drawn["boxes"]} == {"lidar", "camera"}
    assert (drawn["wires"], drawn["ends"], drawn["wired"]) == ([], [], False)
    assert "k = 3 of n = 2" in drawn["wrong"][0]
    assert small.get("/api/design/drawing")["wires"]
    canvas.get_by_text("drawn without wires").wait_for()
    canvas.get_by_text("k = 3 of n = 2").wait_for()
    assert look.serious() == []
    page.get_by_role("treeitem", name="courier").click()
    page.get_by_role("button", name="courier").click()
    page.get_by_role("button", name="Add module").click()
    page.get_by_role("dialog").get_by_role("textbox").fill("grip")
    page.get_by_role("dialog").get_by_role("button", name="Name it so").click()
    page.locator(".box.wrong", has_text="grip").get_by_text("has no parts").wait_for()
    page.locator(".box", has_text="drive").first.wait_for()
    page.locator(".box.wrong", has_text="grip").dblclick()
    canvas.get_by_text("Add a component, or a module, and it is drawn here.").wait_for()


def test_what_is_wrong_and_drawn_nowhere_is_said_too(small):
    small.edit({"op": "put", "path": ["modules", "see", "modules"], "value": {"arm": {}}})
    drawn = small.get("/api/design/drawing", path="see")
    assert not any(one["wrong"] for one in drawn["boxes"])
    assert drawn["wrong"] == ["arm: has no parts; expected modules or components"]
    assert small.get("/api/design/drawing", path="see/arm")["wrong"] == ["has no parts; expected modules or components"]


def test_a_design_for_which_no_figures_can_be_given_is_drawn_without_them(visit, tmp_path):
    design = tmp_path / "three.yaml"
    ages = "{rate: 3 FPMH, life: {distribution: weibull, shape: 2}}"
    design.write_text(
        "schema_version: 1\nname: three\ndiagram: {load_sharing: {of: [a, b, c], k: 1, exponent: 2}}\n"
        f"components: {{a: {ages}, b: {ages}, c: {ages}}}\n"
    )
    with serving(design) as three:
        assert "no exact solution" in three.get("/api/design")["problems"][0]["message"]
        page = visit(three).open("design")
        page.locator(".react-flow__node", has_text="b").first.wait_for()
        page.locator(".canvas").get_by_text("no exact solution").wait_for()


@pytest.mark.full
def test_yaml_that_is_broken_at_the_start_is_mended_on_the_page(visit, tmp_path):
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL.replace("encoder: {rate: 2 FPMH}", "encoder: {rate: 2 FPMH"))
    with serving(design) as courier:
        (problem,) = courier.get("/api/design")["problems"]
        assert problem["line"] == 11
        assert problem["message"].endswith(f"in column {problem['column']}")
        look = visit(courier)
        page = look.open("design")
        page.get_by_role("button", name="Problems of the design: 1 to mend").click()
        page.get_by_role("dialog").get_by_role("cell", name="11", exact=True).wait_for()
        page.get_by_role("button", name="Close").click()
        page.get_by_role("button", name="Edit as text").click()
        text = page.get_by_role("textbox", name="The design file (YAML)")
        text.get_by_text("encoder").wait_for()
        assert "encoder: {rate: 2 FPMH\n" in text.inner_text()
        text.locator(".cm-line", has_text="encoder").click()
        page.keyboard.press("End")
        page.keyboard.type("}")
        page.get_by_role("button", name="Apply").click()
        page.get_by_role("button", name="Problems of the design: No problems").wait_for()
        assert courier.get("/api/design")["valid"] is True
        assert courier.get("/api/design/text")["text"] == SMALL
