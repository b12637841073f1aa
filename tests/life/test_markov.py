"""Lives through states: closed forms, matrix exponentials in sixty digits, drawn histories, and what is refused."""

import math
from typing import Any

import mpmath
import numpy as np
import pytest

from robophm.core.errors import ModelError, RobophmError
from robophm.design.file import parse
from robophm.life.gamma import Gamma
from robophm.life.markov import Markov
from robophm.life.piecewise import Piecewise

PAIR = Markov({"both": {"one": 2e-5}, "one": {"both": 0.25, "none": 1e-5}})
AGES = np.array([1e-6, 1e-3, 1.0, 100.0, 1e5, 1e9, 1e12])


def pair_survival(age: float) -> mpmath.mpf:
    """A pair of which one part is repaired: two exponentials, by Laplace's transform."""
    first, second, repair = mpmath.mpf(2e-5), mpmath.mpf(1e-5), mpmath.mpf(0.25)
    total = first + second + repair
    root = mpmath.sqrt(total**2 - 4 * first * second)
    slow, fast = (root - total) / 2, (-root - total) / 2
    return (slow * mpmath.exp(fast * age) - fast * mpmath.exp(slow * age)) / (slow - fast)


def test_a_pair_with_repair_in_both_tails() -> None:
    with mpmath.workdps(60):
        expected = [float(-mpmath.log(pair_survival(mpmath.mpf(age)))) for age in AGES]
        slopes = [float(-mpmath.diff(pair_survival, age) / pair_survival(mpmath.mpf(age))) for age in AGES]
    assert PAIR.cumulative_hazard(AGES) == pytest.approx(expected, rel=2e-15)
    assert PAIR.hazard(AGES) == pytest.approx(slopes, rel=1e-13)
    assert PAIR.age_at(expected) == pytest.approx(AGES, rel=2e-15)
    assert PAIR.mean() == pytest.approx((2e-5 + 1e-5 + 0.25) / (2e-5 * 1e-5), rel=1e-15)


def test_twenty_states_one_after_the_other_are_erlangs() -> None:
    life = Markov({f"{number}": {f"{number + 1}": 0.01} for number in range(20)})
    gamma = Gamma(shape=20.0, scale=100.0)
    ages = np.array([1e-3, 1.0, 100.0, 2000.0, 1e4, 1e6])
    for name in ("cumulative_hazard", "hazard", "mean_residual_life"):
        assert getattr(life, name)(ages) == pytest.approx(getattr(gamma, name)(ages), rel=1e-12), name
    assert life.increment(ages, 1.0) == pytest.approx(gamma.increment(ages, 1.0), rel=1e-12)
    assert life.standard_deviation() == pytest.approx(math.sqrt(20) * 100, rel=1e-14)


@pytest.mark.parametrize("seed", range(6))
def test_random_chains_are_matrix_exponentials(seed: int) -> None:
    drawn = np.random.default_rng(seed)
    size = int(drawn.integers(2, 7))
    rates = np.exp(drawn.uniform(np.log(1e-7), 0, (size, size + 1))) * (drawn.random((size, size + 1)) < 0.7)
    rates[np.arange(size), np.arange(size)] = 0
    rates[np.arange(size - 1), np.arange(1, size)] += 1e-3  # each is reached
    rates[-1, -1] += 1e-5  # and ends
    states = {str(i): {str(j): rate for j, rate in enumerate(row) if rate} for i, row in enumerate(rates.tolist())}
    life = Markov(states)
    with mpmath.workdps(80):
        generator = mpmath.matrix(rates[:, :-1].tolist())
        for i, row in enumerate(rates.tolist()):
            generator[i, i] = -mpmath.fsum(row)
        for age in (1e-4, 1.0, 1e3, 1e5):
            after = mpmath.expm(generator * age, method="taylor" if age < 10 else "pade")
            survival = mpmath.fsum(after[0, j] for j in range(size))
            if survival > mpmath.mpf("1e-60"):
                assert float(life.cumulative_hazard(age)) == pytest.approx(float(-mpmath.log(survival)), rel=1e-12)
        means = mpmath.lu_solve(-generator, mpmath.matrix([1] * size))
        assert life.mean() == pytest.approx(float(means[0]), rel=1e-13)


