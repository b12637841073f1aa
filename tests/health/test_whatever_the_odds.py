"""Robots that have outlived all that was expected of them: what is asked given that they work, against brute force.

A cumulative hazard above 745 makes exp(−H) less than any float; here they go up to 10⁵.
"""

from __future__ import annotations

import json
import math
from functools import cached_property
from itertools import combinations, product
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf
from tests.cases import some

from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Leg, Task
from robophm.health.effects import silent_states
from robophm.health.failures_to_come import failures_to_come
from robophm.health.fleet import Fleet
from robophm.health.importance import Drawn, importances
from robophm.health.mission import completion, consecutive_completions, deciding_components, repetitions
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.replacement import replacements
from robophm.health.uncertainty import completion_uncertainty, life_uncertainty

from ..structures import works

RATES = {"a": 0.5, "b": 2.0, "c": 0.25, "d": 1.0, "x": 0.125}
DIAGRAMS: dict[str, Any] = {
    "pair": {"parallel": ["a", "b"]},
    "three": {"parallel": ["a", "b", "c"]},
    "2 of 3": {"k_of_n": {"k": 2, "of": ["a", "b", "c"]}},
    "2 of 3 by shared parts": {"parallel": [{"series": p} for p in (["a", "b"], ["b", "c"], ["a", "c"])]},
    "pairs in series": {"series": ["x", {"parallel": ["a", "b"]}, {"parallel": ["c", "d"]}]},
    "a branch": {"parallel": [{"series": ["a", "b"]}, "c"]},
    "a shared branch": {"parallel": [{"series": ["a", "b"]}, {"series": ["a", "c"]}, {"series": ["c", "d"]}]},
}
LIVED = {
    "new": dict.fromkeys(RATES, 0.0),
    "young": {"a": 0.5, "b": 0.25, "c": 2.0, "d": 1.0, "x": 3.0},
    "600": {"a": 600.0, "b": 601.0, "c": 599.5, "d": 600.0, "x": 600.0},
    "746": {"a": 746.0, "b": 748.0, "c": 745.0, "d": 747.5, "x": 746.0},
    "a sum": {"a": 400.0, "b": 402.0, "c": 803.0, "d": 1.0, "x": 9.0},
    "1e5": {"a": 1e5, "b": 1e5 + 2, "c": 1e5 - 1, "d": 1e5 + 0.5, "x": 1e5},
    "mixed": {"a": 3e4, "b": 3e4 + 1, "c": 2.0, "d": 1e5, "x": 0.0},
}


def robot(diagram: Any, lived: dict[str, float], monitored: str = "", **more: Any) -> Robot:
    drawn = {name for name in RATES if f'"{name}"' in json.dumps(diagram)}
    components = {
        name: {"rate": f"{RATES[name]!r} /h", "initial_exposure": f"{lived[name] / RATES[name]!r} h",
               "monitored": name == monitored, **more}
        for name in RATES if name in drawn
    }  # fmt: skip
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, "diagram": diagram}))


class Brute:
    """All that can have become of every part, by now and by the end of some hours."""

    def __init__(self, design: Robot, lived: dict[str, float], monitored: str = "") -> None:
        self.diagram = design.diagram
        self.names = [part.path for part in design.components]
        self.past = {name: mpf(0) if name == monitored else mpf(lived[name]) for name in self.names}

    def chance(self, hours: Any, name: str) -> tuple[mpf, mpf, mpf]:
        alive, rate = mp.exp(-self.past[name]), mpf(RATES[name])
        return -mp.expm1(-self.past[name]), alive * -mp.expm1(-rate * hours), alive * mp.exp(-rate * hours)

    @cached_property
    def _outcomes(self) -> list[tuple[tuple[int, ...], bool, bool, dict[str, bool]]]:
        found = []
        for state in product(range(3), repeat=len(self.names)):
            now = dict(zip(self.names, (i > 0 for i in state), strict=True))
            end = dict(zip(self.names, (i > 1 for i in state), strict=True))
            found.append((state, works(self.diagram, now), works(self.diagram, end), end))
        return found

    def states(self, hours: Any) -> Any:
        """(weight, works now, works at the end, units up then) of every state."""
        weight = np.array([mpf(1)], dtype=object)
        for name in self.names:
            weight = np.multiply.outer(weight, np.array(self.chance(hours, name), dtype=object)).ravel()
        for one, (_, now, end, up) in zip(weight, self._outcomes, strict=True):
            yield one, now, end, up

    def ahead(self, hours: Any) -> tuple[mpf, mpf]:
        c, s = mpf(0), mpf(0)
        for weight, now, end, _ in self.states(hours):
            if now and end:
                s += weight
            elif now:
                c += weight
        return c / (c + s), s / (c + s)

    def rate(self) -> mpf:
        up = [(w, state) for w, now, _, state in self.states(0) if now]
        lost = mp.fsum(
            w * RATES[name]
            for w, state in up for name in self.names
            if state[name] and not works(self.diagram, state | {name: False})
        )  # fmt: skip
        return lost / mp.fsum(w for w, _ in up)


