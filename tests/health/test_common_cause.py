"""Parts with a common cause while they live: closed forms in exact arithmetic."""

from __future__ import annotations

import json
from fractions import Fraction
from typing import Any

import pytest
from mpmath import exp, expm1, mp, mpf

from robophm.core.errors import DesignError
from robophm.core.signal import HOUR, SECOND, Sample
from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Leg, Task
from robophm.design.task_file import parse_plan
from robophm.health.exposure import ExposureIntegrator
from robophm.health.ledger import Ledger
from robophm.health.mission import completion, deciding_components
from robophm.health.outlooks import nominal_outlook, outlooks
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.reporting import health_report
from robophm.health.uncertainty import completion_uncertainty

START = 1_700_000_000 * SECOND
BETA = Fraction(1, 10)
PAIR = {"diagram": {"parallel": ["A", "B"]}, "common_causes": {"heat": {"of": ["A", "B"], "beta": 0.1}}}
WEAR = {"life": {"distribution": "weibull", "scale": "100 h", "shape": 2}}  # H = (age / 100 h)²
HOT = {"temperature": {"topic": "/a", "field": "c", "range": [-40, 200], "max_age": "1e6 s"}}


def robot(components: dict[str, Any], **more: Any) -> Robot:
    return parse(json.dumps({"schema_version": 1, "name": "R", "components": components, **more}))


def exact(value: Any, rel: float = 1e-12) -> Any:
    return pytest.approx(float(value), rel=rel, abs=0)


def worn(age: Any) -> mpf:
    return mpf(age) ** 2 / 10_000


def fails(hazard: Any) -> mpf:
    return -expm1(-mpf(hazard))


def aged(design: Robot, hours: float, knowledge: Knowledge | None = None) -> Outlook:
    plant = Plant(design)
    return nominal_outlook(plant, plant.initial + hours, knowledge)


def hours(length: float) -> Task:
    return Task((Leg(length),))


@pytest.mark.parametrize("age", [1e-7, 1.0, 60.0, 300.0])
def test_a_pair_survives_if_no_cause_strikes_and_one_outlives_its_own(age: float) -> None:
    """R = exp(−βH) · (1 − (1 − exp(−(1−β)H))²), both tails with all digits."""
    H, beta = worn(age), mpf(1) / 10
    state = aged(robot({"A": WEAR, "B": WEAR}, **PAIR), age).survival(robot({"A": WEAR, "B": WEAR}, **PAIR).diagram)
    both = fails((1 - beta) * H) ** 2
    assert float(state.works) == exact(exp(-beta * H) * (1 - both))
    assert float(state.failed) == exact(fails(beta * H) + exp(-beta * H) * both)


def test_the_hazard_rate_of_a_pair() -> None:
    """f/R since new, of a constant rate λ: β·λ + 2(1−β)λ·q/(1 + q) with q = 1 − exp(−(1−β)λt) of each."""
    design = robot({"A": {"rate": "0.01 /h"}, "B": {"rate": "0.01 /h"}}, **PAIR)
    q = fails(mpf("0.009") * 50)
    expected = mpf("0.001") + 2 * mpf("0.009") * (1 - q) * q / (1 - q**2)
    assert aged(design, 50.0).hazard_rate(design.diagram) == exact(expected)


KNOWN = {  # what is known: (of A, of the cause), as the age of what may have happened unseen
    "nothing": (Knowledge(), {}, 40, 40),
    "A monitored": (Knowledge(), {"monitored": True}, 0, 0),
    "A works": (Knowledge(working=frozenset({"A"})), {}, 0, 0),
    "no common failure yet": (Knowledge(working=frozenset({"heat"})), {}, 40, 0),
}


@pytest.mark.parametrize("known", KNOWN)
def test_what_works_proves_that_no_cause_has_struck_it(known: str) -> None:
    """A monitored or working member tells of the cause, not of the other member. C may do alone."""
    knowledge, more, unseen, unseen_cause = KNOWN[known]
    design = robot({"A": WEAR | more, "B": WEAR, "C": WEAR}, **PAIR | {"diagram": {"parallel": ["A", "B", "C"]}})
    found = completion(aged(design, 40, knowledge), hours(30))

    def lost(a: Any, b: Any, c: Any, cause: Any) -> mpf:
        return (1 - exp(-cause / 10) * (1 - fails(a * 9 / 10) * fails(b * 9 / 10))) * fails(c)

    gained = worn(70) - worn(40)
    later = lost(worn(unseen) + gained, worn(70), worn(70), worn(unseen_cause) + gained)
    now = lost(worn(unseen), worn(40), worn(40), worn(unseen_cause))
    assert (found.probability, found.failure) == (exact((1 - later) / (1 - now)), exact((later - now) / (1 - now)))


