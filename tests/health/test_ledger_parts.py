"""The past outlives the design: parts come and go, and what every other part has behind it stays bit for bit."""

from __future__ import annotations

import json
import random
from typing import Any

import pytest

from robophm.core.errors import StoreError
from robophm.core.signal import HOUR, Sample
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.health.ledger_parts import brought_to
from robophm.monitoring.monitor import Monitor

from .exposures import ALWAYS_ON, LEDGER, Q10, START, monitor, robot, settled

MOTOR = {"rate": "1e-4 /h", "acceleration": {**Q10, "reference_temperature": "25 degC"}}
ALONE = {"motor": MOTOR}
BOTH = {"motor": MOTOR, "fan": {"rate": "2e-4 /h"}}


def design(components: dict[str, Any]) -> Robot:
    return robot(components, **ALWAYS_ON)


def hours(begin: float, end: float) -> list[Sample]:
    """Samples each half hour, at 35 °C."""
    times = [begin + 0.5 * i for i in range(round(2 * (end - begin)) + 1)]
    return [Sample(START + round(time * HOUR), "/t.c", 35.0) for time in times]


def follow(ledger: Ledger, components: dict[str, Any]) -> Ledger:
    """The ledger after it was kept, for a design that was edited meanwhile."""
    return Ledger.of(design(components), json.loads(json.dumps(ledger.to_json())))


def ages(ledger: Ledger) -> dict[str, float]:
    return {key.partition(" ")[0]: float(age) for key, age in zip(ledger.modes, ledger.age.value, strict=True)}


def exact_ages(**hours: float) -> Any:
    return pytest.approx(hours, rel=1e-12, abs=0)


def test_a_part_that_came_later_is_counted_from_then_and_that_is_said() -> None:
    before = settled(design(ALONE), hours(0, 10))
    after = monitor(design(BOTH), hours(10.5, 20), ledger=follow(before, BOTH))
    whole = settled(design(ALONE), [*hours(0, 10), *hours(10.5, 20)])
    report = after.report()
    now = ages(after.exposure.settled(after.ledger))
    assert now == exact_ages(motor=20, fan=10)
    assert ages(whole) == exact_ages(motor=20)
    assert [note for note in report.notes if note.startswith("fan: counted since ")] == list(report.notes)
    assert Monitor(design(BOTH)).report().notes == ()


def test_a_part_that_is_gone_and_comes_back_goes_on() -> None:
    both = settled(design(BOTH), hours(0, 10))
    alone = settled_on(design(ALONE), follow(both, ALONE), hours(10.5, 20))
    assert ages(alone) == exact_ages(motor=20)
    again = settled_on(design(BOTH), follow(alone, BOTH), hours(20.5, 30))
    assert ages(again) == exact_ages(motor=30, fan=20)
    assert Monitor(design(BOTH), again).report().notes == ()


def settled_on(of: Robot, ledger: Ledger, samples: list[Sample]) -> Ledger:
    after = monitor(of, samples, ledger=ledger)
    return after.exposure.settled(after.ledger)


def test_what_has_lived_already_gets_no_new_way_to_fail_at_age_zero() -> None:
    """Nor is a part that may have got another name taken for a new one."""
    kept = settled(design(BOTH), hours(0, 10)).to_json()
    one = {"modes": ["motor (operating, age scaling)"]}
    with pytest.raises(StoreError, match="by which what has lived already can fail too"):
        brought_to({**kept, **one}, {"motor": [*one["modes"], "motor/wear (operating, age scaling)"]})
    with pytest.raises(StoreError, match="under another name is not known"):
        Ledger.of(design({"motor": MOTOR, "blower": {"rate": "2e-4 /h"}}), kept)


def test_in_a_ledger_of_parts_that_never_changed_nothing_is_new() -> None:
    assert not {"begun", "archived"} & LEDGER.keys()


@pytest.mark.parametrize("seed", range(200))
def test_whatever_comes_and_goes_what_stays_is_the_same_bit_for_bit(seed: int) -> None:
    rng = random.Random(seed)
    modes = list(LEDGER["modes"])
    now, extra = LEDGER, [f"extra {i} (operating, age scaling)" for i in range(3)]
    truth = sums(LEDGER)
    for _ in range(12):
        there = list(now["modes"])
        if rng.random() < 0.5 and len(there) > 1:
            chosen = [key for key in there if rng.random() < 0.7] or there[:1]
        else:
            chosen = [*there, *(key for key in [*modes, *extra] if key not in there and rng.random() < 0.5)]
        rng.shuffle(chosen)
        now = through_a_file(now, chosen)
        assert {key: sums(now)[key] for key in chosen if key in modes} == {
            key: truth[key] for key in chosen if key in modes
        }
        assert all(set(sums(now)[key]) == {0.0} for key in chosen if key in extra)
        assert set(now.get("begun", {})) <= set(extra)
        assert now["services"] == LEDGER["services"]
    back = through_a_file(now, [*{*now["modes"], *modes}])
    for name in ("replaced", "seen"):
        assert back[name] == LEDGER[name]
    assert {key: sums(back)[key] for key in modes} == truth


def through_a_file(data: Any, chosen: list[str]) -> Any:
    """A ledger kept, and read back for a design of parts with these modes, each of a part of its own."""
    found = Ledger.from_json(brought_to(data, {key: [key] for key in chosen}), tuple(chosen), ())
    return json.loads(json.dumps(found.to_json()))


def sums(data: Any) -> dict[str, tuple[float, ...]]:
    parts = [part for name in ("age", "effective", "hazard") for part in data["totals"][name]]
    return {key: tuple(part[i] for part in parts) for i, key in enumerate(data["modes"])}
