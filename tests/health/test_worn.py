"""Wear in the place of a hazard: closed forms, brute force and simulation of what then becomes of a robot."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from robophm.design.file import parse
from robophm.design.task import Knowledge, Leg, Task
from robophm.health.failures_to_come import failures_to_come
from robophm.health.foretold_life import ForetoldLife
from robophm.health.importance import Drawn, importances
from robophm.health.mission import completion, consecutive_completions, repetitions
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.replacement import replaced, replacements
from robophm.health.uncertainty import completion_uncertainty, life_uncertainty
from robophm.health.worn import SeenWear, with_wear

ROBOT = """
schema_version: 1
name: R
components:
  battery: {rate: 100 FPMH}
  computer: {rate: 200 FPMH}
  left: {rate: 300 FPMH}
  right: {rate: 300 FPMH}
diagram: {series: [battery, computer, {parallel: [left, right]}]}
functions:
  drive: {series: [battery, left]}
  see: {series: [battery, computer, {parallel: [left, right]}]}
"""


def weibull(scale: float, shape: float) -> ForetoldLife:
    """A line in ln H over ln t: the curve through its points is the Weibull itself."""
    t = np.geomspace(scale / 2, scale * 1.5, 9)
    return ForetoldLife(tuple(t), tuple((t / scale) ** shape))


def seen(mode: str, life: ForetoldLife, **said) -> SeenWear:
    return SeenWear(mode, mode, "a signal", "foretold", "h", 100, 1.0, life=life, **({"never": 0.0} | said))


def robot(text: str = ROBOT):
    return as_designed(Plant(parse(text)))


def worn(*some: SeenWear, text: str = ROBOT):
    return with_wear(robot(text), some)


LIFE = weibull(4000.0, 6.0)
T = np.array([10.0, 2000.0, 5000.0])


def of_battery(t):
    return (np.asarray(t) / 4000.0) ** 6


def pair(t, left=300e-6):
    return 1 - (-np.expm1(-left * t)) * (-np.expm1(-300e-6 * t))


def test_a_curve_through_the_quantiles_of_a_weibull_is_that_weibull():
    t = np.array([1.0, 100.0, 3000.0, 9000.0])
    assert LIFE.cumulative_hazard(t) == pytest.approx(of_battery(t), rel=1e-12)
    assert LIFE.hazard(t) == pytest.approx(6 / 4000 * (t / 4000) ** 5, rel=1e-12)
    assert LIFE.increment(3000.0, 1e-7) == pytest.approx(1e-7 * 6 / 4000 * 0.75**5, rel=1e-9)
    assert LIFE.age_at(of_battery(t)) == pytest.approx(t, rel=1e-12)


def test_quantiles_of_draws_are_kept_and_what_never_comes_is_told():
    passage = np.sort(np.random.default_rng(0).weibull(3.0, 3000) * 50)

    def hazard(t):
        return -np.log1p(-np.interp(t, passage, (np.arange(3000) + 0.5) / 4000, left=0.0))

    life, never = ForetoldLife.through(hazard, 20.0)
    assert never == pytest.approx(0.25, abs=2e-4)
    assert life.quantile([0.05, 0.5, 0.95]) == pytest.approx(np.quantile(passage, [0.05, 0.5, 0.95]), rel=2e-3)
    assert ForetoldLife.through(lambda t: np.zeros(len(t)), 20.0) == (None, 1.0)


def test_survival_and_hazard_rate_in_closed_form_through_redundancy():
    outlook = worn(seen("battery", LIFE, aged=None))
    diagram = outlook.plant.robot.diagram
    fails, works = outlook.curve(diagram)(T)
    survives = np.exp(-of_battery(T) - 200e-6 * T) * pair(T)
    assert works == pytest.approx(survives, rel=1e-11)
    assert fails == pytest.approx(1 - survives, rel=1e-9)
    assert outlook.reliability_curve(diagram, T)[0] == pytest.approx(survives, rel=1e-11)
    one = worn(seen("left", LIFE))
    left = 1 - (-np.expm1(-of_battery(T))) * (-np.expm1(-300e-6 * T))
    assert one.curve(diagram)(T)[1] == pytest.approx(np.exp(-300e-6 * T) * left, rel=1e-11)
    step = 1e-3
    slope = -np.diff(np.log(one.curve(diagram)(np.array([2000.0, 2000.0 + step]))[1]))[0] / step
    assert one.hazard_curve(diagram, np.array([2000.0]))[0] == pytest.approx(slope, rel=1e-5)


def test_since_the_last_reading_it_is_not_known_to_work():
    """A reading 500 h old: in a pair that works, the worn part may have failed unseen meanwhile."""
    outlook = replace(robot(), age=np.full(4, 3500.0), new_age=np.zeros(4))
    outlook = with_wear(outlook, [seen("left", LIFE, aged=3000.0)])
    p = math.exp(-float(of_battery(500.0)))
    ahead = np.array([700.0])
    left = math.exp(-float(of_battery(1200.0)))  # works at the end; the right one is known to nothing but as new
    right = math.exp(-300e-6 * 700.0)
    assert outlook.log_works(outlook.plant.robot.diagram) == pytest.approx(0.0, abs=1e-12)  # the right one is new
    found = outlook.curve(outlook.plant.robot.diagram)(ahead)[1][0]
    assert found == pytest.approx(math.exp(-300e-6 * 700) * (1 - (1 - left) * (1 - right)), rel=1e-10)
    alone = outlook.curve(outlook.plant.alone[2])(ahead)[1][0]
    assert alone == pytest.approx(left / p, rel=1e-10)


def test_a_mode_by_chance_stays_in_series_and_a_share_of_one_does_too():
    modes = """
