"""The past outlives the design: parts come, go and get other names, and what each has behind it stays bit for bit."""

from __future__ import annotations

import json
import random
from copy import deepcopy
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from tests.cases import examples

from robophm.core.errors import DesignError, StoreError
from robophm.core.signal import HOUR, Sample
from robophm.design import editing, identity_edits
from robophm.design.file import parse
from robophm.design.identities import identities
from robophm.design.identity_edits import Lived
from robophm.design.robot import Robot
from robophm.health.ledger import Ledger
from robophm.health.ledger_parts import Fate, fates, lived
from robophm.monitoring.monitor import Monitor

from .exposures import ALWAYS_ON, LEDGER, Q10, SHOP, START, monitor, robot, settled

MOTOR = {"rate": "1e-4 /h", "acceleration": {**Q10, "reference_temperature": "25 degC"}}
ALONE = {"motor": MOTOR}
FAN = {"rate": "2e-4 /h"}
BOTH = {"motor": MOTOR, "fan": FAN}


def design(components: dict[str, Any], **more: Any) -> Robot:
    return robot(components, **ALWAYS_ON, **more)


def hours(begin: float, end: float) -> list[Sample]:
    """Samples each half hour, at 35 °C."""
    times = [begin + 0.5 * i for i in range(round(2 * (end - begin)) + 1)]
    return [Sample(START + round(time * HOUR), "/t.c", 35.0) for time in times]


def kept(ledger: Ledger) -> Any:
    return json.loads(json.dumps(ledger.to_json(), allow_nan=False))


def follow(ledger: Ledger, components: dict[str, Any]) -> Ledger:
    """The ledger after it was kept, for a design that was edited meanwhile."""
    return Ledger.of(design(components), kept(ledger))


def ages(ledger: Ledger) -> dict[str, float]:
    """The age of each failure mode, by its identity."""
    return {key.partition(" (")[0]: float(age) for key, age in zip(ledger.modes, ledger.age.value, strict=True)}


def exact_ages(**hours: float) -> Any:
    return pytest.approx({name.replace("_", " "): age for name, age in hours.items()}, rel=1e-12, abs=0)


def settled_on(of: Robot, ledger: Ledger, samples: list[Sample]) -> Ledger:
    after = monitor(of, samples, ledger=ledger)
    return after.exposure.settled(after.ledger)


def fate(ledger: Ledger, components: dict[str, Any], path: str) -> Fate:
    """What becomes of one part under another design."""
    (found,) = [one for one in fates(kept(ledger), identities(design(components))) if one.path == path]
    return found


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
    assert [(one.part, one.kind) for one in again.changes] == [("fan", "removed"), ("fan", "back")]


def test_another_part_of_the_same_name_does_not_take_the_past_of_one_that_was_removed() -> None:
    alone = follow(settled(design(BOTH), hours(0, 10)), ALONE)
    other = {"rate": "7e-5 /h"}
    assert fate(alone, {**ALONE, "fan": other}, "fan")[1] == "asked"
    with pytest.raises(StoreError, match="'fan' is not as the part of this name was that was removed before"):
        follow(alone, {**ALONE, "fan": other})
    new = follow(alone, {**ALONE, "fan": {**other, "identity": "fan 2"}})
    old = follow(alone, {**ALONE, "fan": {**other, "identity": "fan"}})
    assert ages(new) == exact_ages(motor=10, fan_2=0)
    assert ages(old) == exact_ages(motor=10, fan=10)


def test_what_has_lived_already_gets_no_new_way_to_fail_at_age_zero() -> None:
    before = settled(design({"motor": {"failure_modes": {"wear": FAN}}}), hours(0, 10))
    with pytest.raises(StoreError, match=r"'motor/burn .* is new in a part that has lived"):
        follow(before, {"motor": {"failure_modes": {"wear": FAN, "burn": FAN}}})


def test_a_part_under_another_name_is_asked_about_and_each_answer_is_followed() -> None:
    before = settled(design(BOTH), hours(0, 10))
    renamed = {"motor": MOTOR, "blower": FAN}
    assert fate(before, renamed, "blower")[:4] == ("blower", "asked", "", ("fan",))
    with pytest.raises(
        StoreError, match="'blower' has no past, and 'fan' has one, but is gone: whether that is the same part"
    ):
        follow(before, renamed)
    same = follow(before, {"motor": MOTOR, "blower": {**FAN, "identity": "fan"}})
    new = follow(before, {"motor": MOTOR, "blower": {**FAN, "identity": "blower"}})
    assert ages(same) == exact_ages(motor=10, fan=10)
    assert ages(new) == exact_ages(motor=10, blower=0)
    assert [tuple(one) for one in same.changes] == [(before.integrated_to, "blower", "renamed", "fan")]
    assert [one[1:3] for one in new.changes] == [("blower", "new"), ("fan", "removed")]