CASES = [(diagram, lived, "") for diagram in DIAGRAMS for lived in LIVED]
CASES += [("pair", "746", "b"), ("pair", "1e5", "a"), ("2 of 3", "1e5", "c"), ("a shared branch", "746", "a")]


def exact(value: Any, rel: float = 1e-12) -> Any:
    return pytest.approx(float(value), rel=rel, abs=0)


@pytest.mark.parametrize(("diagram", "lived", "monitored"), some(CASES))
def test_completion_rate_and_remaining_life(diagram: str, lived: str, monitored: str) -> None:
    design = robot(DIAGRAMS[diagram], LIVED[lived], monitored)
    outlook = as_designed(Plant(design))
    brute = Brute(design, LIVED[lived], monitored)
    fatal = [
        name for name in brute.names if not works(design.diagram, dict.fromkeys(brute.names, True) | {name: False})
    ]
    for name in fatal:  # what works cannot have lost it
        brute.past[name] = mpf(0)
    with mp.workdps(30):
        for hours in (1e-9, 3.0, 40.0):
            fails, survives = brute.ahead(mpf(hours))
            for task in (Task.plain(0, hours), Task((Leg(hours / 4), Leg(0.75 * hours)))):
                found = completion(outlook, task)
                assert (found.failure, found.probability) == (exact(fails), exact(survives))
        assert outlook.hazard_rate(design.diagram) == exact(brute.rate()) or brute.rate() == 0
        life = outlook.remaining_life(design.diagram)
        for time, level in ((life.early, 0.95), (life.median, 0.5), (life.late, 0.05)):
            assert brute.ahead(mpf(time))[1] == exact(level, 1e-11)
        if len(brute.names) < 4:
            mean = mp.quad(lambda t: brute.ahead(t)[1], [0, 1, 5, 30, 200], maxdegree=4)
            assert life.mean == exact(mean, 1e-8)
    fleet = Fleet.of([outlook, as_designed(Plant(design))])
    assert fleet.hazard_rate(design.diagram)[1] == exact(outlook.hazard_rate(design.diagram), 1e-14)
    assert fleet.ahead(design.diagram, 3.0)[0][0] == exact(completion(outlook, Task.plain(0, 3.0)).failure)


