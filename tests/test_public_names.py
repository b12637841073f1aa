"""Every public name, and every public method of what they return, given hostile values: one line, or a right answer."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robophm
from robophm.core.errors import LONGEST_TEXT
from robophm.core.signal import SECOND, Sample
from robophm.design.file import parse
from robophm.design.task import Knowledge, Plan
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.life import life_distributions

DESIGN = {
    "schema_version": 1, "name": "R", "functions": {"drive": "wheel", "lift": "arm"},
    "diagram": {"series": ["wheel", {"parallel": ["arm", "Power"]}]},
    "modules": {"Power": {"components": {"battery": {"rate": "1e-4 /h", "acceleration": {"model": "q10"}}}}},
    "components": {"wheel": {"rate": "1e-3 /h", "acceleration": {"model": "cubic_load"}}, "arm": {"rate": "2e-3 /h"}},
    "signals": {"load": {"topic": "/w", "field": "load"}}, "task": {"duration": "2 h"},
}  # fmt: skip
ROBOT = parse(json.dumps(DESIGN))
HEALTH = robophm.Monitor(ROBOT).report()
LEG, TASK = robophm.Leg(1.0), robophm.Task((robophm.Leg(1.0),))
OUTLOOK = as_designed(Plant(ROBOT))
FLEET = robophm.Fleet.of([OUTLOOK, OUTLOOK])
PAIR = robophm.Structure(robophm.Parallel("a", "b"))
AN_ARRAY = np.array([1.0, 2.0])

NUMBERS: list[Any] = [-1, -0.5, math.nan, math.inf, -math.inf, "5", "", None, [], {}, "x", b"1", object(), True, 1j,
                      10**400, Path("x"), [math.nan], [-1.0], ["a"], np.array([[1.0, math.inf]])]  # fmt: skip
NAMES: list[Any] = ["", "whel", "wheel/x", "../..", "\0", "a\nb", "x" * 5000, 5, math.nan, None, [], {}, b"wheel",
                    object(), np.array([1.0]), -1, math.inf]  # fmt: skip
THINGS: list[Any] = [
    None,
    5,
    -1,
    math.nan,
    math.inf,
    "",
    "wheel",
    [],
    {},
    object(),
    AN_ARRAY,
    b"",
    (1,),
    [None],
    lambda: 0,
]
PATHS: list[Any] = ["", "no/such/file", "\0", None, 5, math.nan, [], {}, b"x", object(), AN_ARRAY, ".", "x" * 5000]

Call = Callable[[Any], Any]


def but(values: list[Any], *fine: Any) -> list[Any]:
    """Those that are none of these, which may be given."""
    return [value for value in values if repr(value) not in map(repr, fine)]


def sampled(sample: Any) -> Any:
    robophm.Monitor(ROBOT).observe(sample)


# What is called with each hostile value; of every name in robophm.__all__ at least one.
CALLS: dict[str, tuple[list[Any], Call]] = {
    "Leg(duration)": (NUMBERS, robophm.Leg),
    "Leg(distance)": (NUMBERS, lambda x: robophm.Leg(1.0, x)),
    "Leg(cycles)": (but(NUMBERS, None), lambda x: robophm.Leg(1.0, cycles=x)),
    "Leg(starts)": (but(NUMBERS, None), lambda x: robophm.Leg(1.0, starts=x)),
    "Leg(functions)": (but(THINGS, [], {}, b""), lambda x: robophm.Leg(1.0, functions=x)),
    "Leg(stresses)": (but(THINGS, {}), lambda x: robophm.Leg(1.0, stresses=x)),
    "Leg(stresses values)": (
        but(NUMBERS, -1, -0.5),
        lambda x: robophm.Leg(1.0, stresses={"load": x}),
    ),
    "Leg.stated": ([], LEG.stated),
    "Task(legs)": (but(THINGS, [], {}, b""),
                   robophm.Task),
    "Task.plain": (NUMBERS, lambda x: robophm.Task.plain(x, 1.0)),
    "Task.plain, duration": (NUMBERS, lambda x: robophm.Task.plain(1.0, x)),
    "completion(task)": (THINGS, HEALTH.completion),
    "completion(view)": (NAMES, lambda x: HEALTH.completion(TASK, x)),
    "completion(function)": ([x for x in NAMES if isinstance(x, str)],
                             lambda x: HEALTH.completion(robophm.Task((robophm.Leg(1.0, functions=(x,)),)))),
    "completion(stress)": ([x for x in NAMES if isinstance(x, str)],
                           lambda x: HEALTH.completion(robophm.Task((robophm.Leg(1.0, stresses={x: 1.0}),)))),
    "completion(stress below)": (["arm/load", "whel/load", "/load", "Power/load"],
                                 lambda x: HEALTH.completion(robophm.Task((robophm.Leg(1.0, stresses={x: 1.0}),)))),
    "completion(stress out of range)": ([1e9, -1e9], lambda x: HEALTH.completion(
        robophm.Task((robophm.Leg(1.0, stresses={"temperature": x}),)))),
    "reliability(hours)": (but(NUMBERS, []), HEALTH.reliability),
    "reliability(view)": (NAMES, lambda x: HEALTH.reliability(1.0, x)),
    "remaining_life(view)": (NAMES, HEALTH.remaining_life),
    "subject(path)": (NAMES, HEALTH.subject),
    "Monitor(robot)": (THINGS, robophm.Monitor),
    "Monitor(ledger)": (but(THINGS, None), lambda x: robophm.Monitor(ROBOT, x)),
    "Monitor(period)": ([*NUMBERS, 0, 1e300], lambda x: robophm.Monitor(ROBOT, period=x)),
    "Monitor.observe": (THINGS, sampled),
    "Monitor.observe, value": (["x", None, [], {}, object(), 1j], lambda x: sampled(Sample(SECOND, "/w.load", x))),
    "Monitor.observe, time": ([0.5, math.nan, "x", None], lambda x: sampled(Sample(x, "/w.load", 1.0))),
    "report(task)": (but(THINGS, None), lambda x: robophm.Monitor(ROBOT).report(task=x)),
    "report(plan)": (but(THINGS, None), lambda x: robophm.Monitor(ROBOT).report(plan=x)),
    "report(knowledge)": (but(THINGS, None), lambda x: robophm.Monitor(ROBOT).report(knowledge=x)),
    "report(knowledge of)": ([{"whel"}, {"Power"}, {""}],
                             lambda x: robophm.Monitor(ROBOT).report(knowledge=Knowledge(failed=x))),
    "report(future)": (NAMES, lambda x: robophm.Monitor(ROBOT).report(future=x)),
    "report(draws)": ([*NUMBERS, 10**9], lambda x: robophm.Monitor(ROBOT).report(draws=x)),
    "Knowledge": (but(THINGS, [], {}, b""), Knowledge),
    "Plan(every)": (but([*NUMBERS, 0], None), lambda x: Plan((TASK,), every=x)),
    "replay(robot)": (THINGS, lambda x: robophm.replay(x, "no.mcap")),
    "replay(recorded)": ([*PATHS, [None], [""], (5,)], lambda x: robophm.replay(ROBOT, x)),
    "replay(store)": (but(THINGS, None), lambda x: robophm.replay(ROBOT, "no.mcap", store=x)),
    "replay(period)": ([*NUMBERS, 0], lambda x: robophm.replay(ROBOT, "no.mcap", period=x)),
    "replay(report_every)": (but([*NUMBERS, 0], None),
                             lambda x: robophm.replay(ROBOT, "no.mcap", report_every=x)),
    "load": (PATHS, robophm.load),
    "load_plan(path)": (PATHS, lambda x: robophm.load_plan(x, ROBOT)),
    "load_plan(robot)": (THINGS, lambda x: robophm.load_plan("tasks.yaml", x)),
    "open_source": ([*PATHS], robophm.open_source),
    "open_source, two": (PATHS, lambda x: robophm.open_source("a.mcap", x)),
    "open_store": (PATHS, robophm.open_store),
    "life_distribution": (NAMES, robophm.life_distribution),
    "Unit": (but(NAMES, *(x for x in NAMES if isinstance(x, str))), robophm.Unit),
    "Series": (but(THINGS, "", "wheel"), robophm.Series),
    "Parallel": (but(THINGS, "", "wheel"), lambda x: robophm.Parallel("a", x)),
    "KOutOfN(k)": ([*NUMBERS, 0, 3, 1.5], lambda x: robophm.KOutOfN(x, "a", "b")),
    "KOutOfN(block)": (but(THINGS, "", "wheel"), lambda x: robophm.KOutOfN(1, "a", x)),
    "Network(source)": (NAMES, lambda x: robophm.Network(x, "out", [("in", "a"), ("a", "out")])),
    "Network(links)": (THINGS, lambda x: robophm.Network("in", "out", x)),
    "Network(nodes)": ([5, "", "wheel", [], object(), AN_ARRAY, {"a": 5}, {"b": "x"}, {"a": None}],
                       lambda x: robophm.Network("in", "out", [("in", "a"), ("a", "out")], x)),
    "Link": (but(THINGS, None, "", "wheel"),
             lambda x: robophm.Network("in", "out", [robophm.Link("in", "out", x)])),
    "Structure": (but(THINGS, "", "wheel"), robophm.Structure),
    "Structure.state": (NUMBERS, lambda x: PAIR.state(x, [0.1, 0.1])),
    "Structure.state, none": ([[[0.5, 0.5], [0.6, 0.5]], [[0.5] * 3, [0.5] * 3], [[math.nan, 0.1], [0.9, 0.9]]],
                              lambda x: PAIR.state(*x)),
    "Structure.transition": (NUMBERS, lambda x: PAIR.transition([0.1, 0.1], x, [0.8, 0.8])),
    "Structure.probability": (NUMBERS, lambda x: PAIR.probability(x, [0.1, 0.1])),
    "Structure.birnbaum": (NUMBERS, lambda x: PAIR.birnbaum([0.1, 0.1], x)),
    "Structure.moment().what_if": (NAMES[:7], lambda x: PAIR.moment().what_if(x, 0.5, 0.5)),
    "Fleet.of": (THINGS, robophm.Fleet.of),
    "Fleet.designed": (NUMBERS, lambda x: robophm.Fleet.designed(OUTLOOK.plant, x)),
    "Fleet.designed(plant)": (THINGS, lambda x: robophm.Fleet.designed(x, np.ones((3, 2)))),
    "Fleet.ahead(diagram)": ([*THINGS, robophm.Unit("whel")], lambda x: FLEET.ahead(x, 1.0)),
    "Fleet.ahead(hours)": ([*NUMBERS, [1.0, 2.0, 3.0]], lambda x: FLEET.ahead(ROBOT.diagram, x)),
    "Fleet.hazard_rate": ([*THINGS, robophm.Unit("whel")], FLEET.hazard_rate),
    "Fleet.since_new": ([*THINGS, robophm.Unit("whel")], FLEET.since_new),
    "Fleet.remaining_life": (THINGS, FLEET.remaining_life),
    "Fleet.remaining_life(survives)": ([*but(NUMBERS, []), 1.5],
                                       lambda x: FLEET.remaining_life(ROBOT.diagram, x)),
    "Answers": (but(THINGS, None, "", "wheel"), robophm.Answers),
    "Answers(where)": (NAMES[1:7], lambda x: robophm.new(answers=robophm.Answers(where=x, computer="pc"))),
    "new(urdf)": (but(PATHS, None), robophm.new),
    "new(recordings)": (but(PATHS, [], {}, AN_ARRAY), lambda x: robophm.new(None, x)),
    "new(parts_lists)": (but(THINGS, None, {}), lambda x: robophm.new(parts_lists=x, answers=robophm.Answers())),
    "new(answers)": ([5, "x", object(), AN_ARRAY[:1]], lambda x: robophm.new(answers=x)),
    "survival_of_next(hours)": (but(NUMBERS, []), HEALTH.survival_of_next),
    "survival_of_next(view)": (NAMES, lambda x: HEALTH.survival_of_next(1.0, x)),
    "reliability(of)": (but(NAMES, ""), lambda x: HEALTH.reliability(1.0, of=x)),
    "remaining_life(of)": (but(NAMES, ""), lambda x: HEALTH.remaining_life(of=x)),
    "predict": ([*PATHS, *THINGS[5:]], robophm.predict),
    "predict(store)": (but(THINGS, None), lambda x: robophm.predict(ROBOT, x)),
    "allocate": ([*PATHS, *THINGS[5:]], lambda x: robophm.allocate(x, {}, budget=1)),
    "allocate(offers)": ([{"A": 5}, {"A": (5, 0)}], lambda x: robophm.allocate(ROBOT, x, budget=1)),
    "availability": ([*PATHS, *THINGS[5:]], robophm.availability),
    "availability(function)": (but(NAMES, "", None), lambda x: robophm.availability(ROBOT, x)),
    "availability(hours)": ([*NUMBERS, 0], lambda x: robophm.availability(HEALTH, hours=x)),
    "availability(view)": (NAMES, lambda x: robophm.availability(HEALTH, view=x)),
    "demonstrate(reliability)": ([*NUMBERS, 0, 1], lambda x: robophm.demonstrate(x, 100.0)),
    "demonstrate(at)": ([*NUMBERS, 0], lambda x: robophm.demonstrate(0.9, x)),
    "demonstrate(allowed)": (but([*NUMBERS, 0.5], 0), lambda x: robophm.demonstrate(0.9, 1.0, allowed=x)),
    "demonstrate(units)": (but([*NUMBERS, 0, 0.5], None), lambda x: robophm.demonstrate(0.9, 1.0, units=x)),
    "demonstrate(hours)": (but([*NUMBERS, 0], None), lambda x: robophm.demonstrate(0.9, 1.0, hours=x)),
    "importance": ([*PATHS, *THINGS[5:]], robophm.importance),
    "importance(function)": (but(NAMES, "", None), lambda x: robophm.importance(ROBOT, x)),
    "importance(hours)": (but([*NUMBERS, 0], None), lambda x: robophm.importance(HEALTH, hours=x)),
    "importance(task)": (but(THINGS, None), lambda x: robophm.importance(HEALTH, task=x)),
    "rate": (NAMES, robophm.rate),
    "rate(inputs)": (but(THINGS, "vehicle"), lambda x: robophm.rate("mil_hdbk_217f.fuse", environment=x)),
    "rate(no input)": ([{"enviroment": "GM"}, {"x" * 5000: "GM"}], lambda x: robophm.rate("mil_hdbk_217f.fuse", **x)),
    "models": (but(NAMES, None, "a\nb"), robophm.models),
    "fit(lives)": (but(PATHS, AN_ARRAY), robophm.fit),
    "fit(times)": ([-1, [0.0], [-1.0], [math.nan], [[1.0]], ["a"], np.array([[1.0, 2.0]])], robophm.fit),
    "fit(censored)": (but(NUMBERS, "", [], {}, 10**400, Path("x")), lambda x: robophm.fit([1.0, 2.0, 3.0], censored=x)),
    "fit(distribution)": (but(NAMES, None), lambda x: robophm.fit([1.0, 2.0, 3.0], x)),
    "fit(by)": (NAMES, lambda x: robophm.fit([1.0, 2.0, 3.0], by=x)),
    "fit(level)": ([*NUMBERS, 0, 1], lambda x: robophm.fit([1.0, 2.0, 3.0], level=x)),
    "learn(robot)": ([*PATHS, *THINGS[5:]], lambda x: robophm.learn(x, "log.csv")),
    "learn(logs)": ([*PATHS, *THINGS], lambda x: robophm.learn(ROBOT, x)),
    "learn(prior)": (but(NAMES, None), lambda x: robophm.learn(ROBOT, "log.csv", prior=x)),
    "wear(signals)": ([*PATHS, *THINGS], lambda x: robophm.wear(ROBOT, x)),
    "wear(part)": (but(NAMES, None), lambda x: robophm.wear(ROBOT, "log.csv", x)),
    "wear(threshold)": (but(NUMBERS, None, -1, -0.5), lambda x: robophm.wear(ROBOT, "a.csv", "arm", threshold=x)),
    "maintain(costs)": (PATHS, lambda x: robophm.maintain(ROBOT, x)),
    "maintain(downtime_cost)": (NUMBERS, lambda x: robophm.maintain(ROBOT, "a.csv", downtime_cost=x)),
    "import_bom": (PATHS, lambda x: robophm.import_bom(x, "robot.yaml")),
    "import_bom(design)": (PATHS, lambda x: robophm.import_bom("a.csv", x)),
    "import_bom(module)": (but(NAMES, ""), lambda x: robophm.import_bom("a.csv", "robot.yaml", module=x)),
    "bind(design)": (PATHS, lambda x: robophm.bind(x, "a.mcap")),
    "fit_stress": (but(PATHS, AN_ARRAY), lambda x: robophm.fit_stress(x, {"temperature": 40})),
    "fit_stress(use)": ([*THINGS[1:8], {5: 1.0}, {"t": math.nan}, {"t": None}, {"t": "x"}, {"t": []}],
                        lambda x: robophm.fit_stress("a.csv", x)),
    "fit_stress(laws)": ([5, "x", [1], {5: "arrhenius"}, {"t": 5}],
                         lambda x: robophm.fit_stress("a.csv", {"t": 40}, laws=x)),
    "fit_modes": (PATHS, robophm.fit_modes),
    "fit_limited": (but(PATHS, AN_ARRAY), robophm.fit_limited),
    "fit_limited(distribution)": (but(NAMES, None), lambda x: robophm.fit_limited([1.0, 2.0, 3.0], x)),
    "fit_repaired": (PATHS, robophm.fit_repaired),
    "WearOptions": (but(THINGS, None), lambda x: robophm.wear(ROBOT, "a.csv", "arm", options=x)),
    "wear(fleet)": (but(PATHS, None), lambda x: robophm.wear(ROBOT, "a.csv", "arm", threshold=2.0, fleet=x)),
    "wear(use)": ([5, "x", [1], {5: 1.0}, {"t": math.nan}, {"t": "x"}],
                  lambda x: robophm.wear(ROBOT, "a.csv", "arm", threshold=2.0, use=x)),
    "wear(settings)": (["x", [5], [None]],
                       lambda x: robophm.wear(ROBOT, "a.csv", "arm", index=True, fleet="b.csv", settings=x)),
    "fmeca": ([*PATHS, *THINGS[5:]], robophm.fmeca),
    "fmeca(sensors)": (but(PATHS, None), lambda x: robophm.fmeca(ROBOT, x)),
    "fmeca(hours)": ([*NUMBERS, 0], lambda x: robophm.fmeca(ROBOT, hours=x)),
    "fmeca(severities)": ([5, [1], AN_ARRAY, {"whel": 5}, {"wheel": 0}, {"wheel": 11}, {"wheel": 1.5}, {"wheel": "5"},
                           {5: 5}], lambda x: robophm.fmeca(ROBOT, severities=x)),
    "diagnose(sensors)": (PATHS, lambda x: robophm.diagnose(ROBOT, x)),
    "diagnose(add)": ([*NUMBERS, 17, 1.5], lambda x: robophm.diagnose(ROBOT, "a.csv", add=x)),
    "diagnose(age)": (NUMBERS, lambda x: robophm.diagnose(ROBOT, "a.csv", age=x)),
    "fault_tree": ([*PATHS, *THINGS[5:], "no.xml"], robophm.fault_tree),
    "fault_tree(function)": (but(NAMES, "", None), lambda x: robophm.fault_tree(ROBOT, x)),
    "fault_tree(top)": (but(NAMES, None), lambda x: robophm.fault_tree(ROBOT, top=x)),
    "dynamic_tree": (PATHS, lambda x: robophm.dynamic_tree(x, 1.0)),
    "dynamic_tree(hours)": (NUMBERS, lambda x: robophm.dynamic_tree("tree.dft", x)),
    "dynamic_tree(seconds)": ([*NUMBERS, 0], lambda x: robophm.dynamic_tree("tree.dft", 1.0, seconds=x)),
    "cutsets(hours)": (NUMBERS, lambda x: robophm.cutsets(ROBOT, hours=x)),
    "cutsets(most)": ([*NUMBERS, 0, 10**6], lambda x: robophm.cutsets(ROBOT, most=x)),
    "cutsets(order)": (but([*NUMBERS, 0], None), lambda x: robophm.cutsets(ROBOT, order=x)),
    "calibrate": ([*PATHS[:-2], PATHS[-1]], robophm.calibrate),
    "calibrate(jobs)": ([*NUMBERS, 0, 257], lambda x: robophm.calibrate("a.csv", jobs=x)),
    "simulate(design)": (PATHS, lambda x: robophm.simulate(x, "fleet")),
    "simulate(folder)": (but(PATHS, "no/such/file"), lambda x: robophm.simulate("robot.yaml", x)),
    "simulate(robots)": ([*NUMBERS, 0], lambda x: robophm.simulate("robot.yaml", "fleet", robots=x)),
    "task(tasks)": (but([*PATHS, *THINGS], None), lambda x: robophm.task(ROBOT, x)),
    "task(failed)": (["whel", 5, None, {"whel": 1}, ["whel"], [5]], lambda x: robophm.task(ROBOT, failed=x)),
    "task(future)": (NAMES, lambda x: robophm.task(ROBOT, future=x)),
    "task(draws)": ([*NUMBERS, 10**9], lambda x: robophm.task(ROBOT, draws=x)),
    "why": ([*PATHS, *THINGS[5:]], robophm.why),
    "why(store)": (but(THINGS, None), lambda x: robophm.why(ROBOT, x)),
    "service(part)": (NAMES, lambda x: robophm.service(ROBOT, x, "no.db")),
    "service(store)": (THINGS, lambda x: robophm.service(ROBOT, "wheel", x)),
    "service(repaired)": (but([*NUMBERS, 1.5], None), lambda x: robophm.service(ROBOT, "wheel", "no.db", repaired=x)),
    "import_legacy": (PATHS, robophm.import_legacy),
    "rows": (THINGS, robophm.rows),
    "frame": (THINGS, robophm.frame),
    "plot": (THINGS, robophm.plot),
    "Robot": ([], ROBOT.all_components), "HealthReport": ([], HEALTH.to_json), "RobophmError": ([], str),
}  # fmt: skip


def one_line(error: robophm.RobophmError) -> None:
    said = str(error)
    assert said
    assert "\n" not in said
    assert len(said) <= LONGEST_TEXT + 10


@pytest.mark.parametrize("call", CALLS)
def test_hostile_values_are_one_line(call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    values, ask = CALLS[call]
    for value in values:
        try:
            found = ask(value)
        except robophm.RobophmError as error:
            one_line(error)
        else:
            pytest.fail(f"{call} took {value!r}: {found!r}")
    assert list(tmp_path.iterdir()) == []


def test_the_table_has_every_public_name() -> None:
    for name in robophm.__all__:
        assert any(call.startswith(name) or f"{name}." in call for call in CALLS), name
    assert set(robophm.__all__) <= set(dir(robophm))


@pytest.mark.parametrize("shape", [(), (1,), (5,), (2, 3), (0,), (2, 1, 2)])
def test_as_many_hours_in_as_reliabilities_out(shape: tuple[int, ...]) -> None:
    hours = np.arange(1.0, 1.0 + math.prod(shape)).reshape(shape)
    found = HEALTH.reliability(hours)
    assert np.shape(found) == shape
    for i in np.ndindex(shape):
        assert np.asarray(found)[i] == pytest.approx(HEALTH.reliability(float(hours[i])), rel=1e-14)
    assert HEALTH.reliability([1, 2]).tolist() == [HEALTH.reliability(1), HEALTH.reliability(2)]  # type: ignore[attr-defined]
    assert isinstance(HEALTH.reliability(np.float32(2)), float)


def test_one_validation_for_the_file_and_python() -> None:
    """The same words, whichever way a task comes in."""
    from robophm.design.task_file import parse_plan

    for leg, said in [
        ({"functions": ("driv",)}, "no function 'driv'; did you mean 'drive'?"),
        ({"stresses": {"tempratur": 20.0}}, "no part takes a stress 'tempratur'; did you mean 'temperature'?"),
        (
            {"stresses": {"Powr/temperature": 20.0}},
            "no part below 'Powr' takes a stress 'temperature'; did you mean 'Power'?",
        ),
        ({"stresses": {"temperature": 900.0}}, "900 degC of Power/battery is outside"),
        ({"cycles": 1e16}, "1e+16 cycles; expected at most 1e+15"),
    ]:
        with pytest.raises(robophm.RobophmError) as raised:
            HEALTH.completion(robophm.Task((robophm.Leg(1.0, **leg),)))  # type: ignore[arg-type]
        assert said in str(raised.value)
        written = {key: list(value) if isinstance(value, tuple) else value for key, value in leg.items()}
        if "stresses" in leg:
            written["stresses"] = {key: f"{value} degC" for key, value in leg["stresses"].items()}  # type: ignore[attr-defined]
        text = json.dumps({"schema_version": 1, "tasks": [{"duration": "1 h", **written}]})
        with pytest.raises(robophm.RobophmError) as raised:
            parse_plan(text, ROBOT)
        assert said in str(raised.value)


@pytest.mark.parametrize("name", life_distributions())
def test_lives_of_hostile_ages(name: str) -> None:
    kind = robophm.life_distribution(name)
    shapes = {"shape": 1.5, "log_deviation": 1.5, "deviation": 15.0}
    shape = {key: value for key, value in shapes.items() if key in kind.dimensions and key != kind.scale_parameter}
    try:
        one = kind.with_mean(100.0, **shape)
    except robophm.RobophmError as error:  # its parameters alone say what it is
        one_line(error)
        return
    asked: list[Call] = [one.cumulative_hazard, one.hazard, one.survival, one.failure_probability, one.density,
                         one.quantile, one.age_at, one.mean_residual_life, lambda x: one.increment(1.0, x),
                         lambda x: one.increment(x, 1.0), kind.with_mean, kind.with_rate]  # fmt: skip
    for bad in NUMBERS:
        for ask in asked:
            try:
                found = ask(bad)
            except robophm.RobophmError as error:
                one_line(error)
            else:  # not a number comes of what is none, and of ages without end
                assert isinstance(found, kind) or np.isfinite(found).all() or not np.isfinite(bad).all() or bad is True


def test_what_is_listed_is_public_and_all_of_it() -> None:
    """What a shell completes after ``robophm.`` is what may be used, before and after anything was asked for."""
    assert robophm.load
    assert dir(robophm) == sorted(robophm.__all__)
    assert not [name for name in dir(robophm) if name.startswith("_") or not hasattr(robophm, name)]