def test_two_that_swap_their_names_by_hand_never_swap_their_pasts_unnoticed() -> None:
    """Also where their rates change with their names: what else they are tells them."""
    alone = settled(design(ALONE), hours(0, 5))
    before = settled_on(design(BOTH), follow(alone, BOTH), hours(5.5, 10))
    assert ages(before) == exact_ages(motor=10, fan=5)
    for motor, fan in ((MOTOR, FAN), ({**MOTOR, "rate": "3e-4 /h"}, {"rate": "4e-4 /h"})):
        swapped = {"motor": fan, "fan": motor}
        found = fate(before, swapped, "motor")
        assert (found.kind, found.candidates) == ("asked", ("fan", "motor"))
        with pytest.raises(
            StoreError,
            match="'motor' is not as it was, and is now rather as 'fan' was: whether names have changed",
        ):
            follow(before, swapped)
        other = {"motor": {**fan, "identity": "fan"}, "fan": {**motor, "identity": "motor"}}
        after = follow(before, other)
        assert ages(after) == exact_ages(motor=10, fan=5)
        assert {mode.path: mode.identity for mode in design(other).modes} == {"motor": "fan", "fan": "motor"}
        stays = {"motor": {**fan, "identity": "motor"}, "fan": {**motor, "identity": "fan"}}
        assert ages(follow(before, stays)) == exact_ages(motor=10, fan=5)


def test_equal_parts_that_are_told_apart_each_have_the_past_of_all() -> None:
    before = settled(design({"motor": {**MOTOR, "quantity": 2}}), hours(0, 10))
    left, right = ({**MOTOR, "identity": f"motor[{i}]"} for i in (1, 2))
    after = settled_on(
        design({"left": left, "right": right}), follow(before, {"left": left, "right": right}), hours(10.5, 20)
    )
    assert ages(after) == exact_ages(**{"motor[1]": 20, "motor[2]": 20})
    assert [one[1:] for one in after.changes] == [
        ("left", "split", "motor"),
        ("right", "split", "motor"),
        ("motor", "removed", ""),
    ]
    whole = settled(design({"motor": MOTOR}), [*hours(0, 10), *hours(10.5, 20)])
    assert list(after.effective.value) == pytest.approx([whole.effective.value[0]] * 2, rel=1e-12)


def test_a_common_cause_that_is_new_has_aged_as_its_members() -> None:
    pair = {"common_causes": {"pair": {"of": ["a", "b"], "beta": 0.1}}}
    worn = {"life": {"distribution": "weibull", "scale": "40 h", "shape": 2.5}, "scaling": "hazard"}
    for part in (MOTOR, {**worn, "acceleration": MOTOR["acceleration"]}):
        parts = {"a": part, "b": part}
        after = Ledger.of(design(parts, **pair), kept(settled(design(parts), hours(0, 10))))
        always = settled(design(parts, **pair), hours(0, 10))
        assert len(after.modes) == 4
        for name in ("age", "effective", "hazard"):
            assert list(getattr(after, name).value) == list(getattr(always, name).value)


def test_a_robot_that_has_not_lived_is_asked_nothing() -> None:
    assert ages(follow(Ledger.new(design(BOTH)), {"wheel": FAN})) == {"wheel": 0}


def test_two_parts_never_share_one_past() -> None:
    with pytest.raises(Exception, match=r"b.*: its past would be that of a, whose identity is 'a'"):
        design({"a": FAN, "b": {**FAN, "identity": "a"}})


def test_stores_of_before_parts_were_remembered_are_read() -> None:
    old = {key: said for key, said in LEDGER.items() if key not in ("parts", "changes", "begun", "archived")}
    names = dict.fromkeys(key.partition(" (")[0].partition("/")[0] for key in LEDGER["modes"])
    assert len(names) > 2
    parts = [one for one in identities(SHOP) if not one.members]
    assert {one.kind for one in fates(old, parts)} == {"same"}
    left = fates(old, parts[1:])
    assert [(one.path, one.kind) for one in left if one.kind != "same"] == [(parts[0].path, "removed")]


_parsed = lru_cache(maxsize=8)(parse)