schema_version: 1
name: R
components:
  motor: {failure_modes: {brushes: {rate: 100 FPMH}, winding: {rate: 50 FPMH}}}
"""
    outlook = worn(SeenWear("motor/brushes", "motor", "", "foretold", "h", 9, 1.0, life=LIFE, never=0.0), text=modes)
    by_wear = np.exp(-of_battery(T) - 50e-6 * T)
    assert outlook.curve(outlook.plant.robot.diagram)(T)[1] == pytest.approx(by_wear, rel=1e-11)
    outlook = worn(seen("battery", LIFE, share=0.8))
    found = outlook.curve(outlook.plant.alone[0])(T)[1]
    assert found == pytest.approx(np.exp(-of_battery(T) - 20e-6 * T), rel=1e-11)


def test_what_never_comes_goes_by_its_own_hazard_and_what_no_model_follows_keeps_it_all():
    mixed = worn(seen("battery", LIFE, never=0.3))
    found = mixed.curve(mixed.plant.alone[0])(T)[1]
    assert found == pytest.approx(0.7 * np.exp(-of_battery(T)) + 0.3 * np.exp(-100e-6 * T), rel=1e-11)
    steps = np.linspace(0.0, 5000.0, 401)
    tasks = [Task((Leg(12.5),))] * 400
    each = np.array([one.probability for one in consecutive_completions(mixed, tasks)])
    whole = mixed.curve(mixed.plant.robot.diagram)(steps[-1:])[1]
    assert np.prod(each) == pytest.approx(float(whole[0]), rel=1e-10)
    rate = mixed.hazard_rate(mixed.plant.alone[0])
    assert rate == pytest.approx(0.3 * 100e-6, rel=1e-9)
    doubted = worn(replace(seen("battery", LIFE), state="not followed"))
    found = doubted.curve(doubted.plant.alone[0])(T)[1]
    assert found == pytest.approx(np.exp(-of_battery(T) - 100e-6 * T), rel=1e-11)
    late = mixed.curve(mixed.plant.alone[0])(np.array([2e5]))[1][0]
    assert late == pytest.approx(0.3 * math.exp(-20.0), rel=1e-9)


def test_a_task_of_two_functions_by_brute_force():
    """Drive for 1500 h, then see for 1000 h: all orders of failures of four parts in three intervals."""
    outlook = worn(seen("battery", LIFE), seen("left", weibull(2500.0, 4.0)))
    task = Task((Leg(1500.0, functions=("drive",)), Leg(1000.0, functions=("see",))))
    ends = np.array([1500.0, 2500.0])
    lives = {
        "battery": of_battery(ends), "computer": 200e-6 * ends, "left": (ends / 2500.0) ** 4, "right": 300e-6 * ends,
    }  # fmt: skip
    survival = [(1.0, *np.exp(-hazard).tolist(), 0.0) for hazard in lives.values()]
    expected = 0.0
    for fell in itertools.product(range(3), repeat=4):  # in the first leg, in the second, later
        battery, computer, left, right = fell
        if battery >= 1 and left >= 1 and battery >= 2 and computer >= 2 and (left >= 2 or right >= 2):
            expected += math.prod(s[k] - s[k + 1] for s, k in zip(survival, fell, strict=True))
    found = completion(outlook, task)
    assert found.probability == pytest.approx(expected, rel=1e-10)
    assert found.failure == pytest.approx(1 - expected, rel=1e-9)


def test_lives_by_simulation():
    outlook = worn(seen("battery", LIFE, never=0.2), seen("left", weibull(1500.0, 3.0)))
    rng = np.random.default_rng(1)
    n = 400_000
    battery = np.where(rng.random(n) < 0.2, rng.exponential(1e4, n), 4000 * rng.weibull(6.0, n))
    left, right = 1500 * rng.weibull(3.0, n), rng.exponential(1e6 / 300, n)
    ends = np.minimum(np.minimum(battery, rng.exponential(5000.0, n)), np.maximum(left, right))
    life = outlook.remaining_life(outlook.plant.robot.diagram)
    assert life.mean == pytest.approx(ends.mean(), rel=0.005)
    assert [life.early, life.median, life.late] == pytest.approx(np.quantile(ends, [0.05, 0.5, 0.95]), rel=0.01)
    views = {"nominal": robot(), "sensor_based": outlook}
    shares = failures_to_come(views, outlook.plant.robot.diagram, life.median, 2000.0)
    died = ends < 2000.0
    by_battery = (ends == battery) & died
    found = {one.path: one.sensor_based for one in shares.contributions}
    assert shares.sensor_based_failure == pytest.approx(died.mean(), abs=0.003)
    assert found["battery"] == pytest.approx(by_battery.sum() / died.sum(), abs=0.005)
    last_left = (ends == left) & died
    assert found["left"] == pytest.approx(last_left.sum() / died.sum(), abs=0.005)
    drawn = Drawn(outlook.plant, outlook.plant.robot.diagram)
    measured = {one.unit: one for one in importances(outlook, drawn, 2000.0).units}
    matters = np.mean(((left > 2000) | (right > 2000)) & (rng.exponential(5000.0, n) > 2000))
    assert measured["battery"].birnbaum == pytest.approx(matters, abs=0.005)
    assert sum(one.barlow_proschan for one in measured.values()) == pytest.approx(1.0, rel=1e-6)


def test_a_new_part_has_its_own_hazard_again():
    outlook = worn(seen("left", weibull(300.0, 5.0)))
    as_new = robot()
    diagram = outlook.plant.robot.diagram
    new = replaced(outlook, 2)
    assert not new.worn
    assert new.remaining_life(diagram) == as_new.remaining_life(diagram)
    task = Task((Leg(500.0),))
    gains = {one.path: one for one in replacements(outlook, diagram, task).parts}
    expected = completion(as_new, task).probability - completion(outlook, task).probability
    assert gains["left"].completion == pytest.approx(expected, rel=1e-9)
    assert gains["left"].mean == pytest.approx(
        as_new.mean_remaining_life(diagram) - outlook.mean_remaining_life(diagram), rel=1e-4
    )
    two = Task((Leg(500.0, functions=("drive",)), Leg(100.0, functions=("see",))))
    gains = {one.path: one for one in replacements(outlook, diagram, two).parts}
    expected = completion(as_new, two).probability - completion(outlook, two).probability
    assert gains["left"].completion == pytest.approx(expected, rel=1e-9)


def test_what_has_reached_its_threshold_has_failed_unless_it_is_said_to_work():
    gone = SeenWear("battery", "battery", "", "reached", "h", 100, 1.0)
    outlook = worn(gone)
    assert completion(outlook, Task((Leg(1.0),))).probability == 0.0
    assert outlook.remaining_life(outlook.plant.robot.diagram).late == 0.0
    one = worn(replace(gone, mode="left"))
    assert one.curve(one.plant.robot.diagram)(T)[1] == pytest.approx(np.exp(-600e-6 * T), rel=1e-11)
    known = replace(robot(), knowledge=Knowledge(working=frozenset({"battery"})))
    said = with_wear(known, [gone])
    assert said.curve(said.plant.alone[0])(T)[1] == pytest.approx(np.exp(-100e-6 * T), rel=1e-11)
    diagram = outlook.plant.robot.diagram
    assert replaced(outlook, 0).remaining_life(diagram) == robot().remaining_life(diagram)


def test_a_member_of_a_group_goes_by_its_hazard():
    text = ("{schema_version: 1, name: R, components: {a: {rate: 1 /h}, b: {rate: 1 /h}},"
            " diagram: {standby: {of: [a, b]}}}")  # fmt: skip
    outlook = worn(seen("a", LIFE), text=text)
    assert not outlook.worn
    assert outlook.curve(outlook.plant.robot.diagram)(np.array([2.0]))[1][0] == pytest.approx(3 * math.exp(-2))


UNSURE = ROBOT.replace("computer: {rate: 200 FPMH}", "computer: {rate: 200 FPMH, uncertainty: {error_factor: 3}}")
UNSURE = UNSURE.replace("battery: {rate: 100 FPMH}", "battery: {rate: 100 FPMH, uncertainty: {error_factor: 10}}")


def test_draws_of_rates_do_not_touch_what_wear_says():
    """The battery's rate is uncertain, and does not matter any more; the computer's does, as a sum over draws says."""
    outlook = worn(seen("battery", LIFE), text=UNSURE)
    task = Task((Leg(2500.0),))
    found = completion_uncertainty(outlook, task, draws=4000, seed=1)
    deviation = math.log(3) / 1.6448536269514722
    z = (np.arange(20000) + 0.5) / 20000
    from scipy.special import ndtri

    rates = 200e-6 * np.exp(deviation * ndtri(z) - deviation**2 / 2)
    others = math.exp(-float(of_battery(2500.0))) * float(pair(2500.0))
    assert found.mean.probability == pytest.approx(others * np.mean(np.exp(-rates * 2500)), rel=2e-3)
    assert found.failure.low == pytest.approx(1 - others * math.exp(-2500 * float(np.quantile(rates, 0.05))), rel=5e-3)
    exact = outlook.remaining_life(outlook.plant.robot.diagram)
    life = life_uncertainty(outlook, outlook.plant.robot.diagram, draws=2000)
    assert life.chance_alone.median == pytest.approx(exact.median, rel=1e-4)
    alone = life_uncertainty(outlook, outlook.plant.alone[0], draws=2000)
    assert alone.all_sources == pytest.approx(alone.chance_alone, rel=1e-6)


STRESSED = """
schema_version: 1
name: R
usage: {operating: 0.5}
components:
  motor:
    rate: 100 FPMH
    acceleration: {temperature: {law: q10, q: 2, design: 40 degC, sensor: {topic: /t, field: x}}}
  idle: {rate: 1 FPMH, duty: 0.25}
