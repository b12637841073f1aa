"""Wear on the page: readings, the course that they foretell, its band and threshold."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from robophm.core.signal import SECOND, Sample
from robophm.design.file import load
from robophm.monitoring.monitor import Monitor
from robophm.stores.sqlite import SqliteStore

from ..conftest import serving

ARM = """\
schema_version: 1
name: arm
components:
  motor:
    rate: 8 FPMH
    wear: {topic: /motor, field: current, unit: A, every: 10 min, threshold: 9 A}
  fan:
    rate: 8 FPMH
    wear: {topic: /fan, field: current, unit: A, every: 10 min, threshold: 9 A}
"""
BEGIN, HOURS = 1_700_000_000, 5


@pytest.mark.full
def test_wear_is_drawn_with_its_band_and_threshold(tmp_path, visit):
    """A current that grows by 0.4 A an hour from 5 A is at 9 A after 10 hours; the fan's does not grow."""
    design, past = tmp_path / "robot.yaml", tmp_path / "past.db"
    design.write_text(ARM)
    robot = load(design)
    monitor = Monitor(robot)
    for t in range(0, HOURS * 3600, 50):
        now = (BEGIN + t) * SECOND
        monitor.observe(Sample(now, "/motor.current", 5 + 0.4 * t / 3600 + 0.02 * math.sin(t)))
        monitor.observe(Sample(now, "/fan.current", 5 + 0.2 * math.sin(t)))
    with SqliteStore(past) as store:
        store.save(robot.identity, monitor.exposure.settled(monitor.ledger).to_json(), (), (), ())
    with serving(design, store=past) as served:
        look = visit(served)
        page = look.open("overview")
        plot = page.get_by_role("region", name="Wear of motor", exact=True)
        plot.get_by_text("Dashed: the course that its own readings foretell").wait_for()
        found = served.get("/api/wear", mode="motor")
        assert found["values"] == pytest.approx([5 + 0.4 * one for one in found["times"]], abs=0.02)
        ages = (np.array(found["dates"]) - BEGIN) / 3600
        assert found["times"] == pytest.approx(ages, abs=1e-6)
        assert len(found["times"]) == served.get("/api/health")["wear"][0]["readings"] >= HOURS * 6 - 1
        band = {name: np.array(values) for name, values in found["band"].items()}
        later = (band["fast"] < 9) & (band["times"] > found["times"][-1] + 0.5)
        line = 5 + 0.4 * band["times"]
        assert later.sum() > 5
        assert np.all((band["slow"] < line)[later] & (line < band["fast"])[later])
        assert found["times"][-1] + found["seen"]["median"] == pytest.approx(10, rel=0.1)
        # the report draws the same figures, and so the PDF that is made of it
        text = served.client.get("/api/report").text
        drawn = text.split("<h2>What is seen to wear</h2>")[1].split("<h2>")[0]
        (course,) = re.findall(r"median: (\S+) at (\S+) to (\S+) at (\S+)\.", drawn)
        ends = [band[name][place] for place in (0, -1) for name in ("median", "times")]
        assert [float(one) for one in course] == pytest.approx(ends, rel=1e-3)
        assert drawn.count("readings alone foretell no course to the threshold") == 1  # the fan's
        # what is drawn is told by its legend, and taken along as a table
        assert plot.locator(".legend").inner_text().split("\n") == [
            "course, 5 %", "95 %", "median", "readings", "threshold", "reached, with 90 %",
        ]  # fmt: skip
        with page.expect_download() as download:
            plot.get_by_role("button", name="Wear of motor as CSV").click()
        lines = [row.split(",") for row in download.value.path().read_text().splitlines()[1:]]
        assert [float(row[4]) for row in lines if row[4]] == pytest.approx(found["values"])
        assert {float(row[5]) for row in lines if row[5]} == {9}
        assert look.serious() == []
        # another part's, whose current does not grow
        page.get_by_role("button", name="mean of /fan.current").click()
        fan = page.get_by_role("region", name="Wear of fan", exact=True)
        fan.get_by_text("foretell no course to the threshold").wait_for()
        assert served.get("/api/wear", mode="fan")["band"] is None
        assert (
            served.client.get("/api/wear", params={"mode": "motr"}).json()["message"].endswith("did you mean 'motor'?")
        )
        # and beside the part in the design
        look.open("design/motor").get_by_role("region", name="Wear of motor", exact=True).locator("canvas").wait_for()
        assert look.serious() == []
        assert look.wrong == []
