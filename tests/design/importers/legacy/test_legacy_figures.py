"""The 2020 tool's figures, against its unit tests, its guide, its saved file, and runs of its classes at 849de95."""

import json
import math
from pathlib import Path

import pytest

from robophm.core.errors import ModelError, StructureError, UnitError
from robophm.design.file import parse
from robophm.design.importers.legacy.figures import (
    driven_legs,
    legacy_task,
    legacy_tasks,
    parallel_rate,
    potc,
    potc_paper,
    prognostic,
    reliability_at,
    sensor_based_rate,
    series_rate,
    stressed_rate,
    waypoint_legs,
)
from robophm.design.task import Leg, Task

FIGURES = json.loads((Path(__file__).parents[3] / "data" / "legacy_figures.json").read_text(encoding="utf-8"))
CASES = {case["name"]: case for case in FIGURES["cases"]}


def answers(name, data):
    """What we say to a case, by the names of what it expects; None for what our functions do not say."""
    match name:
        case "orig_reliability_exponential":
            return {f"R_unit_{u}": reliability_at(data["t"], data["rate"], m) for u, m in (("h", "m/s"), ("s", "km/h"))}
        case "orig_reliability_curve":
            given = (data["t"], data["rate"])
            return {
                "R": reliability_at(*given, "m/s", "curve", data["shape"]),
                "R_div3600": reliability_at(*given, "km/h", "curve", data["shape"]),
            }
        case "orig_potc_formula":
            return {"potc": potc_paper(data["R"], data["d"])}
        case "orig_potc_actual":
            legs = driven_legs(data["times"], data["positions"])
            lengths = [length for length, _ in legs]
            return {"potc_legacy": potc(data["R0"], data["rate"], legs, "m/s"), "leg_distances": lengths}
        case "orig_potc_prognostic_10":
            legs = waypoint_legs(data["task_list"])
            series = prognostic(data["R0"], data["rate"], legs, data["simulation_count"], "m/s")
            assert potc(data["R0"], data["rate"], legs, "m/s") == series[1]
            return {"times": [time for _, time in legs], "potc": series}
        case "orig_series_parallel":
            unit = parallel_rate([1, 0, 0, 0, 0])
            parallel = parallel_rate(data["parallel"])
            return {"series": series_rate(data["series"]), "parallel_legacy": parallel, "H5_inverse": unit}
        case "orig_stress_factors":
            rate = data["rate"]
            return {
                "temp_T11_T0_1": stressed_rate(rate, 11, 1),
                "load_1_1": stressed_rate(rate, load=1, reference_load=1),
                "load_temp": stressed_rate(rate, 11, 1, 1, 1),
            }
        case "ota_published_modules_1000h":
            rates = data["module_rates_per_h"]
            system = series_rate(rates.values())
            seconds = data["t_h"] * 3600
            return {
                "R": {name: reliability_at(seconds, rate) for name, rate in rates.items()},
                "system_rate": system,
                "system_R": reliability_at(seconds, system),
            }
        case "ota_yaml_replay_1015s":
            return {
                f"R_{which}": reliability_at(data["uptime_s"], data[which]) for which in ("nominal", "sensor_based")
            }
    return pytest.fail(f"no answer to {name}")


def holds(name, data, expected, tolerance):
    found = answers(name, data)
    assert found == {key: pytest.approx(value, **{"abs": 0, **tolerance}) for key, value in expected.items()}


@pytest.mark.parametrize("name", CASES)
def test_published(name):
    case = CASES[name]
    holds(name, case["data"], case["expected"], case["tolerance"])


def test_the_copy_is_complete_and_unchanged(shared):
    cases = json.loads((shared / "cases" / "life_and_mission.json").read_text(encoding="utf-8"))["cases"]
    wanted = [case for case in cases if case["kind"] == "compat" or case["name"].startswith("ota_")]
    assert len(wanted) == len(CASES)
    for case in wanted:
        assert CASES[case["name"]] == {key: case[key] for key in CASES[case["name"]]}
        holds(case["name"], case["data"], case["expected"], case["tolerance"])


