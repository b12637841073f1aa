"""What is known of parts, by default, by report, by inspection and by replacement; closed forms in exact arithmetic."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from mpmath import mp, mpf

from robophm.core.errors import DesignError
from robophm.core.signal import HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Task
from robophm.design.task_file import parse_plan
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import MOST_HISTORY, Ledger
from robophm.health.mission import completion
from robophm.health.outlooks import as_designed, outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.uncertainty import completion_uncertainty

START = 1_700_000_000 * SECOND
HOT = {"temperature": {"topic": "/t", "field": "c", "unit": "degC", "max_age": "1e6 s", "range": [-40, 200]}}
Q10 = {"model": "q10", "reference_temperature": "25 degC"}
VIEWS = ("nominal", "sensor_based")


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def exact(value: Any, rel: float = 1e-12) -> Any:
    return pytest.approx(float(value), rel=rel, abs=1e-300)


class Life:
    """A robot that lives through hours at temperatures."""

    def __init__(self, design: Robot) -> None:
        self.design = design
        self.exposure = ExposureIntegrator(design)
        self.ledger = Ledger.new(design)
        self.ledger.started = self.now = START

    def live(self, hours: float, celsius: float) -> None:
        samples = [Sample(self.now, "/t.c", celsius)]
        self.now += round(hours * HOUR)
        self.exposure.integrate(self.ledger, samples, self.now)

    def keys(self, *paths: str) -> list[str]:
        return [mode.key for mode in self.design.modes if mode.path.split("/")[0] in paths]

    def restart(self) -> None:
        self.ledger = Ledger.of(self.design, json.loads(json.dumps(self.ledger.to_json())))

    def outlook(self, view: str, knowledge: Knowledge | None = None) -> Outlook:
        return outlooks(Plant(self.design), self.exposure, self.ledger, knowledge=knowledge)[view]  # type: ignore[index]


@dataclass
class Exact:
    """A part with h₀ = 2a/100² by hand: its clock age, its effective age, its weighed hazard, since new and seen."""

    scaling: str
    initial: Fraction = Fraction(10)

    def __post_init__(self) -> None:
        self.new(self.initial)

    def new(self, age: Fraction) -> None:
        self.age = self.effective = age
        self.hazard = self.since = {view: self.square(age) for view in VIEWS}

    @staticmethod
    def square(age: Fraction) -> Fraction:
        return (age / 100) ** 2

    def steps(self, hours: Fraction, factor: int) -> dict[str, Fraction]:
        """What so many hours add."""
        by_clock = self.square(self.age + hours) - self.square(self.age)
        by_age = self.square(self.effective + factor * hours) - self.square(self.effective)
        return {"nominal": by_clock, "sensor_based": factor * by_clock if self.scaling == "hazard" else by_age}

    def live(self, hours: Fraction, factor: int) -> None:
        more = self.steps(hours, factor)
        self.hazard = {view: self.hazard[view] + more[view] for view in VIEWS}
        self.since = {view: self.since[view] + more[view] for view in VIEWS}
        self.age, self.effective = self.age + hours, self.effective + factor * hours

    def seen(self) -> None:
        self.since = dict.fromkeys(VIEWS, Fraction(0))


WEAR = {
    "life": {"distribution": "weibull", "scale": "100 h", "shape": 2},
    "acceleration": Q10,
    "initial_exposure": "10 h",
}
EVENTS = {
    "nothing": (),
    "inspected": ((2, "inspect"),),
    "inspected at once": ((0, "inspect"),),
    "inspected at last": ((3, "inspect"),),
    "inspected twice": ((1, "inspect"), (2, "inspect")),
    "replaced": ((2, "replace"),),
    "replaced at last": ((3, "replace"),),
    "inspected, then replaced": ((1, "inspect"), (2, "replace")),
    "replaced, then inspected": ((1, "replace"), (2, "inspect")),
}
PAST = ((5, 45.0, 4), (3, 35.0, 2), (Fraction(1, 2), 55.0, 8))  # hours, °C, factor


@pytest.mark.parametrize("restart", [True, False])
@pytest.mark.parametrize("scaling", ["age", "hazard"])
@pytest.mark.parametrize("events", EVENTS)
def test_a_pair_of_which_one_is_inspected_or_replaced(events: str, scaling: str, restart: bool) -> None:
    part = {**WEAR, "scaling": scaling}
    life = Life(robot({"a": part, "b": part}, signals=HOT, max_gap="1e6 s", diagram={"parallel": ["a", "b"]}))
    a, b = Exact(scaling), Exact(scaling)
    for i in range(len(PAST) + 1):
        for when, what in EVENTS[events]:
            if when == i:
                getattr(life.ledger, what)(life.keys("b"))
                b.seen() if what == "inspect" else b.new(Fraction(0))
        if restart:
            life.restart()
        if i < len(PAST):
            hours, celsius, factor = PAST[i]
            life.live(float(hours), celsius)
            a.live(Fraction(hours), factor)
            b.live(Fraction(hours), factor)

    ahead = Fraction(4)
    for view in VIEWS:
        outlook = life.outlook(view)
        assert outlook.cumulative_hazard.tolist() == [exact(a.hazard[view]), exact(b.hazard[view])]
        assert outlook.unseen_hazard.tolist() == [exact(a.since[view]), exact(b.since[view])]
        more = [one.steps(ahead, 8)[view] for one in (a, b)]  # as in the last ten minutes
        now = [-mp.expm1(-mpf(one.since[view].numerator) / one.since[view].denominator) for one in (a, b)]
        end = [
            -mp.expm1(-(mpf((one.since[view] + step).numerator) / (one.since[view] + step).denominator))
            for one, step in zip((a, b), more, strict=True)
        ]
        works, fails = 1 - now[0] * now[1], end[0] * end[1] - now[0] * now[1]
        found = completion(outlook, Task.plain(0.0, float(ahead)))
        assert found.failure == exact(fails / works)
        assert found.probability == exact((works - fails) / works)


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("scaling", ["age", "hazard"])
@pytest.mark.parametrize("monitored", [True, False])
@pytest.mark.parametrize("said", ["", "failed", "working"])
def test_what_is_said_of_one_of_a_pair(said: str, monitored: bool, scaling: str, view: str) -> None:
    part = {**WEAR, "scaling": scaling}
    design = robot(
        {"a": part, "b": {**part, "monitored": monitored}},
        signals=HOT,
        max_gap="1e6 s",
        diagram={"parallel": ["a", "b"]},
    )
    life, one = Life(design), Exact(scaling)
    life.live(6, 45.0)
    one.live(Fraction(6), 4)
    knowledge = Knowledge(**{said: frozenset("b")}) if said else Knowledge()
    lived, more = (mpf(x.numerator) / x.denominator for x in (one.since[view], one.steps(Fraction(3), 4)[view]))
    unknown, known = -mp.expm1(-lived), -mp.expm1(-more)  # a has failed by now; b has by the end, if it works now
    if said == "failed":  # then a works, by that
        fails = known
    elif said == "working" or monitored:
        fails = -mp.expm1(-lived - more) * known
    else:
        fails = (mp.expm1(-lived - more) ** 2 - unknown**2) / (1 - unknown**2)
    found = completion(life.outlook(view, knowledge), Task.plain(0.0, 3.0))
    assert found.failure == exact(fails)
    assert found.probability == exact(1 - fails)
    both = life.outlook(view, Knowledge(failed=frozenset("ab")))
    assert (completion(both, Task.plain(0.0, 3.0)).failure, both.remaining_life(design.diagram).mean) == (1.0, 0.0)


def test_knowledge_of_a_task_file_is_of_its_units() -> None:
    """Inspected parts of a module, and one member of three, as said in the list of tasks."""
    part = {"rate": "0.01 /h", "initial_exposure": "50 h"}
    design = parse(
        json.dumps(
            {
                "schema_version": 1,
                "name": "R",
                "modules": {"M": {"components": {"x": part, "y": part}, "diagram": {"parallel": ["x", "y"]}}},
                "components": {"motor": {**part, "quantity": 3, "required": 1}},
            }
        )
    )
    text = "schema_version: 1\ntasks: [{duration: 10 h}]\nknowledge: {failed: ['motor[1]'], working: [M]}\n"
    plan = parse_plan(text, design)
    found = completion(as_designed(Plant(design), plan.knowledge), plan.tasks[0])
    q, now, end = (-mp.expm1(-mpf(0.01) * t) for t in (10, 50, 60))
    assert found.probability == exact((1 - q**2) * (1 - end**2) / (1 - now**2))
    assert found.failure == exact(1 - (1 - q**2) * (1 - end**2) / (1 - now**2))
    with pytest.raises(DesignError, match="M/x is said to have failed"):
        parse_plan(text.replace("motor[1]", "M/x"), design)


def test_replacing_a_part_resets_that_part_alone() -> None:
    design = robot(dict.fromkeys("abc", WEAR), signals=HOT, max_gap="1e6 s")
    life = Life(design)
    life.live(2, 45.0)
    before = life.ledger.copy()
    life.ledger.replace(life.keys("b"))
    for total in ("age", "effective", "hazard"):
        then, now = getattr(before, total).value.tolist(), getattr(life.ledger, total).value.tolist()
        assert now == [then[0], 0.0, then[2]]
    assert before.replaced == {}
    assert life.ledger.replaced == {life.keys("b")[0]: life.now}
    assert life.ledger.clocks.value.tolist() == before.clocks.value.tolist()
    assert [step.age.tolist() for step in life.ledger.history] == [step.age.tolist() for step in before.history]


def test_several_modes_of_a_part_are_replaced_and_inspected_together() -> None:
    rate, wear = {"rate": "0.01 /h"}, {"life": WEAR["life"], "initial_exposure": "10 h"}
    design = robot(
        {"a": {"failure_modes": {"open": rate, "worn": wear}}, "b": rate},
        max_gap="1e6 s",
        diagram={"parallel": ["a", "b"]},
    )
    life = Life(design)
    life.live(5, 25.0)
    new = mpf(0.05) + (mpf(15) ** 2 - 0) / 100**2
    assert completion(life.outlook("nominal"), Task.plain(0, 0.0)).probability == 1.0
    assert life.outlook("nominal").unseen_hazard.tolist() == [exact(0.05), exact(0.0225), exact(0.05)]
    assert life.outlook("nominal").survival(design.diagram).failed == exact(-mp.expm1(-new) * -mp.expm1(-mpf(0.05)))
    life.ledger.inspect(life.keys("a"))
    assert life.outlook("nominal").unseen_hazard.tolist() == [0.0, 0.0, exact(0.05)]
    life.ledger.replace(life.keys("a"))
    assert life.outlook("nominal").cumulative_hazard.tolist() == [0.0, 0.0, exact(0.05)]
    life.live(1, 25.0)
    assert life.outlook("sensor_based").cumulative_hazard.tolist() == [exact(0.01), exact(1e-4), exact(0.06)]


# The history of a ledger.


def wandering(hours: int, seed: int = 1) -> Life:
    """Some hours at ever other temperatures, with pauses in which the robot is silent."""
    parts = {
        "a": WEAR,
        "b": {**WEAR, "scaling": "hazard"},
        "c": {"rate": "1e-3 /h", "clock": "calendar"},
        "d": {"rate": "1e-3 /cycle", "clock": "cycles"},
    }
    life = Life(robot(parts, signals=HOT, usage={"cycles": "30 cycle/h"}, max_gap="10 min"))
    random = np.random.default_rng(seed)
    for _ in range(hours * 4):
        life.live(float(random.choice([0.1, 0.25, 0.4])), float(random.uniform(-10, 80)))
    return life


@pytest.mark.full
@pytest.mark.parametrize("hours", [1, 20, 300])
def test_the_history_is_bounded_and_adds_up(hours: int) -> None:
    ledger = wandering(hours).ledger
    assert 0 < len(ledger.history) <= MOST_HISTORY
    assert sum(step.age for step in ledger.history) == pytest.approx(ledger.age.value, rel=1e-12)
    assert sum(step.effective for step in ledger.history) == pytest.approx(ledger.effective.value, rel=1e-12)
    operating, calendar, *_ = ledger.clocks.value
    assert sum(step.operating for step in ledger.history) == pytest.approx(operating, rel=1e-12)
    assert sum(step.calendar for step in ledger.history) == pytest.approx(calendar, rel=1e-12)
    ends = [step.end for step in ledger.history]
    assert ends == sorted(set(ends))
    assert ends[-1] == ledger.integrated_to
    slots = [(end - 1) // ledger.history_step for end in ends]
    assert len(set(slots)) == len(slots)
    assert ledger.history_step in {HOUR << n for n in range(10)}


def test_a_restart_keeps_history_and_recents_bit_for_bit() -> None:
    life = wandering(40)
    life.ledger.inspect(life.keys("a"))
    life.ledger.replace(life.keys("b"))
    kept = life.ledger
    life.restart()
    again = life.ledger
    assert json.dumps(again.to_json()) == json.dumps(kept.to_json())
    for name in ("recent", "history"):
        for one, other in zip(getattr(again, name), getattr(kept, name), strict=True):
            assert one[:3] == other[:3]
            assert one.age.tobytes() == other.age.tobytes()
            assert one.effective.tobytes() == other.effective.tobytes()
            assert one.inputs == other.inputs
    assert (again.seen, again.replaced, again.history_step) == (kept.seen, kept.replaced, kept.history_step)


def test_a_run_with_restarts_is_the_run_without() -> None:
    parts = {"a": WEAR, "b": {**WEAR, "scaling": "hazard"}}
    design = robot(parts, signals=HOT, max_gap="10 min")
    one, other = Life(design), Life(design)
    random = np.random.default_rng(5)
    for i in range(300):
        hours, celsius = float(random.choice([0.1, 1.0, 3.0])), float(random.uniform(0, 60))
        one.live(hours, celsius)
        other.live(hours, celsius)
        if i % 7 == 0:
            other.restart()
    assert json.dumps(one.ledger.to_json()) == json.dumps(other.ledger.to_json())


def test_looking_ahead_leaves_no_trace() -> None:
    life = wandering(3)
    before = json.dumps(life.ledger.to_json())
    ahead = life.ledger.copy()
    life.exposure.integrate(ahead, [Sample(life.now, "/t.c", 99.0)], life.now + 50 * HOUR)
    ahead.replace(life.keys("a"))
    ahead.inspect(life.keys("b"))
    assert json.dumps(life.ledger.to_json()) == before


def test_recent_inputs_are_the_mean_of_the_signal() -> None:
    """Of the last ten minutes, as far as it had a value: 3 min at 30 °C, 4 min silent, 3 min at 60 °C."""
    signals = {"temperature": {**HOT["temperature"], "max_age": "30 s"}}
    design = robot({"a": {"rate": "1e-3 /h", "acceleration": Q10}}, signals=signals, max_gap="1 h")
    life = Life(design)
    samples = [Sample(START + i * 30 * SECOND, "/t.c", 90.0) for i in range(40)]  # twenty minutes before
    for i in range(20):
        if not 6 <= i < 14:
            samples.append(Sample(START + (1200 + i * 30) * SECOND, "/t.c", 30.0 if i < 6 else 60.0))
    for n in range(0, 1800, 30):
        at = START + n * SECOND
        chunk = [sample for sample in samples if at <= sample.time < at + 30 * SECOND]
        life.exposure.integrate(life.ledger, chunk, at + 30 * SECOND)
    (mean,) = life.exposure.recent_inputs(life.ledger).values()
    assert mean == exact(45.0)
    factor = ((6 + 8) * mpf(2) ** mpf("0.5") + 6 * mpf(2) ** mpf("3.5")) / 20  # as last heard while it is silent
    assert life.exposure.recent_factor(life.ledger).tolist() == [exact(factor)]
    life.restart()
    assert list(life.exposure.recent_inputs(life.ledger).values()) == [mean]


def test_without_a_value_there_is_no_recent_input() -> None:
    design = robot({"a": {"rate": "1e-3 /h", "acceleration": Q10}}, signals=HOT)
    life = Life(design)
    assert life.exposure.recent_inputs(life.ledger) == {}
    life.exposure.integrate(life.ledger, [Sample(START, "/t.c", 999.0)], START + HOUR)  # out of range
    assert life.exposure.recent_inputs(life.ledger) == {}


def test_a_part_that_failed_since_it_was_seen_to_work_tells_of_its_rate() -> None:
    """One of a pair failed between 100 h and 300 h, the other works: each rate by the probability of both."""
    rates = [mpf("0.001"), mpf("0.02")]
    part = {"rate": "0.001 /h", "quantity": 2, "required": 1, "initial_exposure": "300 h"}
    design = robot({"a": part | {"uncertainty": {"samples": ["0.001 /h", "0.02 /h"]}}})
    outlook = as_designed(Plant(design), Knowledge(failed=frozenset({"a[1]"}), working=frozenset({"a[2]"})))
    outlook = replace(outlook, seen_age=np.array([100.0]), unseen_hazard=np.array([0.2]))
    weights = [(mp.exp(-100 * rate) - mp.exp(-300 * rate)) * mp.exp(-300 * rate) for rate in rates]
    expected = sum(w * -mp.expm1(-10 * rate) for w, rate in zip(weights, rates, strict=True)) / sum(weights)
    task = Task.plain(0.0, 10.0)
    assert completion_uncertainty(outlook, task, draws=10).mean.failure == pytest.approx(float(expected), rel=1e-12)


def test_nothing_to_do_is_done_at_every_rate() -> None:
    design = robot({"a": {"rate": "0.001 /h", "uncertainty": {"error_factor": 3}}})
    found = completion_uncertainty(as_designed(Plant(design)), Task(()), draws=10)
    assert (found.mean.probability, found.mean.failure, *found.failure) == (1.0, 0.0, 0.0, 0.0, 0.0)