class Course:
    """A random course of edits of a design, and beside it, in a plain dictionary, what each part has lived through.

    A part is known to the dictionary by its ``source``, which the engine makes nothing of.
    """

    def __init__(self, seed: int) -> None:
        self.rng = random.Random(seed)
        self.serial = 0
        self.document: dict[str, Any] = {"schema_version": 1, "name": "R", "modules": {}, "components": {}}
        for _ in range(3):
            self.document["components"][self.name()] = self.part()
        for _ in range(2):
            self.document["modules"][self.name()] = {"components": {self.name(): self.part() for _ in range(2)}}
        self.before: list[dict[str, Any]] = []
        self.ledger = Ledger.new(self.robot)
        self.truth: dict[str, int] = {}
        self.live()

    @property
    def robot(self) -> Robot:
        return _parsed(json.dumps(self.document))

    def name(self) -> str:
        """Few names, so that they are used again."""
        taken = {name for level in self.levels() for kind in editing.PARTS for name in level.get(kind, ())}
        return self.rng.choice([one for one in "abcdefghijklmnopqrstuvwxyz" if one not in taken])

    def part(self) -> dict[str, Any]:
        self.serial += 1
        return {"rate": f"{self.serial}e-6 /h", "source": f"#{self.serial}"}

    def levels(self) -> list[dict[str, Any]]:
        return [self.document, *self.document.get("modules", {}).values()]

    def places(self, kind: str) -> list[tuple[str, ...]]:
        """The places of components or modules."""
        modules = list(self.document.get("modules", {}))
        if kind == "modules":
            return [("modules", name) for name in modules]
        inside = [("modules", m, kind, c) for m in modules for c in self.document["modules"][m].get(kind, ())]
        return [*((kind, name) for name in self.document.get(kind, ())), *inside]

    def live(self) -> None:
        """Every part grows older by some hours of its own: whole numbers, which sums lose nothing of."""
        new = [float(self.rng.randrange(1, 1000)) for _ in self.ledger.modes]
        for total in (self.ledger.age, self.ledger.effective):
            total.add(np.array(new))
        self.ledger.integrated_to = (self.ledger.integrated_to or START) + HOUR
        for mode, hours in zip(self.robot.modes, new, strict=True):
            self.truth[mode.source] = self.truth.get(mode.source, 0) + int(hours)

    def edit(self) -> None:
        """One edit, by the page or by hand; one by hand that makes it no design is taken back."""
        self.before.append(deepcopy(self.document))
        by_page = [self._add, self._remove, self._rename, self._rename, self._move, self._change, self._undo]
        chosen = self.rng.choice([*by_page, self._by_hand, self._swap])
        chosen()
        try:
            assert self.robot
        except DesignError:
            assert chosen not in by_page
            self.document = self.before.pop()

    def lived(self) -> Lived:
        return lived(self.ledger.to_json(), identities(self.robot))

    def _add(self) -> None:
        where = self.rng.choice([(), *self.places("modules")])
        identity_edits.put(self.document, (*where, "components", self.name()), self.part(), self.lived())

    def _remove(self) -> None:
        doomed = self.rng.choice(self.places("components"))
        level = editing.value_at(self.document, doomed[:-2])
        if len(level["components"]) > 1:
            editing.delete(self.document, doomed)

    def _rename(self) -> None:
        path = self.rng.choice([*self.places("components"), *self.places("modules")])
        identity_edits.rename(self.document, path, self.name(), self.lived())

    def _move(self) -> None:
        path = self.rng.choice(self.places("components"))
        to = self.rng.choice([(), *self.places("modules")])
        taken = {
            *editing.value_at(self.document, to).get("components", ()),
            *(self.document["modules"] if not to else ()),
        }
        if len(editing.value_at(self.document, path[:-1])) > 1 and path[-1] not in taken:
            identity_edits.move(self.document, path, to, self.lived())

    def _change(self) -> None:
        self.serial += 1
        part = editing.value_at(self.document, self.rng.choice(self.places("components")))
        part["rate"] = f"{self.serial}e-6 /h"
        part["quantity"] = self.rng.randrange(1, 4)

    def _undo(self) -> None:
        self.document = deepcopy(self.rng.choice(self.before[-3:]))

    def _by_hand(self) -> None:
        path = self.rng.choice(self.places("components"))
        editing.rename(self.document, path, self.name())

    def _swap(self) -> None:
        one, other = self.rng.sample(self.places("components"), 2)
        first, second = (editing.value_at(self.document, place) for place in (one, other))
        editing.value_at(self.document, one[:-1])[one[-1]] = second
        editing.value_at(self.document, other[:-1])[other[-1]] = first

    def answer(self, known: dict[str, str]) -> None:
        """Answer what is asked as a person who knows would: which part it was, or that it is new."""
        data = self.ledger.to_json()
        for _ in range(20):
            asked = [one for one in fates(data, identities(self.robot)) if one.kind == "asked"]
            if not asked:
                return
            for one in asked:
                place = next(place for place in self.places("components") if "/".join(place[1::2]) == one.path)
                source = editing.value_at(self.document, place)["source"]
                identity_edits.state(self.document, one.path, known.get(source, f"new {source}"))
        raise AssertionError("asked again and again")


@pytest.mark.parametrize("seed", range(examples(200)))
def test_whatever_is_edited_what_every_part_has_behind_it_stays_bit_for_bit(seed: int) -> None:
    course = Course(seed)
    known = {mode.source: mode.identity for mode in course.robot.modes}
    for _ in range(5):
        for _ in range(course.rng.randrange(1, 3)):
            course.edit()
        course.answer(known)
        course.ledger = Ledger.of(course.robot, kept(course.ledger))
        found = {mode.source: float(age) for mode, age in zip(course.robot.modes, course.ledger.age.value, strict=True)}
        assert found == {source: course.truth.get(source, 0) for source in found}
        course.live()
        known |= {mode.source: mode.identity for mode in course.robot.modes}
