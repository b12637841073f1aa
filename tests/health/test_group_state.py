"""Robots with standby and load sharing groups: every figure against closed forms, and the laws that must hold."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from mpmath import mp
from scipy import stats
from scipy.integrate import quad

from robophm.design.file import parse
from robophm.design.robot import Robot
from robophm.design.task import Knowledge, Leg, Task
from robophm.health.mission import completion, consecutive_completions, deciding_components, repetitions
from robophm.health.outlooks import as_designed, nominal_outlook
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook

L = 0.01
Function = Callable[[mp.mpf], mp.mpf]


def robot(diagram: str, parts: str = "{A: {rate: 0.01 /h}, B: {rate: 0.01 /h}}") -> Robot:
    return parse(f"schema_version: 1\nname: rover\ncomponents: {parts}\ndiagram: {diagram}\n", "robot.yaml")


def new(robot: Robot, **knowledge: tuple[str, ...]) -> Outlook:
    return as_designed(Plant(robot), Knowledge(**{name: frozenset(parts) for name, parts in knowledge.items()}))


def old(robot: Robot, hours: float, **knowledge: tuple[str, ...]) -> Outlook:
    plant = Plant(robot)
    known = Knowledge(**{name: frozenset(parts) for name, parts in knowledge.items()})
    return nominal_outlook(plant, np.full(len(robot.modes), hours), known)


def hours(*durations: float) -> Task:
    return Task(tuple(Leg(duration=one, distance=0.0) for one in durations))


COLD = "{standby: {of: [A, B]}}"
AGES = "{A: {rate: 0.01 /h, life: {distribution: weibull, shape: 2.5}}, B: {rate: 0.02 /h}}"


def test_a_cold_pair() -> None:
    """R = exp(−λt)(1 + λt), h = λ²t/(1 + λt), MTTF = 2/λ; after t: R(t + m)/R(t), as it is known to work."""
    one = robot(COLD)
    outlook, t, m = old(one, 100.0), 100.0, 50.0
    assert float(outlook.survival(one.diagram).works) == pytest.approx(math.exp(-1) * 2, rel=1e-13)
    assert outlook.hazard_rate(one.diagram) == pytest.approx(L * L * t / (1 + L * t), rel=1e-12)
    assert new(one).hazard_rate(one.diagram) == 0
    assert new(one).remaining_life(one.diagram).mean == pytest.approx(200.0, rel=1e-9)
    task = completion(outlook, hours(m))
    assert task.probability == pytest.approx(math.exp(-L * m) * (1 + L * (t + m)) / (1 + L * t), rel=1e-13)
    curve = new(one).survival_curve(one.diagram, np.array([50.0, 300.0]))
    np.testing.assert_allclose(curve.works, [math.exp(-0.5) * 1.5, math.exp(-3) * 4], rtol=1e-13)
    np.testing.assert_allclose(curve.density, [L * 0.5 * math.exp(-0.5), L * 3 * math.exp(-3)], rtol=1e-12)


def test_it_is_one_unit_among_others() -> None:
    """In parallel with a third part, and drawn in two functions."""
    one = robot(f"{{parallel: [{COLD}, C]}}", "{A: {rate: 0.01 /h}, B: {rate: 0.01 /h}, C: {rate: 0.03 /h}}")
    pair, third = math.exp(-1) * 2, math.exp(-3)
    state = old(one, 100.0).survival(one.diagram)
    assert float(state.failed) == pytest.approx((1 - pair) * (1 - third), rel=1e-12)
    text = (
        "schema_version: 1\nname: rover\nmodules: {M: {components: {A: {rate: 0.01 /h}, B: {rate: 0.01 /h}}, "
        f"diagram: {COLD}}}}}\ncomponents: {{C: {{rate: 0.03 /h}}}}\n"
        "functions: {go: {series: [M, C]}, see: M}\n"
    )
    two = parse(text, "robot.yaml")
    task = Task((Leg(20.0, functions=("go",), distance=0.0), Leg(30.0, functions=("see",), distance=0.0)))
    found = completion(new(two), task)
    assert found.probability == pytest.approx(math.exp(-0.6) * math.exp(-0.5) * 1.5, rel=1e-12)


def test_what_is_known_of_members() -> None:
    """B alone is a part of constant rate; A known to work makes the pair as good as new, cold and without ageing."""
    one = robot(COLD)
    assert completion(old(one, 70.0, failed=("A",)), hours(50.0)).probability == pytest.approx(
        math.exp(-0.5), rel=1e-13
    )
    assert completion(new(one, failed=("A",)), hours(50.0)).probability == pytest.approx(math.exp(-0.5), rel=1e-9)
    fresh = completion(old(one, 70.0, working=("A", "B")), hours(50.0)).probability
    assert fresh == pytest.approx(math.exp(-0.5) * 1.5, rel=1e-13)
    lost = old(one, 70.0, failed=("A", "B"))
    assert completion(lost, hours(1.0)).probability == 0
    assert lost.remaining_life(one.diagram).median == 0
    watched = robot(COLD, "{A: {rate: 0.01 /h, monitored: true}, B: {rate: 0.01 /h, monitored: true}}")
    assert completion(old(watched, 70.0), hours(50.0)).probability == pytest.approx(fresh, rel=1e-13)


NARROW = {
    "{distribution: lognormal, log_mean: 6.9, log_deviation: 0.05}": stats.lognorm(0.05, scale=math.exp(6.9)),
    "{distribution: gamma, shape: 400, scale: 2.5 h}": stats.gamma(400, scale=2.5),
    "{distribution: weibull, shape: 60, scale: 1000 h}": stats.weibull_min(60, scale=1000),
    "{distribution: weibull, shape: 2, scale: 500 h, location: 500 h}": stats.weibull_min(2, loc=500, scale=500),
    "{distribution: normal, centre: 1000 h, deviation: 20 h}": stats.norm(1000, 20),
}


@pytest.mark.parametrize("first", NARROW)
@pytest.mark.parametrize("then", NARROW)
def test_what_failed_at_once_however_unlikely(first: str, then: str) -> None:
    """In a new robot the other begins now: R is its survival, and the mean its mean."""
    one = robot(COLD, f"{{A: {{life: {first}}}, B: {{life: {then}}}}}")
    outlook = new(one, failed=("A",))
    assert completion(outlook, hours(900.0)).probability == pytest.approx(NARROW[then].sf(900.0), rel=1e-9)
    assert outlook.remaining_life(one.diagram).mean == pytest.approx(NARROW[then].mean(), rel=1e-6)


@pytest.mark.parametrize("now", [1.0, 30.0, 300.0])
def test_what_failed_early_however_unlikely(now: float) -> None:
    """Of a cold pair the second has worked since then: ∫ f(τ)·S(t − τ)dτ, relative to that of now."""
    mu, sigma = mp.mpf("6.9"), mp.mpf("0.05")
    one = robot(COLD, "{A: {life: {distribution: lognormal, log_mean: 6.9, log_deviation: 0.05}}, "
                      "B: {life: {distribution: weibull, shape: 1.5, scale: 700 h}}}")  # fmt: skip

    def joint(t: float) -> mp.mpf:
        def integrand(x: mp.mpf) -> mp.mpf:
            density = mp.exp(-(((mp.log(x) - mu) / sigma) ** 2) / 2) / x
            return density * mp.exp(-(((t - x) / 700) ** mp.mpf("1.5")))

        return mp.quad(integrand, [now * part for part in (0.5, 0.9, 0.97, 0.99, 0.995, 0.999, 1)])

    found = completion(old(one, now, failed=("A",)), hours(400.0)).probability
    assert found == pytest.approx(float(joint(now + 400) / joint(now)), rel=1e-9)


def test_a_warm_spare_that_failed_early_however_unlikely() -> None:
    """It did while it waited, of a chance far below what a number holds: the first works on, by its own life."""
    lives = "{life: {distribution: lognormal, log_mean: 6.9, log_deviation: 0.05}}"
    one = robot("{standby: {of: [A, B], dormancy: 0.1}}", f"{{A: {lives}, B: {lives}}}")
    found = completion(old(one, 300.0, failed=("B",)), hours(700.0)).probability
    life = stats.lognorm(0.05, scale=math.exp(6.9))
    assert found == pytest.approx(life.sf(1000.0) / life.sf(300.0), rel=1e-9)


WORN = "{A: {life: {distribution: weibull, shape: 2.5, scale: 1000 h}, quantity: %d, monitored: %s}}"
OF_WORN = stats.weibull_min(2.5, scale=1000)


def test_equal_parts_known_to_work_have_aged_as_they_worked() -> None:
    """The active one is 300 h old, its spare new: though both are of one component."""
    one = robot("{standby: {of: [A]}}", WORN % (2, "true"))
    old_sf = OF_WORN.sf(300.0)
    second = quad(lambda x: OF_WORN.pdf(300 + x) / old_sf * OF_WORN.sf(200 - x), 0, 200, epsrel=1e-12)[0]
    found = completion(old(one, 300.0), hours(200.0)).probability
    assert found == pytest.approx(OF_WORN.sf(500.0) / old_sf + second, rel=1e-10)


def test_two_active_of_three_that_age() -> None:
    """Two places, of which each goes on with the spare: all known to work, or that the first has failed; also new."""
    diagram, now, t = "{standby: {of: [A], active: 2}}", 300.0, 500.0
    watched, one = robot(diagram, WORN % (3, "true")), robot(diagram, WORN % (3, "false"))
    stays = OF_WORN.sf(t) / OF_WORN.sf(now)
    goes_on = quad(lambda x: OF_WORN.pdf(x) * OF_WORN.sf(t - x), now, t, epsrel=1e-12)[0] / OF_WORN.sf(now)
    found = completion(old(watched, now), hours(t - now)).probability
    assert found == pytest.approx(stays * (stays + 2 * goes_on), rel=1e-10)

    went_on = [quad(lambda x: OF_WORN.pdf(x) * OF_WORN.sf(end - x), 0, now, epsrel=1e-12)[0] for end in (now, t)]  # noqa: B023
    for failed in ("A[1]", "A[2]"):
        found = completion(old(one, now, failed=(failed,)), hours(t - now)).probability
        assert found == pytest.approx(went_on[1] / went_on[0] * stays, rel=1e-10)
        assert completion(new(one, failed=(failed,)), hours(t)).probability == pytest.approx(
            OF_WORN.sf(t) ** 2, rel=1e-12
        )
    assert completion(new(one, failed=("A[3]",)), hours(1.0)).probability == 0  # which it only does when called


def test_load_shared_by_two() -> None:
    """R = 2·exp(−(λ' )t)… for λ, then 4λ: (4·exp(−2λt) − 2·exp(−4λt))/2."""
    one = robot("{load_sharing: {of: [A, B], exponent: 2}}")
    works = float(old(one, 80.0).survival(one.diagram).works)
    assert works == pytest.approx((4 * math.exp(-1.6) - 2 * math.exp(-3.2)) / 2, rel=1e-13)
    stated = robot("{load_sharing: {of: [A, B], factors: [1, 4]}}")
    assert float(old(stated, 80.0).survival(stated.diagram).works) == pytest.approx(works, rel=1e-14)


def test_equal_parts_of_one_component_are_members() -> None:
    one = robot("{standby: {of: [A], switch: 0.9}}", "{A: {rate: 0.01 /h, quantity: 2}}")
    assert float(old(one, 50.0).survival(one.diagram).works) == pytest.approx(math.exp(-0.5) * 1.45, rel=1e-13)


@pytest.mark.parametrize("parts", ["{A: {rate: 0.01 /h}, B: {rate: 0.02 /h}}", AGES])
def test_laws_of_tasks(parts: str) -> None:
    """Splitting a leg changes nothing; PoTC of A then B is that of A times that of B given A succeeded."""
    one = robot("{standby: {of: [A, B], dormancy: 0.3, switch: 0.9}}", parts)
    outlook = old(one, 40.0)
    whole, split = completion(outlook, hours(50.0)), completion(outlook, hours(20.0, 30.0))
    assert split.failure == pytest.approx(whole.failure, rel=1e-12)
    assert split.probability == pytest.approx(whole.probability, rel=1e-12)
    first, then = consecutive_completions(outlook, [hours(20.0), hours(30.0)])
    assert first.probability * then.probability == pytest.approx(whole.probability, rel=1e-12)
    rounds = np.hstack(list(repetitions(outlook, [hours(10.0)], 5)))
    assert np.prod(rounds[0]) == pytest.approx(whole.probability, rel=1e-12)
    assert float(outlook.curve(one.diagram)(np.array([50.0]))[0][0]) == pytest.approx(whole.failure, rel=1e-12)
    assert completion(outlook, hours(60.0)).probability < whole.probability


def test_ages_that_do_not_keep_their_proportions() -> None:
    """A waits in operating hours, B in kilometres: legs that stand and legs that drive bend the path."""
    text = (
        "schema_version: 1\nname: rover\nusage: {kilometres: 2 km/h}\ncomponents: {A: {rate: 0.01 /h}, "
        "B: {rate: 0.02 /km, clock: kilometres}}\ndiagram: {standby: {of: [A, B]}}\n"
    )
    one = parse(text, "robot.yaml")
    task = Task((Leg(30.0, distance=0.0), Leg(20.0, distance=100_000.0)))
    stands, drives, rate = 30.0, 20.0, 0.02 * 5  # per hour while it drives
    # A until the end; or A fails standing, and B outlives all the driving; or A fails x into it, and B the rest.
    expected = math.exp(-L * (stands + drives)) - math.expm1(-L * stands) * math.exp(-rate * drives)
    expected += math.exp(-L * stands - rate * drives) * L * math.expm1((rate - L) * drives) / (rate - L)
    assert completion(new(one), task).probability == pytest.approx(expected, rel=1e-12)


def test_a_group_decides_as_one() -> None:
    one = robot(f"{{series: [{COLD}, C]}}", "{A: {rate: 0.01 /h}, B: {rate: 0.01 /h}, C: {rate: 1e-6 /h}}")
    first, second = deciding_components(new(one), hours(50.0))
    assert first.path == "standby of A, B"
    assert first.failure_without == pytest.approx(-math.expm1(-50e-6), rel=1e-12)
    assert second.path == "C"


@pytest.mark.full
def test_the_rate_at_the_corner_between_past_and_present() -> None:
    """A cold pair whose spare has aged less than the first part, and now ages as fast: by mpmath's quadrature."""
    lives = (1.8, 4000), (1.5, 5000)
    life = "life: {{distribution: weibull, shape: {}, scale: {} h}}".format
    one = robot(COLD, f"{{A: {{{life(*lives[0])}}}, B: {{{life(*lives[1])}}}}}")
    (first, outlives), (second, alive) = (weibull(*map(mp.mpf, life)) for life in lives)
    outlook, ratio = nominal_outlook(Plant(one), np.array([2000.0, 700.0])), mp.mpf(700) / 2000

    def over(f: Function) -> mp.mpf:
        return mp.quad(lambda t: first(t) * f((2000 - t) * ratio), [0, 1, 10, 100, 1000, 1900, 1990, 1999, 2000])

    expected = over(second) / (outlives(mp.mpf(2000)) + over(alive))
    assert outlook.hazard_rate(one.diagram) == pytest.approx(float(expected), rel=1e-12)


def weibull(shape: mp.mpf, scale: mp.mpf) -> tuple[Function, Function]:
    """Density and survival."""

    def survival(t: mp.mpf) -> mp.mpf:
        return mp.exp(-((t / scale) ** shape))

    return lambda t: shape / scale * (t / scale) ** (shape - 1) * survival(t), survival
