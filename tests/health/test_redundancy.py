"""Redundancy allocation against designs that are written anew for every choice, and solved by themselves."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

import robophm
from robophm.core.errors import RobophmError
from robophm.design.file import parse
from robophm.health import redundancy

WIRINGS = (
    "{series: [p0, p1, p2, x]}",
    "{series: [{parallel: [p0, {series: [p1, p2]}]}, x]}",
    "{parallel: [{series: [p0, p1]}, {series: [p2, p0]}, x]}",
)
HOURS = 1000.0


def text(parts: dict[str, tuple[float, int, int]], wiring: str, more: tuple[int, ...] = ()) -> str:
    more = more or (0,) * len(parts)
    lines = [
        f"  {name}: {{rate: {rate!r} /h, quantity: {n + extra}, required: {k}}}\n"
        for (name, (rate, n, k)), extra in zip(parts.items(), more, strict=True)
    ]
    return f"schema_version: 1\nname: r\ncomponents:\n{''.join(lines)}  x: {{rate: 1e-5 /h}}\ndiagram: {wiring}\n"


def robot(written: str) -> robophm.Robot:
    return parse(written, "r.yaml", Path())


def failure(written: str) -> float:
    """P(it fails within the time), by the engine asked for the design as a whole."""
    from robophm.health.outlooks import as_designed
    from robophm.health.plant import Plant

    made = robot(written)
    return float(as_designed(Plant(made)).survival_curve(made.diagram, np.array([HOURS])).failed[0])


@pytest.mark.parametrize("way", ["front", "search"])
@pytest.mark.parametrize("seed", range(4))
def test_as_all_choices_written_out(seed: int, way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    if way == "search":
        monkeypatch.setattr(redundancy, "MOST_CHOICES", 0)
    drawn = np.random.default_rng(seed)
    wiring, parts = WIRINGS[seed % 3], {}
    for name in ("p0", "p1", "p2"):
        n = int(drawn.integers(1, 4))
        parts[name] = float(10 ** drawn.uniform(-4, -3)), n, int(drawn.integers(1, n + 1))
    offers = {name: (float(drawn.integers(1, 20)), int(drawn.integers(1, 3))) for name in parts}
    every = list(itertools.product(*(range(most + 1) for _, most in offers.values())))
    costs = [sum(n * cost for n, (cost, _) in zip(more, offers.values(), strict=True)) for more in every]
    fails = [failure(text(parts, wiring, more)) for more in every]
    made = robot(text(parts, wiring))
    for budget in (0.0, 15.0, 40.0):
        found = robophm.allocate(made, offers, budget=budget, hours=HOURS)
        assert found.failure == pytest.approx(
            min(f for f, c in zip(fails, costs, strict=True) if c <= budget), rel=1e-9
        )
        assert found.best
        assert found.cost <= budget
    for goal in (sorted(fails)[len(fails) // 3], max(fails)):
        wanted = goal * (1 + 1e-9)
        found = robophm.allocate(made, offers, reliability=1 - wanted, hours=HOURS)
        assert found.cost == min(c for f, c in zip(fails, costs, strict=True) if f <= wanted)
        assert found.best


def test_the_best_found_when_time_is_over_is_between_its_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    parts = {f"p{i}": (10 ** -(3 + i / 8), 1, 1) for i in range(14)}
    made = robot(text(parts, "{series: [" + ", ".join([*parts, "x"]) + "]}"))
    offers = {name: (1.0 + i % 5, 3) for i, name in enumerate(parts)}
    best = robophm.allocate(made, offers, budget=25.0)
    monkeypatch.setattr(redundancy, "MOST_CHOICES", 0)
    found = robophm.allocate(made, offers, budget=25.0, limit=1e-6)
    assert best.best
    assert not found.best
    assert found.bound <= best.failure <= found.failure
    dear = robophm.allocate(made, offers, reliability=1 - best.failure * 1.0001, limit=1e-6)
    assert dear.bound <= best.cost <= dear.cost


@pytest.mark.parametrize(
    ("offers", "goal", "said"),
    [
        ({"p9": (1.0, 1)}, {"budget": 1}, "no part 'p9'"),
        ({}, {"budget": 1}, "0 parts on offer"),
        ({"p0": (1.0, 1)}, {}, "either a budget or a reliability"),
        ({"p0": (1.0, 1)}, {"budget": 1, "reliability": 0.9}, "either a budget or a reliability"),
        ({"p0": (1.0, 1)}, {"reliability": 0.999999}, "still fails with"),
        ({"p0": (1.0, 1)}, {"reliability": 1.0}, "reliability 1"),
        ({"p0": (1.0, 1)}, {"budget": -1}, "budget"),
        ({"pump": (1.0, 1)}, {"budget": 5}, "drawn one by one"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_refused(offers: dict[str, tuple[float, int]], goal: dict[str, float], said: str) -> None:
    written = text({"p0": (1e-4, 1, 1)}, "{series: [p0, x, {parallel: ['pump[1]', {series: ['pump[2]', x]}]}]}")
    made = robot(written.replace("  x:", "  pump: {rate: 1e-4 /h, quantity: 2}\n  x:"))
    with pytest.raises(RobophmError, match=said):
        robophm.allocate(made, offers, **goal)
