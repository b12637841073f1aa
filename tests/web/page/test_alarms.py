"""Alarms on the page: seen, drawn as limits, acknowledged; the same log by the API and the command line."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import time

import pytest

from robophm.core.signal import SECOND
from robophm.stores import open_store
from robophm.web import monitoring

from ..conftest import serving

BEGIN = 1_700_000_000
DESIGN = """\
schema_version: 1
name: oven
thresholds:
  hazard_rate: {limit: 20 FPMH, delay: 10 s}
  warning: {signals: {/motor.temperature: {above: {limit: 40 degC, clear: 33 degC}}}}
components:
  motor:
    rate: 8 FPMH
    acceleration: {model: q10, reference_temperature: 25 degC}
    signals: {temperature: {topic: /motor, field: temperature, unit: degC, range: [-40, 125]}}
  fan:
    rate: 1 FPMH
    acceleration: {model: q10, reference_temperature: 25 degC}
    signals: {temperature: {topic: /fan, field: temperature, unit: degC, range: [-40, 125]}}
"""


DRAWN = """() => {
  const plots = [...document.querySelectorAll(".plot")];
  const canvas = plots.find((one) => one.textContent.startsWith("Hazard")).querySelector("canvas");
  const probe = document.createElement("canvas").getContext("2d");
  probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--error");
  probe.fillRect(0, 0, 1, 1);
  const [red, green, blue] = probe.getImageData(0, 0, 1, 1).data;
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) count += data[i] === red && data[i + 1] === green && data[i + 2] === blue;
  return count > canvas.width / 8;
}"""
"""Whether the plot of the hazard rate has a dotted line in the colour of errors."""


@pytest.fixture
def oven(tmp_path, monkeypatch):
    """At 45 °C the motor's rate is 32 FPMH: from second 20 on, until the sensor dies at 80.

    Each second of it is looked at: looks are otherwise timed by the clock, and a busy machine plays a minute between.
    """
    for least in ("QUICK", "FULL", "SHARE"):
        monkeypatch.setattr(monitoring, least, 0.0)
    design, table = tmp_path / "robot.yaml", tmp_path / "drive.csv"
    design.write_text(DESIGN)
    rows = [f"{BEGIN + t},{'' if t >= 80 else 45 if t >= 20 else 30},25" for t in range(100)]
    table.write_text("\n".join(["time,/motor.temperature,/fan.temperature", *rows]) + "\n")
    with serving(design, recordings=(table,), store=str(tmp_path / "past.db")) as served:
        served.post("/api/monitoring/start", {"source": "recordings", "speed": 50})
        yield served


def limit_of(svg):
    """The value at which a picture draws a limit, by the first and the last number beside its upright axis."""
    drawn = re.findall(r'<path d="M90 ([\d.]+)H700"[^>]* stroke-dasharray="4 2"', svg)
    numbers = re.findall(r'<text x="84" y="([\d.]+)" text-anchor="end">([^<]+)<', svg)
    (low, lowest), (high, highest) = ((float(y) - 4, float(number)) for y, number in (numbers[0], numbers[-1]))
    assert "limit 2e-5<" in svg
    assert len(drawn) == 1
    return lowest + (float(drawn[0]) - low) / (high - low) * (highest - lowest)


def ask(design, store, *words):
    """What `robophm alarms` answers, and its exit code."""
    command = [sys.executable, "-m", "robophm", "alarms", str(design), "--store", store, *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ | {"COLUMNS": "200"})
    assert done.stderr == ""
    return done.returncode, done.stdout


def test_an_alarm_is_seen_drawn_and_acknowledged(oven, visit, tmp_path):
    look = visit(oven)
    page = look.open("live")
    page.get_by_text("Recording over").wait_for()
    page.get_by_role("region", name="Sensors in °C").get_by_text("warning 40", exact=True).wait_for()
    page.get_by_role("region", name="Hazard rate").get_by_text("limit 2e-5", exact=True).wait_for()
    page.wait_for_function(DRAWN)
    said = oven.get("/api/health")
    assert (said["alarms"], said["unacknowledged"], said["state"]) == (3, 3, "error")
    page = look.open("overview")
    page.locator(".figure", has_text="Hazard rate").get_by_text("at most 2e-5 /h").wait_for()
    page.get_by_role("link", name="3 alarms, 3 not acknowledged").click()
    page.get_by_role("heading", name="Alarms").wait_for()
    row = page.get_by_role("list", name="Active alarms").get_by_role("listitem")
    row = row.filter(has_text="hazard rate 3.3e-05 /h is above 2e-05 /h")
    row.get_by_text("Not known whether it is still so: it rests on silence since").wait_for()
    assert row.get_by_role("button", name="Acknowledge").is_disabled()
    assert look.serious() == []
    page.get_by_label("Acknowledge as").fill("Ada")
    row.get_by_role("button", name="Acknowledge").click()
    row.get_by_text("acknowledged by Ada").wait_for()
    assert oven.get("/api/health")["unacknowledged"] == 2
    assert look.wrong == []

    alarms = {one["what"]: one for one in oven.get("/api/alarms")["alarms"]}
    hot, fast = alarms["/motor.temperature above (warn)"], alarms["robot hazard_rate (error)"]
    # looked at now and then, at 50 times the pace: not before it was so, and before the sensor died
    assert BEGIN + 20 <= hot["begin"] < BEGIN + 80
    assert BEGIN + 30 <= fast["begin"] < BEGIN + 80
    assert (hot["end"], hot["doubt"]) == (None, "rests on silence of /motor.temperature")
    assert fast["acknowledged_by"] == "Ada"
    silent = alarms["warn /motor.temperature silent"]
    assert silent["cause"] == "/motor.temperature is silent: whether it is above 40 °C is not known"
    line = 'robophm_alarm{robot="oven",what="robot hazard_rate (error)",path="",severity="error"} 1'
    assert line in oven.client.get("/metrics").text.splitlines()
    refused = oven.post("/api/alarms/acknowledge", {"number": 99, "by": "Ada"}, 422)
    assert refused["message"] == "there is no alarm 99"

    store = str(tmp_path / "past.db")

    code, text = ask(oven.design, store, "--acknowledge", str(hot["number"]), "--by", "Bob", "--json")
    assert code == 1  # an error goes on
    told = {one["what"]: one for one in json.loads(text)["alarms"]}
    assert told[hot["what"]]["acknowledged_by"] == "Bob"
    assert told[hot["what"]]["begin"] == round(hot["begin"] * SECOND)
    assert "not known: rests on silence" in ask(oven.design, store)[1].replace("\n", " ")

    # those that are open go on in the next run, and end when it is cool again
    table = tmp_path / "drive.csv"
    rows = [f"{BEGIN + 200 + t},30,25" for t in range(20)]
    table.write_text("\n".join(["time,/motor.temperature,/fan.temperature", *rows]) + "\n")
    oven.post("/api/monitoring/start", {"source": "recordings", "speed": 1000})
    until = time.monotonic() + 60
    while oven.get("/api/monitoring")["state"] == "running" and time.monotonic() < until:
        time.sleep(0.1)
    assert oven.get("/api/health")["alarms"] == 0
    with open_store(store) as kept:
        ended = kept.alarm_log("oven").alarms()
    assert {one["what"]: one["begin"] for one in ended} == {one["what"]: one["begin"] for one in told.values()}
    assert {one["ended_by"] for one in ended} == {
        "/motor.temperature: 30 °C is not above 40 °C", "hazard rate 1.231e-05 /h is not above 2e-05 /h",
        "/motor.temperature is heard again",
    }  # fmt: skip
    look.open("alarms").get_by_role("list", name="Cleared alarms").get_by_text("acknowledged by Bob").wait_for()


@pytest.mark.full
def test_alarms_are_events_of_the_history(oven, visit):
    look = visit(oven)
    page = look.open("live")
    page.get_by_text("Recording over").wait_for()
    page.get_by_role("region", name="Hazard rate").get_by_text("limit 2e-5", exact=True).wait_for()
    with page.expect_download() as taken:
        page.get_by_role("button", name="Hazard rate as SVG").click()
    assert limit_of(taken.value.path().read_text()) == pytest.approx(2e-5, rel=0.01)
    page = look.open("alarms")
    limits = page.get_by_role("list", name="Limits of the design").get_by_role("listitem")
    limits.filter(has_text="the robot: hazard rate above 2e-05 /h for 10 s").wait_for()
    limits.filter(has_text="/motor.temperature: above 40 °C").wait_for()
    assert limits.count() == 2
    alarms = oven.get("/api/alarms")["alarms"]
    told = [one for one in oven.get("/api/history")["events"] if "alarm" in one["kind"]]
    assert len(told) == 3
    assert {(one["time"], one["subject"], one["said"]) for one in told} == {
        (one["begin"], one["what"], one["cause"]) for one in alarms
    }
    page = look.open("history")
    page.get_by_role("row").filter(has_text="/motor.temperature is silent").get_by_role("button").click()
    page.get_by_role("region", name="The robot as it was").wait_for()
    assert look.wrong == []


TOLD = """
window.told = [];
const Real = window.Notification;
window.Notification = class extends Real {
  constructor(title, options) {
    super(title, options);
    window.told.push(title);
  }
};
"""
"""Notes each notification that the browser is given."""


def test_an_alarm_that_begins_is_told_on_the_desktop_where_that_is_wished(visit, tmp_path, monkeypatch):
    for least in ("QUICK", "FULL", "SHARE"):
        monkeypatch.setattr(monitoring, least, 0.0)
    (tmp_path / "robot.yaml").write_text(DESIGN)
    rows = [f"{BEGIN + t},45,25" for t in range(60)]
    (tmp_path / "drive.csv").write_text("\n".join(["time,/motor.temperature,/fan.temperature", *rows]) + "\n")
    with serving(tmp_path / "robot.yaml", recordings=(tmp_path / "drive.csv",)) as served:
        look = visit(served, permissions=["notifications"])
        look.page.add_init_script(TOLD)
        page = look.open("alarms")
        page.get_by_text("None at present.").wait_for()
        wished = page.get_by_label("notify on this desktop")
        wished.click()  # it is ticked when the browser has said that it may
        page.wait_for_function("box => box.checked", arg=wished.element_handle())
        page.get_by_role("link", name="Design").click()  # whichever page is open
        served.post("/api/monitoring/start", {"source": "recordings", "speed": 20})
        while len(said := sorted(page.evaluate("window.told"))) < 2:
            page.wait_for_timeout(100)
        assert said[0].startswith("ERROR: hazard rate")
        assert said[1].startswith("WARN: ")
        assert "/motor.temperature" in said[1]
        assert look.serious() == []


@pytest.mark.full
def test_without_the_permission_nothing_is_told_and_it_is_said(visit, shared_small):
    page = visit(shared_small).open("alarms")
    page.get_by_label("notify on this desktop").click()
    page.get_by_text(re.compile("refuses notifications|not allowed")).wait_for()
    assert not page.get_by_label("notify on this desktop").is_checked()
