"""What matters most and what to replace first, on a page: legible and bounded, whatever the size."""

import json
import re

import pytest

from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Task
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.report.bars import bars_svg
from robophm.report.importance import MOST, matters, replace_first


def robot(count: int) -> Robot:
    parts = {
        f"<part {i}>": {
            "rate": f"{i + 1} FPMH", "initial_exposure": "900 h", "life": {"distribution": "weibull", "shape": 2},
        }
        for i in range(count)
    }  # fmt: skip
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": parts}))


def both(design: Robot, **known):
    view = as_designed(Plant(design), Knowledge(**known))
    return {"nominal": view, "sensor_based": view}


def test_bars():
    drawing = bars_svg({"a & b": [0.5, 0.25], "c": [float("nan"), 1.0]}, ["nominal", "lived"], title="Shares")
    widths = [
        float(w) for w in re.findall(r'<rect class="c\d" x="[\d.]+" y="[\d.]+" width="([\d.]+)" height="8"', drawing)
    ]
    assert widths == [pytest.approx(210), pytest.approx(105), pytest.approx(420)]
    assert "a &amp; b" in drawing
    assert "25 %" in drawing
    assert "nominal –" not in drawing.split("<desc>")[0]


def test_the_twenty_that_matter_most_and_how_many_more():
    design = robot(30)
    page = "".join(matters(design, both(design), 2000.0))
    assert "&lt;part 29&gt;" in page
    assert "&lt;part 9&gt;" not in page
    assert "10 more are not shown" in page
    assert page.count("<tr>") == MOST + 1
    gains = "".join(replace_first(design, both(design), Task.plain(0, 10)))
    assert "&lt;part 29&gt;" in gains
    assert "10 more are not shown" in gains
    assert "PoTC sensor" in gains
    assert "<script" not in page + gains


def test_a_robot_that_has_failed_and_one_in_which_nothing_ages():
    design = robot(2)
    said = "".join(matters(design, both(design, failed=frozenset({"<part 0>"})), 0.0))
    assert "has failed" in said
    young = parse(json.dumps({"schema_version": 1, "name": "R", "components": {"a": {"rate": "3 FPMH"}}}))
    assert "Nothing gains" in "".join(replace_first(young, both(young), None))


@pytest.mark.full
def test_two_thousand_parts_are_bounded(monkeypatch):
    design = robot(2100)
    page = "".join(matters(design, both(design), 10.0))
    assert "Barlow–Proschan importances are not worked out" not in page  # in a fraction of a second
    assert len(page) < 60_000
    monkeypatch.setattr("robophm.report.importance.LIFELONG", 2000)
    page = "".join(matters(design, both(design), 10.0))
    assert "Barlow–Proschan importances are not worked out" in page
    assert len(page) < 60_000