LEGS = {
    "actual": driven_legs(*(CASES["orig_potc_actual"]["data"][key] for key in ("times", "positions"))),
    "predicted": waypoint_legs(CASES["orig_potc_prognostic_10"]["data"]["task_list"]),
}
OTA_RATE, OTA_WORKS = 5.288326869051733e-4, 0.9998509096769534

# λ, R, unit, model, then actual, predicted and the third repetition: what that tool's own classes say to its
# km/h pipeline (times / 3600 and again / 3600, positions / 1000), run beside this test when it was written.
RUNS = [
    (0.5, 0.754321, "km/h", "exponential", 0.9993472263069909, 0.9994094050041135, 0.9994093951871185),
    (0.5, 0.754321, "km/h", "curve", 0.9993472376968708, 0.9994094099102109, 0.9994094099054105),
    (0.5, 0.754321, "m/s", "exponential", 3.3538435995829924e-65, 1.2584716016954124e-28, 6.496236565088203e-84),
    (OTA_RATE, OTA_WORKS, "km/h", "exponential", 0.9999996546644574, 0.9999996875712999, 0.9999996875609106),
    (OTA_RATE, OTA_WORKS, "m/s", "exponential", 0.8549831654888133, 0.9346018737348561, 0.8168669212404363),
]


@pytest.mark.parametrize(("rate", "works", "unit", "model", "actual", "predicted", "third"), RUNS)
def test_tasks_in_both_units(rate, works, unit, model, actual, predicted, third):
    assert potc(works, rate, LEGS["actual"], unit, model, 1.5) == pytest.approx(actual, rel=1e-11, abs=0)
    series = prognostic(works, rate, LEGS["predicted"], 3, unit, model, 1.5)
    assert (series[0], len(series)) == (1, 4)
    assert series[1::2] == pytest.approx([predicted, third], rel=1e-11, abs=0)


@pytest.mark.parametrize(
    ("model", "expected"),
    [
        ("exponential", (0.9983347214509387, 0.0024787521766663585)),
        ("rayleigh", (0.9999999657064478, 0.6411803884299546)),
        ("weibull", (0.9999974799519996, 0.5802297959746728)),
        ("curve", (0.9999319586183084, math.exp(1 - math.exp(6**1.5)))),
    ],
)
def test_two_seconds_at_three_an_hour(model, expected):
    """Its own class at t = 2 s, λ = 3 /h, c = 1.5; rayleigh and weibull are (t/λ)^c, as wrong as they are."""
    found = [reliability_at(2, 3, unit, model, 1.5) for unit in ("km/h", "m/s")]
    assert found == pytest.approx(expected, rel=1e-12, abs=0)


def test_weibull_and_rayleigh_answer_zero_to_any_real_rate():
    """That tool's unit tests, at 1e5 s and 5e-7 /h; beyond what a float holds it fails, and we answer 0."""
    for unit in ("km/h", "m/s"):
        for model, shape in (("rayleigh", 1), ("weibull", 1.5), ("weibull", 300)):
            assert reliability_at(1e5, 5e-7, unit, model, shape) == 0
    assert reliability_at(1e9, 1, "m/s", "curve", 3) == 0


def test_a_silent_sensor_is_a_cold_one():
    """Mean 24 °C of 30, none and 42: its own class gives 5e-6 · 2^(−0.1)."""
    assert sensor_based_rate(5e-6, [30, None, 42]) == pytest.approx(4.665164957684037e-06, rel=1e-12, abs=0)
    assert sensor_based_rate(5e-6, []) == 5e-6
    assert stressed_rate(5e-6, 41.5, 25, 1.3, 0.9) == pytest.approx(5e-6 * (13 / 9) ** 3 * 2**1.65, rel=1e-12, abs=0)