functions: {drive: [motor], rest: [idle]}
"""


def test_use_and_rest_are_of_the_clock_of_the_readings():
    """Half of the time it works; readings of dates are of the calendar, at the use of late."""
    text = ROBOT.replace("name: R\n", "name: R\nusage: {operating: 0.5}\n")
    on_clock = worn(seen("battery", LIFE), text=text)
    dated = worn(seen("battery", LIFE, dated=True), text=text)
    diagram = on_clock.plant.alone[0]
    assert on_clock.remaining_life(diagram).median == pytest.approx(2 * float(LIFE.quantile(0.5)), rel=1e-6)
    assert dated.remaining_life(diagram).median == pytest.approx(float(LIFE.quantile(0.5)), rel=1e-6)
    task = Task((Leg(1000.0),))  # of operation, in which the calendar goes on by 2000
    assert completion(on_clock, task, diagram).probability == pytest.approx(math.exp(-of_battery(1000.0)), rel=1e-10)
    assert completion(dated, task, diagram).probability == pytest.approx(math.exp(-of_battery(2000.0)), rel=1e-10)


def test_repetitions_carry_wear_on():
    outlook = worn(seen("battery", LIFE, never=0.1), seen("left", weibull(2500.0, 4.0)))
    task = Task((Leg(100.0),))
    chunks = np.concatenate(list(repetitions(outlook, [task], 30)), axis=1)
    curve = outlook.curve(outlook.plant.robot.diagram)(np.arange(31) * 100.0)[1]
    assert chunks[0] == pytest.approx(curve[1:] / curve[:-1], rel=1e-9)


def test_many_parts_alike_are_told_apart_by_their_wear():
    parts = "\n".join(f"  p{i}: {{rate: 1 FPMH}}" for i in range(400))
    text = f"schema_version: 1\nname: R\ncomponents:\n{parts}\n"
    outlook = worn(seen("p7", LIFE), text=text)
    found = outlook.reliability_curve(outlook.plant.robot.diagram, T)[0]
    assert found == pytest.approx(np.exp(-of_battery(T) - 399e-6 * T), rel=1e-10)