def test_a_failed_member_leaves_the_cause_to_those_that_work() -> None:
    """A failed and the pair works, so B works and the cause has not struck: B is left, with all of its rate."""
    design = robot({"A": WEAR, "B": WEAR}, **PAIR)
    found = completion(aged(design, 40, Knowledge(failed=frozenset({"A"}))), hours(30))
    assert (found.probability, found.failure) == (exact(exp(worn(40) - worn(70))), exact(fails(worn(70) - worn(40))))


def test_a_failed_member_of_three_is_taken_to_have_failed_alone() -> None:
    """A failed, one of B and C works: the cause keeps its own probability, as if nothing were known of it."""
    design = robot(
        dict.fromkeys("ABC", WEAR),
        diagram={"parallel": ["A", "B", "C"]},
        common_causes={"heat": {"of": ["A", "B", "C"], "beta": 0.1}},
    )
    found = completion(aged(design, 40, Knowledge(failed=frozenset({"A"}))), hours(30))
    works = [exp(-worn(age) / 10) * (1 - fails(worn(age) * 9 / 10) ** 2) for age in (40, 70)]
    assert found.probability == exact(works[1] / works[0])


def test_a_cause_that_has_struck_takes_all_its_members() -> None:
    design = robot({"A": WEAR, "B": WEAR, "C": WEAR}, **PAIR | {"diagram": {"parallel": ["A", "B", "C"]}})
    found = completion(aged(design, 40, Knowledge(failed=frozenset({"heat"}))), hours(30))
    assert found.failure == exact(fails(worn(70) - worn(40)))  # C alone is left, and works


def test_knowledge_that_contradicts_itself_by_way_of_a_cause_is_refused() -> None:
    design = robot({"A": WEAR, "B": WEAR}, **PAIR)
    tasks = "schema_version: 1\ntasks: [{duration: 1 h}]\nknowledge:\n  failed: [heat]\n  working: [A]\n"
    with pytest.raises(DesignError, match="tasks:5: knowledge/working: A is said to work, and heat to have failed it"):
        parse_plan(tasks, design)
    assert parse_plan(tasks.replace("working: [A]", "working: []"), design).knowledge.failed == {"heat"}


@pytest.mark.parametrize("scaling", ["age", "hazard"])
@pytest.mark.parametrize("event", ["nothing", "A replaced", "A inspected", "cause inspected", "cause replaced"])
def test_a_cause_ages_as_its_members_do_and_outlives_their_replacement(event: str, scaling: str) -> None:
    """A is twice as stressed as B; half of what the cause gathers is of each. A new A does not renew it."""
    part = WEAR | {"scaling": scaling, "acceleration": {"model": "q10"}}
    B = part | {"signals": {"temperature": HOT["temperature"] | {"topic": "/b"}}}
    design = robot({"A": part, "B": B}, signals=HOT, max_gap="1e6 s", **PAIR)
    exposure, ledger = ExposureIntegrator(design), Ledger.new(design)
    ledger.started = START

    def live(until: float) -> None:
        samples = [Sample(ledger.integrated_to or START, name, at) for name, at in (("/a.c", 35.0), ("/b.c", 25.0))]
        exposure.integrate(ledger, samples, START + round(until * HOUR))

    live(20)
    what, _, happened = event.partition(" ")
    keys = [mode.key for mode in design.modes if mode.path.partition("/")[0] == {"cause": "heat"}.get(what, what)]
    if happened:
        (ledger.replace if happened == "replaced" else ledger.inspect)(keys)
    live(50)

    def gathered(begin: Any, end: Any, factor: int) -> mpf:
        by_age = scaling == "age"
        return (worn(factor * end) - worn(factor * begin)) if by_age else factor * (worn(end) - worn(begin))

    A = {"replaced": gathered(0, 30, 2), "inspected": gathered(20, 50, 2)}.get(event[2:], gathered(0, 50, 2))
    cause = sum(gathered(0, 50, factor) for factor in (1, 2)) / 2
    if event == "cause inspected":
        cause = sum(gathered(20, 50, factor) for factor in (1, 2)) / 2
    elif event == "cause replaced":
        cause = sum(gathered(0, 30, factor) for factor in (1, 2)) / 2
    outlook = outlooks(Plant(design), exposure, Ledger.of(design, ledger.to_json()))["sensor_based"]
    system = outlook.plant.system(design.diagram)
    known = dict(
        zip(outlook.plant.units, outlook.known(outlook.plant.everything, system.needed[:0].any()), strict=True)
    )
    assert known["A"] == exact(A * 9 / 10)
    assert known["B"] == exact(gathered(0, 50, 1) * 9 / 10)
    assert known["heat"] == exact(cause / 10)

    lived = dict(zip(outlook.plant.units, outlook.plant.everything.of_units(outlook.cumulative_hazard), strict=True))
    since = {"A": 20 if event == "A replaced" else 0, "heat": 20 if event == "cause replaced" else 0}
    assert lived["A"] == exact(gathered(0, 50 - since["A"], 2) * 9 / 10)
    assert lived["heat"] == exact(sum(gathered(0, 50 - since["heat"], factor) for factor in (1, 2)) / 20)