def test_only_the_last_leg_counts():
    """R^d of the last leg; the paper's robot would as well not have driven the others."""
    legs = [(5000.0, 0.0), (2.0, 0.0)]
    assert potc(0.9, 1e-4, legs, "m/s") == pytest.approx(0.81, rel=1e-12, abs=0)
    assert potc(0.9, 1e-4, legs[::-1], "km/h") == pytest.approx(0.9**5, rel=1e-12, abs=0)
    assert potc(0.9, 1e-4, []) == 0  # as that tool says


def test_a_whole_robot():
    """By its rate 5e-5 /h: R after 200 h, then a task of two legs, twice."""
    robot = parse("schema_version: 1\nname: R\ncomponents: {A: {rate: 3e-5 /h}, B: {rate: 2e-5 /h}}")
    legs = waypoint_legs([[0, 0, 0.5], [3, 4, 0.25], [3, 5, 9]])
    assert legs == [(5, 10), (1, 4)]
    task = legacy_task(robot, legs, 200, 2)
    twice = 5e-5 * 14 / 3600**2
    assert task.reliability == pytest.approx(math.exp(-0.01), rel=1e-12, abs=0)
    assert task.predicted == task.actual == pytest.approx(math.exp(-(0.01 + twice) * 0.001), rel=1e-14, abs=0)
    assert task.prognostic == pytest.approx(
        (1, task.predicted, math.exp(-(0.01 + 2 * twice) * 0.001)), rel=1e-14, abs=0
    )
    seconds = legacy_task(robot, legs, 200, 1, "m/s", driven=[(5, 30), (2, 6)])
    assert seconds.reliability == pytest.approx(math.exp(-5e-5 * 720000), rel=1e-12, abs=0)
    assert seconds.actual == pytest.approx(math.exp(-5e-5 * 720036 * 2), rel=1e-12, abs=0)
    assert seconds.predicted == pytest.approx(math.exp(-5e-5 * 720014), rel=1e-12, abs=0)
    planned, driven = (Task(tuple(Leg(t / 3600, d) for d, t in some)) for some in (legs, [(5, 30), (2, 6)]))
    both = legacy_tasks(robot, planned, 200, 2)
    assert both.keys() == {"km/h", "m/s"}
    assert both["km/h"].prognostic == pytest.approx(task.prognostic, rel=1e-14, abs=0)
    assert legacy_tasks(robot, planned, 200, driven=driven)["m/s"].actual == pytest.approx(
        seconds.actual, rel=1e-14, abs=0
    )


@pytest.mark.parametrize(
    ("call", "error", "says"),
    [
        (lambda: reliability_at(1, 1, "mph"), UnitError, "unit 'mph': the 2020 tool has km/h and m/s"),
        (lambda: reliability_at(1, 1, "m/s", "weibul"), ModelError, "did you mean 'weibull'"),
        (lambda: reliability_at(1, 0, "m/s", "weibull"), ModelError, "divides by it"),
        (lambda: reliability_at(-1, 1), ModelError, "at least 0"),
        (lambda: reliability_at(1, math.nan), ModelError, "at least 0"),
        (lambda: potc_paper(1.5, 1), ModelError, "R in 0…1"),
        (lambda: potc_paper(0.5, math.inf), ModelError, "finite length"),
        (lambda: waypoint_legs([[0, 0, 0], [1, 0, 1]]), ModelError, "speed 0 m/s"),
        (lambda: waypoint_legs([[0, 0], [1, 0]]), ModelError, "three numbers"),
        (lambda: driven_legs([1], [[0, 0], [1, 0], [2, 0]]), ModelError, "1 times for 2 legs"),
        (lambda: prognostic(1, 1, [(1, 1)] * 1000, 10**6), ModelError, "legs in all"),
        (lambda: prognostic(1, 1, [], 0), ModelError, "legs in all"),
    ],
)
def test_what_is_refused(call, error, says):
    with pytest.raises(error, match=says):
        call()


def test_a_robot_that_it_cannot_draw():
    robot = parse("schema_version: 1\nname: R\ncomponents: {A: {rate: 1 FIT, quantity: 3, required: 2}}")
    with pytest.raises(StructureError, match="the 2020 tool knows neither"):
        legacy_task(robot, [(1, 1)], 1)