@pytest.mark.parametrize(("diagram", "lived"), [case[:2] for case in CASES if case[1] in ("young", "746", "1e5")][:21])
def test_what_it_hangs_on(diagram: str, lived: str) -> None:
    design = robot(DIAGRAMS[diagram], LIVED[lived])
    outlook, brute = as_designed(Plant(design)), Brute(design, LIVED[lived])
    for name in brute.names:
        if not works(design.diagram, dict.fromkeys(brute.names, True) | {name: False}):
            brute.past[name] = mpf(0)
    hours = mpf(0.5)
    found = importances(outlook, Drawn(outlook.plant, design.diagram), 0.5, lifelong=False)
    cuts = [set(some) for n in range(1, 5) for some in combinations(brute.names, n)
            if not works(design.diagram, {name: name not in some for name in brute.names})]  # fmt: skip
    minimal = [one for one in cuts if not any(other < one for other in cuts)]
    with mp.workdps(30):
        states = list(brute.states(hours))
        alive = mp.fsum(w for w, now, _, _ in states if now)
        fails = mp.fsum(w for w, now, end, _ in states if now and not end)
        assert found.failure == exact(fails / alive)
        for one in found.units:
            _, c, s = brute.chance(hours, one.unit)
            hangs = mp.fsum(
                w for w, _, _, end in states
                if works(design.diagram, end | {one.unit: True}) and not works(design.diagram, end | {one.unit: False})
            )  # fmt: skip
            assert one.birnbaum == exact((c + s) * hangs / alive)
            assert one.criticality == exact(c * hangs / fails)
            assert one.achievement == exact((fails + s * hangs) / fails)
            assert one.improvement == exact(c * hangs / alive)
            through = [cut for cut in minimal if one.unit in cut]
            seen = mp.fsum(
                w for w, now, end, up in states
                if now and not end and any(not any(up[name] for name in cut) for cut in through)
            )  # fmt: skip
            assert one.fussell_vesely == exact(seen / fails, 1e-11)
    for part in deciding_components(outlook, Task.plain(0, 0.5)):
        assert 0 <= part.failure_without < 1


def test_which_of_an_old_pair_will_fail_it() -> None:
    """One is left, and it is this one as its odds are: e^-H to e^-H."""
    design = robot(DIAGRAMS["pair"], LIVED["1e5"])
    outlook = as_designed(Plant(design))
    a, b = importances(outlook, Drawn(outlook.plant, design.diagram), 1.0).units
    assert a.barlow_proschan == exact(1 / (1 + mp.exp(-2)), 1e-9)
    assert b.barlow_proschan == exact(mp.exp(-2) / (1 + mp.exp(-2)), 1e-9)
    to_come = failures_to_come({"nominal": outlook, "sensor_based": outlook}, design.diagram, 1.0, 1.0)
    fails = {"a": -mp.expm1(-0.5) / (1 + mp.exp(-2)), "b": -mp.expm1(-2) * mp.exp(-2) / (1 + mp.exp(-2))}
    assert to_come.sensor_based_failure == exact(sum(fails.values()), 1e-5)
    found = {one.path: one.sensor_based for one in to_come.contributions}
    assert found == {name: exact(chance / sum(fails.values()), 1e-5) for name, chance in fails.items()}


def test_tasks_in_a_row_and_again_and_again() -> None:
    design = robot(DIAGRAMS["pair"], LIVED["746"])
    outlook, brute = as_designed(Plant(design)), Brute(design, LIVED["746"])
    with mp.workdps(30):
        lives = [brute.ahead(mpf(k))[1] for k in range(41)]
        given = [float(lives[k + 1] / lives[k]) for k in range(40)]
    found = consecutive_completions(outlook, [Task.plain(0, 1.0)] * 40)
    assert [one.probability for one in found] == [exact(one) for one in given]
    again = np.concatenate(list(repetitions(outlook, [Task.plain(0, 1.0)], 40)), axis=1)
    assert again[0].tolist() == [exact(one) for one in given]
    assert again[1] == pytest.approx(1 - again[0], rel=1e-12)


def test_what_replacing_one_would_gain() -> None:
    """The new one beside what is left of the old pair."""
    design = robot(DIAGRAMS["pair"], LIVED["1e5"])
    outlook = as_designed(Plant(design))
    found = {one.path: one for one in replacements(outlook, design.diagram, Task.plain(0, 1.0)).parts}
    with mp.workdps(30):
        left = {"a": 1 / (1 + mp.exp(-2)), "b": mp.exp(-2) / (1 + mp.exp(-2))}  # which of them works

        def without(new: str, hours: mpf) -> mpf:
            """P(fails): the other is the one that works, or it has failed and the new one stands alone."""
            (other,) = {"a", "b"} - {new}
            failed = {name: -mp.expm1(-RATES[name] * hours) for name in "ab"}
            return failed[new] * (left[new] + left[other] * failed[other])

        before = sum(left[name] * -mp.expm1(-mpf(RATES[name])) for name in "ab")
        for name in "ab":
            assert found[name].completion == exact(before - without(name, mpf(1)), 1e-10)