def test_a_cause_idles_with_its_members_and_feels_what_is_stated_of_them() -> None:
    """Only A is needed, and hot; B rests at a tenth. The cause gathers half of what each does."""
    part = {"rate": "0.01 /h", "duty": 0.1, "acceleration": {"model": "q10"}}
    design = robot({"A": part, "B": part}, functions={"a": "A"}, **PAIR)
    outlook = outlooks(Plant(design), ExposureIntegrator(design), Ledger.new(design))["sensor_based"]
    task = Task((Leg(10.0, functions=("a",), stresses={"A/temperature": 35.0}),))
    own, cause = mpf("0.009") * 20, (mpf("0.0005") * 20 + mpf("0.0005") * 1)
    assert completion(outlook, task).probability == exact(exp(-own - cause))
    assert {one.path: one.failure_without for one in deciding_components(outlook, task)} == {
        "A": exact(fails(cause)),
        "heat": exact(fails(own)),
    }


def test_a_cause_has_the_uncertain_rate_of_its_members() -> None:
    """Two equal parts of one rate, gamma with k = 2: E exp(−θs) = (1 + s/k)^−k, over all that both share."""
    part = {"rate": "0.01 /h", "quantity": 2, "required": 1, "uncertainty": {"failures": 2}}
    design = robot({"A": part}, common_causes={"heat": {"of": ["A"], "beta": 0.1}})
    found = completion_uncertainty(aged(design, 0.0), hours(100.0), draws=4000)

    def mean(hazard: Any) -> mpf:
        return (1 + mpf(hazard) / 2) ** -2

    # exp(−βH)·(2·exp(−(1−β)H) − exp(−2(1−β)H)) at H = θ
    expected = 2 * mean(1) - mean(mpf(19) / 10)
    assert found.mean.probability == pytest.approx(float(expected), rel=1e-3)


def test_unlikely_draws_are_drawn_again_together() -> None:
    """A part that has long outlived its stated rate, its cause with it: gamma k = 1 becomes Lomax of both."""
    part = {"rate": "0.01 /h", "quantity": 2, "uncertainty": {"failures": 1}}
    design = robot({"A": part}, common_causes={"heat": {"of": ["A"], "beta": 0.1}})
    age, ahead = 5000.0, 500.0
    found = completion_uncertainty(aged(design, age), hours(ahead), draws=4000)
    whole = mpf("1.9") / 100  # both alone, and together
    assert found.mean.probability == pytest.approx(float((1 + whole * age) / (1 + whole * (age + ahead))), rel=0.01)


def test_single_points_of_failure_include_what_is_shared() -> None:
    design = robot({"Board": WEAR, "A": WEAR | {"depends_on": "Board"}, "B": WEAR | {"depends_on": "Board"}}, **PAIR)
    plant = Plant(design)
    system = plant.system(design.diagram)
    assert dict(zip([plant.units[i] for i in system.units], system.needed.tolist(), strict=True)) == {
        "A": False, "B": False, "Board": True, "heat": True,
    }  # fmt: skip


def test_a_report_states_the_cause_beside_its_members() -> None:
    design = robot({"A": {"rate": "0.01 /h"}, "B": {"rate": "0.01 /h"}}, **PAIR)
    report = health_report(Plant(design), ExposureIntegrator(design), Ledger.new(design), parts=True)
    rates = {part.path: part.nominal_hazard_rate for part in report.components}
    assert rates == {"A": exact(0.009), "B": exact(0.009), "heat": exact(0.001)}
    assert json.loads(json.dumps(report.to_json()))["components"][2]["path"] == "heat"


@pytest.fixture(autouse=True, scope="module")
def _more_digits() -> Any:
    with mp.workdps(60):
        yield