def test_histories_that_are_drawn_live_as_long() -> None:
    drawn = np.random.default_rng(5)
    rates = {"a": {"b": 0.3, "x": 0.02}, "b": {"a": 0.5, "c": 0.2}, "c": {"a": 0.1, "x": 0.4}}
    ends = []
    for _ in range(4000):
        state, age = "a", 0.0
        while state != "x":
            to, each = zip(*rates[state].items(), strict=True)
            age += drawn.exponential(1 / sum(each))
            state = str(drawn.choice(to, p=np.array(each) / sum(each)))
        ends.append(age)
    life = Markov(rates)
    for share in (0.1, 0.5, 0.9):
        below = np.mean(np.array(ends) <= life.quantile(share))
        assert abs(below - share) < 4 * math.sqrt(share * (1 - share) / len(ends))


def test_counted_in_another_unit() -> None:
    other = PAIR.rescaled(3600.0)
    assert other.cumulative_hazard(AGES * 3600) == pytest.approx(PAIR.cumulative_hazard(AGES), rel=1e-13)
    piecewise = Piecewise((0.0, 10.0), (0.1, 0.3))
    assert piecewise.rescaled(2.0) == Piecewise((0.0, 20.0), (0.05, 0.15))


REFUSED = {
    "no states": ({}, "expected at most 50 states, of each the rates"),
    "no mapping": (3, "expected at most 50 states"),
    "a list": ({"a": 3e-6}, "expected at most 50 states"),
    "too many": ({str(n): {str(n + 1): 1.0} for n in range(51)}, "expected at most 50 states"),
    "zero": ({"a": {"b": 0.0}}, "from 'a' to 'b' the rate is 0.0, expected a finite rate > 0 to another state"),
    "to itself": ({"a": {"a": 1.0, "b": 1.0}}, "from 'a' to 'a'"),
    "infinite": ({"a": {"b": math.inf}}, "the rate is inf"),
    "out of reach": ({"a": {"x": 1.0}, "b": {"x": 1.0}}, "nothing leads from 'a' to 'b'"),
    "never fails": ({"a": {"b": 1.0, "x": 1.0}, "b": {"c": 1.0}, "c": {"b": 1.0}}, "nothing fails from 'b' on"),
}


@pytest.mark.parametrize(("states", "says"), REFUSED.values(), ids=REFUSED)
def test_what_makes_no_life_is_refused(states: Any, says: str) -> None:
    with pytest.raises(ModelError, match=says):
        Markov(states)


DESIGN = """
schema_version: 1
name: rover
components:
  drive:
    {figure}
    life: {{distribution: markov, states: {states}}}
diagram: {{series: [drive]}}
"""
STATES = "{both: {one: 20 FPMH}, one: {both: 0.25 /h, none: 10 FPMH}}"


def test_a_design_states_them_with_units() -> None:
    (mode,) = parse(DESIGN.format(figure="description: two motors", states=STATES)).modes
    assert mode.life.cumulative_hazard(AGES) == pytest.approx(PAIR.cumulative_hazard(AGES), rel=1e-12)
    learned = "learned: {factor: 2, shape: 5, failures: 4, expected: 2}"
    (mode,) = parse(DESIGN.format(figure=learned, states=STATES)).modes
    assert mode.life.cumulative_hazard(AGES) == pytest.approx(PAIR.cumulative_hazard(2 * AGES), rel=1e-12)


WRONG = {
    "a rate too": ("rate: 3 FPMH", STATES, "Markov: no scale to set"),
    "a unit of another kind": (
        "description: x",
        "{both: {one: 3 km}}",
        "drive/life/states/both/one: unit 'km' does not measure",
    ),
    "a text": ("description: x", "{both: {one: soon}}", "drive/life/states/both/one: 'soon'"),
    "none that fails": ("description: x", "{a: {b: 1 /h}, b: {a: 1 /h}}", "nothing fails from 'a' on"),
}


@pytest.mark.parametrize(("figure", "states", "says"), WRONG.values(), ids=WRONG)
def test_a_design_that_is_wrong_says_where(figure: str, states: str, says: str) -> None:
    with pytest.raises(RobophmError, match=says) as raised:
        parse(DESIGN.format(figure=figure, states=states))
    assert "\n" not in str(raised.value)
