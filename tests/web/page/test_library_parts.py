"""The forms of a part of the library: what it does not state is the library's, and what is typed in wins."""

from __future__ import annotations

import pytest

from ..conftest import serving

TEXT = "schema_version: 1\nname: R\ncomponents:\n  Lidar: {part: lidar_2d}\n  Fan: {mtbf: 9000 h}\n"


@pytest.mark.full
def test_a_part_of_the_library_in_the_forms(visit, tmp_path):
    design = tmp_path / "robot.yaml"
    design.write_text(TEXT)
    with serving(design, seed=1) as served:
        look = visit(served)
        page = look.open("design/Lidar")
        page.get_by_text("now by lidar_2d of the library; a stated rate takes its place").wait_for()
        assert page.get_by_label("Life model").input_value() == ""
        page.get_by_label("Quantity").fill("2")
        page.get_by_label("Quantity").press("Enter")
        page.wait_for_function("async () => (await (await fetch('api/design/text')).json()).text.includes('quantity')")
        assert "Lidar: {part: lidar_2d, quantity: 2}" in served.get("/api/design/text")["text"]
        page = look.open("parts")
        page.get_by_text("lidar_2d of the library").first.wait_for()
        page = look.open("design/Fan")
        page.get_by_text("now by mtbf 9000 h").wait_for()
        page.get_by_label("Stated rate of one").fill("5 FPMH")
        page.get_by_label("Stated rate of one").press("Enter")
        page.wait_for_function("async () => (await (await fetch('api/design/text')).json()).text.includes('5 FPMH')")
        assert served.get("/api/design/text")["text"].endswith("  Fan:\n    rate: 5 FPMH\n")