def test_uncertain_rates_of_what_is_old() -> None:
    """Two equally likely rates of a pair that works after 800 h: the lower one, by all that speaks for it."""
    more = {"uncertainty": {"samples": ["0.5 /h", "4 /h"]}, "rate": "2 /h", "initial_exposure": "800 h"}
    components = {"a": {**more, "quantity": 2, "required": 1}}
    outlook = as_designed(Plant(parse(json.dumps({"schema_version": 1, "name": "R", "components": components}))))
    found = completion_uncertainty(outlook, Task.plain(0, 1.0), draws=64)
    ratio = float(found.mean.failure)
    assert ratio == exact(-mp.expm1(-mpf("0.5")), 1e-9)
    life = life_uncertainty(outlook, outlook.plant.robot.diagram, draws=64)
    assert life.all_sources.median == exact(mp.log(2) / mpf("0.5"), 1e-4)


def test_what_may_have_failed_unseen() -> None:
    design = robot(DIAGRAMS["pair"], LIVED["746"])
    found = silent_states(as_designed(Plant(design)), design.diagram, 1.0)
    weights = dict(zip(found.states, found.weights.tolist(), strict=True))
    assert weights[frozenset("b")] == exact(1 / (1 + mp.exp(-2)), 1e-11)
    assert weights[frozenset("a")] == exact(mp.exp(-2) / (1 + mp.exp(-2)), 1e-11)


def test_what_has_failed_has_failed() -> None:
    """An infinite cumulative hazard leaves nothing to know: the other one of the pair works, or the robot does not."""
    life = {"life": {"distribution": "curve", "shape": 2.0}, "rate": "1 /h"}
    components = {"a": {**life, "initial_exposure": "1e6 h"}, "b": {"rate": "0.5 /h", "initial_exposure": "2e4 h"}}
    design = parse(json.dumps({"schema_version": 1, "name": "R", "components": components,
                               "diagram": {"parallel": ["a", "b"]}}))  # fmt: skip
    outlook = as_designed(Plant(design))
    assert outlook.unseen_hazard.tolist() == [math.inf, 1e4]
    assert completion(outlook, Task.plain(0, 1.0)).probability == exact(mp.exp(mpf("-0.5")))
    assert outlook.hazard_rate(design.diagram) == exact(0.5)
    assert outlook.remaining_life(design.diagram).mean == exact(2, 1e-9)
    dead: Outlook = as_designed(outlook.plant, Knowledge(failed=frozenset("b")))
    assert (completion(dead, Task.plain(0, 1.0)).probability, dead.remaining_life(design.diagram).mean) == (0.0, 0.0)
    assert dead.hazard_rate(design.diagram) == math.inf


@pytest.mark.parametrize("rate", [1.0, 100.0])
def test_the_hazard_rate_of_those_that_still_work_is_a_number_however_few_they_are(rate: float) -> None:
    """Of a pair of Weibull parts: f/R = 2 h q/(1 + q), with q = 1 − exp(−H); at H = 10⁸ nothing is left of R."""
    shape, hours = 4.0, np.array([0.0, 1.0, 100.0])
    worn = {"rate": f"{rate} /h", "quantity": 2, "required": 1, "life": {"distribution": "weibull", "shape": shape}}
    design = parse(json.dumps({"schema_version": 1, "name": "R", "components": {"a": worn}}))
    found = as_designed(Plant(design)).hazard_curve(design.diagram, hours)
    eta = 1 / (rate * mp.gamma(1 + 1 / mpf(shape)))
    for at, value in zip(hours.tolist(), found.tolist(), strict=True):
        h, q = shape / eta * (at / eta) ** (shape - 1), -mp.expm1(-((at / eta) ** shape))
        assert value == pytest.approx(float(2 * h * q / (1 + q)), rel=1e-11)
