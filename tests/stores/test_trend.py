"""The change of a robot's figures in a day and in a month, against plain loops over all reports that are kept."""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from typing import Any

import pytest

from robophm.stores import open_store
from robophm.stores.trend import trend

from .test_history import BEGIN, DAY, HOUR, MINUTE, report, sporadic

FIGURES = ("hazard_rate", "reliability", "remaining_life", "completion")


def value(one: Mapping[str, Any], figure: str) -> float:
    """A sensor-based figure of a report, read by hand."""
    lived = one["subjects"][0]["sensor_based"]
    if figure == "remaining_life":
        return float((lived[figure] or {"median": "nan"})["median"])
    if figure == "completion":
        return -float((lived[figure] or {"failure": "nan"})["failure"])
    return float(lived[figure])


def test_a_trend_is_what_plain_loops_over_the_reports_say() -> None:
    reports, said = sporadic(3000, 4), 0
    store = open_store("memory:")
    for first in range(0, len(reports), 40):
        store.save("R", {}, (), reports[first : first + 40])
        history = store.history("R")
        kept = list(history.reports())
        for days in (1, 30):
            asked, earlier = kept[-1]["time"] - days * DAY, None
            for one in kept:
                if asked - days * DAY / 10 <= one["time"] <= asked:
                    earlier = one
            found = trend(history, days * DAY)
            if earlier is None:
                assert found is None
                continue
            assert found is not None
            assert found.since == earlier["time"]
            for figure in FIGURES:
                before, now = value(earlier, figure), value(kept[-1], figure)
                expected = now / before - 1 if figure == "hazard_rate" else now - before
                if math.isfinite(before) and math.isfinite(now):
                    said += 1
                    assert math.isclose(getattr(found, figure), expected, rel_tol=1e-9, abs_tol=1e-12)
                else:
                    assert math.isnan(getattr(found, figure))
    assert said > 50


@pytest.mark.parametrize(
    ("before", "told"),
    [(DAY, True), (DAY + 2 * HOUR, True), (DAY + 3 * HOUR, False), (DAY - MINUTE, False), (0, False)],
)
def test_of_a_history_that_is_too_short_or_was_off_nothing_is_said(before: int, told: bool) -> None:
    store = open_store("memory:")
    assert trend(store.history("R"), DAY) is None
    store.save("R", {}, (), [report(BEGIN), report(BEGIN + before)])
    assert (trend(store.history("R"), DAY) is not None) is told


def test_bounds_another_task_and_rounding_are_no_change() -> None:
    store, draw = open_store("memory:"), random.Random(3)
    first = report(BEGIN, draw)
    system = first["subjects"][0]
    system["sensor_based"] |= {"completion": {"failure": 0.1}, "remaining_life": {"median": 5.0}}
    lived = {**system["sensor_based"], "hazard_rate": system["sensor_based"]["hazard_rate"] * (1 + 1e-12)}
    again = {**first, "time": BEGIN + DAY, "subjects": [{**system, "sensor_based": lived}]}
    store.save("R", {}, (), [first, again])
    assert trend(store.history("R"), DAY) == (BEGIN, 0, 0, 0, 0)
    store.save("R", {}, (), [{**again, "task": {"distance": 2}}])
    other = trend(store.history("R"), DAY)
    assert other
    assert math.isnan(other.completion)
    assert other.reliability == 0
    store.save("R", {}, (), [{**again, "subjects": [{**system, "unknown": {"count": 1}}]}])
    assert trend(store.history("R"), DAY) is None
