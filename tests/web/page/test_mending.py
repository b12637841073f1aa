"""A design that is wrong is mended on the page: one value leaves the diagram; broken YAML says line and column."""

from __future__ import annotations

from ..conftest import SMALL, serving


def test_one_wrong_value_leaves_the_diagram(visit, tmp_path):
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL)
    with serving(design) as courier:
        courier.edit({"op": "put", "path": ["modules", "see", "components", "lidar", "rate"], "value": "30 FPMHH"})
        assert courier.get("/api/design")["valid"] is False
        drawn = courier.get("/api/design/drawing", path="see")
        assert {box["title"] for box in drawn["boxes"]} == {"lidar", "camera"}
        assert "FPMHH" in drawn["wrong"][0]
        page = visit(courier).open("design/see")
        page.get_by_text("Drawn without the rate of what is wrong: modules/see/components/lidar/rate").wait_for()
        page.locator(".react-flow__node", has_text="camera").first.wait_for()
        courier.edit({"op": "put", "path": ["modules", "see", "components", "lidar", "rate"], "value": "30 FPMH"})
        page.get_by_text("Drawn without the rate").wait_for(state="detached")


def test_yaml_that_is_broken_at_the_start_is_mended_on_the_page(visit, tmp_path):
    design = tmp_path / "courier.yaml"
    design.write_text(SMALL.replace("encoder: {rate: 2 FPMH}", "encoder: {rate: 2 FPMH"))
    with serving(design) as courier:
        (problem,) = courier.get("/api/design")["problems"]
        assert problem["line"] == 11
        assert "column" in problem["message"]
        look = visit(courier)
        page = look.open("design")
        page.get_by_role("button", name="Problems of the design: 1 to mend").click()
        page.get_by_role("dialog").get_by_role("cell", name="11", exact=True).wait_for()
        page.get_by_role("button", name="Close").click()
        page.get_by_role("button", name="Edit as text").click()
        text = page.get_by_label("As in the design file (YAML)")
        text.wait_for()
        assert "encoder: {rate: 2 FPMH\n" in text.input_value()
        text.fill(SMALL)
        page.get_by_role("button", name="Take this").click()
        page.get_by_role("button", name="Problems of the design: No problems").wait_for()
        assert courier.get("/api/design")["valid"] is True
