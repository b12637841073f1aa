"""Maintenance over routes: services while the robot is watched, stopped and new; what is due, spares, costs."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import icalendar
import pytest

import robophm
from robophm.core.signal import CLOCK, SECOND, Sample
from robophm.transports.signals.source import SignalSource, TopicInfo
from robophm.web.service import Service
from robophm.web.sources import Choice

from .conftest import Served, serving, until

START = 1_795_000_020 * SECOND
CART = """\
schema_version: 1
name: cart
signals:
  temperature: {topic: /t, field: c, unit: degC, max_age: 60 s}
modules:
  drive:
    components:
      motor:
        rate: 1e-2 /h
        life: {distribution: weibull, shape: 3}
        acceleration: {model: q10, reference_temperature: 25 degC}
      brake: {rate: 2e-6 /h}
"""


class Going(SignalSource):
    """A robot at 35 °C whose first three hours are over at once; then it lives at ten times its pace."""

    def __init__(self) -> None:
        self.fingerprint, self.notes, self.over = "", Counter(), False

    def topics(self) -> list[TopicInfo]:
        return []

    def samples(self, signals: Collection[str]) -> Iterator[Sample]:
        at = START
        while not self.over:
            yield from (Sample(at, "/t.c", 35.0), Sample(at, CLOCK, math.nan))
            at += (36 if at < START + 10800 * SECOND else 1) * SECOND
            time.sleep(0 if at < START + 10800 * SECOND else 0.1)

    def close(self) -> None:
        self.over = True


@contextmanager
def watched(design: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Served]:
    """The cart, which has been watched for nearly three hours of its life."""
    monkeypatch.setattr(Service, "sources", {"live": Choice("live", "live", lambda speed: Going(), lambda: (), False)})
    with serving(design, store=f"{design}.past", own_store=True) as served:
        served.post("/api/monitoring/start", {"source": "live"})
        until(lambda: (health := served.get("/api/health")) and health["clocks"]["operating"] > 2.9)
        yield served


@pytest.fixture
def cart(tmp_path: Path) -> Path:
    path = tmp_path / "cart.yaml"
    path.write_text(CART)
    return path


def failing(served: Served) -> float:
    """The probability that the drive has failed since it was new."""
    return next(one for one in served.get("/api/health")["subjects"] if one["path"] == "drive")["sensor_based"][
        "unreliability"
    ]


def said(part: str, key: str, **more: Any) -> dict[str, Any]:
    return {"part": part, "key": key, **more}


def test_a_service_is_noted_whether_the_robot_is_watched_or_not(cart: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with watched(cart, monkeypatch) as served:
        before = failing(served)
        asked = said("drive/motor", "a" * 8, failed=True, by=" Ada ", note="noise")
        (done,) = served.post("/api/maintenance/service", asked)
        assert (done["mode"], done["kind"], done["failed"], done["by"], done["note"]) == (
            "drive/motor", "replaced", True, "Ada", "noise",
        )  # fmt: skip
        assert done["before"] > 2 * 2.8  # three hours at ten degrees more than by design, q10 = 2
        assert done["after"] == 0
        until(lambda: failing(served) < before)
        assert served.post("/api/maintenance/service", asked) == [done]  # sent again, it is not done again
        assert (
            "no part 'drive/moter'"
            in served.post("/api/maintenance/service", said("drive/moter", "b" * 8), 422)["message"]
        )
        by_command = robophm.service(str(cart), "drive/motor", f"{cart}.past", repaired=0.5, wait=30)
        assert [one.kind for one in by_command] == ["replaced", "repaired"]
        served.post("/api/monitoring/stop")
        stopped = failing(served)
        (done,) = served.post("/api/maintenance/service", said("drive/motor", "c" * 8))
        assert failing(served) < stopped  # at once
        assert len(robophm.service(str(cart), "drive/motor", f"{cart}.past")) == 3
        robophm.service(str(cart), "drive/brake", f"{cart}.past", replaced=True, by="by command")
        assert served.get("/api/maintenance")["services"][0]["by"] == "by command"


def test_without_a_past_nothing_is_noted(cart: Path) -> None:
    with serving(cart, store=f"{cart}.past", own_store=True) as served:
        answer = served.post("/api/maintenance/service", said("drive/motor", "a" * 8), 422)
        assert answer["message"] == "nothing is known of this robot's past yet; expected that it is watched first"


def test_what_is_due_why_and_by_when(cart: Path) -> None:
    """H(a) = (a/η)³ with η = 100/Γ(4/3) h, on for half of the time."""
    cart.write_text(CART + "usage: {operating: 50 %}\n")
    with serving(cart) as served:
        found = served.get("/api/maintenance", risk=0.1)
        (motor, brake) = found["due"]
        eta = 100 / math.gamma(4 / 3)
        assert motor["due"] == pytest.approx(2 * eta * (-math.log(0.9)) ** (1 / 3), rel=1e-9)
        assert motor["why"].startswith("it wears out")
        assert (brake["state"], brake["due"]) == ("useless", None)
        assert brake["median"] == pytest.approx(2 * math.log(2) / 2e-6, rel=1e-9)
        assert (found["past"], found["services"], found["silence"], found["time"]) == (False, [], "", None)
        brakes = [one for one in found["replacements"] if one["name"] == "drive/brake"]
        assert [one["expected"] for one in brakes] == pytest.approx([1e-6 * 168 * w for w in (4, 13, 52)], rel=1e-9)
        answer = served.client.get("/api/maintenance/maintenance.ics", params={"risk": 0.1})
        assert answer.headers["content-type"] == "text/calendar; charset=utf-8"
        (event,) = icalendar.Calendar.from_ical(answer.content).events
        assert str(event["SUMMARY"]) == "cart: replace drive/motor"
        after = served.client.get("/api/maintenance/maintenance.ics", params={"risk": 0.2})
        (later,) = icalendar.Calendar.from_ical(after.content).events
        assert later["UID"] == event["UID"]
        assert later.start >= event.start
        assert served.client.get("/api/maintenance", params={"risk": 0.7}).status_code == 422


def test_the_best_plan_for_costs_beside_what_is_done_today(cart: Path) -> None:
    """Costs are kept beside the design; what is no table of costs is refused, and what was there stays."""
    with serving(cart) as served:
        assert served.client.get("/api/maintenance/plan").status_code == 404
        table = "part,preventive,corrective\ndrive/motor,10,100\ndrive/brake,5,50\n"
        assert served.post("/api/maintenance/costs", {"text": table})["costs"] == table
        plan = served.get("/api/maintenance/plan", hours=5000)
        motor, brake = plan["parts"]
        assert motor["cost"] < motor["never"]
        assert (brake["every"], brake["due"]) == (None, None)
        assert plan["best"]["cost"] < plan["today"]["cost"]
        assert plan["today"]["replacements"] == 0
        wrong = served.post("/api/maintenance/costs", {"text": table.replace("motor", "moter")}, 422)
        assert wrong["message"].endswith("no part 'drive/moter' in the design; did you mean 'drive/motor'?")
        assert "/tmp" not in wrong["message"]
        assert served.get("/api/maintenance")["costs"] == table
        assert Path(f"{cart}.costs.csv").read_text() == table
        served.post("/api/maintenance/costs", {"text": " "})
        assert not Path(f"{cart}.costs.csv").exists()
