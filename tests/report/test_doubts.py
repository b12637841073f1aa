"""Doubtful signals as drawn: the signal's own past, and what would fit, from a plain course of samples."""

import json
import re

import numpy as np
import pytest

from robophm.core.signal import HOUR, Sample
from robophm.design.file import parse
from robophm.health.doubtful_signals import Doubt, DoubtfulSignal
from robophm.monitoring.monitor import Monitor
from robophm.report.doubts import doubts_drawn
from robophm.report.health_page import health_page

START = 1_700_006_400 * 10**9
JUMP = 200
HOURS = 260


@pytest.fixture(scope="module")
def lived():
    """Three motors, an hour a sample; the last one is 25 degC warmer from an hour on that its neighbours know not."""
    motor = {"rate": "1e-5 /h", "acceleration": {"model": "q10"}}
    components = {
        name: motor | {"signals": {"temperature": {"topic": f"/{name}", "field": "c", "max_age": "2 h"}}}
        for name in ("left", "right", "rear")
    }
    robot = parse(json.dumps({"schema_version": 1, "name": "R", "max_gap": "2 h", "components": components}))
    monitor, rng = Monitor(robot, period=3600), np.random.default_rng(5)
    for hour in range(HOURS):
        for name, mean in (("left", 40), ("right", 45), ("rear", 42)):
            value = mean + rng.normal() + 25 * (name == "rear" and hour >= JUMP)
            monitor.observe(Sample(START + hour * HOUR, f"/{name}.c", value))
    return robot, monitor.report(remaining_life=False)


def test_the_signal_and_what_would_fit_are_drawn(lived):
    _, report = lived
    (doubt,) = report.doubts
    (drawn,) = doubts_drawn(report.doubts)
    assert "°C higher since 2023-11-23 08:00:00 UTC" in drawn  # 200 h on
    assert "if the others are right, the dashed line" in drawn
    hours = (doubt.about.ends - START) / HOUR
    assert np.allclose(doubt.about.means[hours <= JUMP], 42, atol=2)
    assert np.allclose(doubt.about.means[hours > JUMP + 1], 67, atol=2)
    assert doubt.about.instead == pytest.approx(42, abs=2)
    # The line is low, then high; y grows downwards, so that what would fit lies where the line began.
    own, fits = (
        np.array(re.findall(r"([\d.]+) ([\d.]+)", path), dtype=float)
        for path in re.findall(r'class="line c\d[^"]*" d="([^"]{12,})"', drawn)[:2]
    )
    assert own[0, 1] > own[-1, 1] + 20
    assert abs(own[0, 1] - fits[0, 1]) < 20


def test_they_are_in_the_report_and_nothing_is_where_nothing_is_doubtful(lived):
    robot, report = lived
    assert health_page(robot, report).count("what would fit now") >= 1
    assert not list(doubts_drawn(()))


def test_a_dead_sensor_has_nothing_that_would_fit():
    about = DoubtfulSignal(
        "/a.c", "k", "has said 3", "if it is dead", None, "degC", np.arange(3) * HOUR, np.full(3, 3.0)
    )
    new = DoubtfulSignal("/b.c", "k", "reads 9 less", "if it is right", 4.0)  # told of before an hour has gone by
    (drawn,) = doubts_drawn([Doubt(about, 1e-5, None), Doubt(new, 1e-5, None)])
    assert "/b.c" not in drawn
    assert "/a.c has said 3; if it is dead" in drawn
    assert "dashed" not in drawn.partition("</style>")[2]
