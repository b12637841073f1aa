"""What every life distribution promises, whatever its file: parameters are drawn from its ``dimensions``."""

import math
import pickle
import subprocess
import sys
from dataclasses import MISSING, fields, replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from robophm.core.errors import ModelError, PlugError
from robophm.life import LifeDistribution, life_distribution, life_distributions

NAMES = life_distributions()
SCALELESS = ("markov", "piecewise")
GRID = 2.0**-10  # ages and durations of this grid add without rounding
SECOND = 1 / 3600
grid = st.integers(0, 2**30).map(lambda n: n * GRID)


def parameter(name, dimension):
    if name in ("location", "centre"):
        return st.integers(0, 2**20).map(lambda n: n * GRID)
    if name == "log_mean":
        return st.floats(0, 12)
    return {1: st.floats(10, 1e6), 0: st.floats(0.3, 8), -1: st.floats(1e-6, 0.1)}[dimension]


@st.composite
def lives(draw, name):
    cls = life_distribution(name)
    if name == "markov":
        rate = st.floats(1e-6, 0.1)
        return cls(
            {"whole": {"worn": draw(rate), "failed": draw(rate)}, "worn": {"whole": draw(rate), "dead": draw(rate)}}
        )
    if name == "piecewise":
        ages = sorted(draw(st.sets(st.integers(0, 10**5), min_size=1, max_size=5)))
        return cls(ages, [draw(st.floats(1e-6, 0.1)) for _ in ages])
    return cls(**{key: draw(parameter(key, dimension)) for key, dimension in cls.dimensions.items()})


def shapes(data, cls):
    """All parameters but the scale."""
    given = {key: power for key, power in cls.dimensions.items() if key != cls.scale_parameter}
    return {key: data.draw(parameter(key, power)) for key, power in given.items()}


every = pytest.mark.parametrize("name", NAMES)


def test_these_are_the_distributions():
    assert NAMES == [
        "curve",
        "exponential",
        "extreme_value",
        "gamma",
        "loglogistic",
        "lognormal",
        "markov",
        "normal",
        "piecewise",
        "rayleigh",
        "weibull",
    ]
    with pytest.raises(PlugError, match="no life distribution 'weibul'; did you mean 'weibull'"):
        life_distribution("weibul")
    with pytest.raises(PlugError):
        life_distribution("distribution")


@every
@given(data=st.data())
def test_increments_add_up(name, data):
    life = data.draw(lives(name))
    a, d, e = data.draw(grid), data.draw(grid), data.draw(grid)
    whole = life.increment(a, d + e)
    assume(whole < 1e300)
    assert life.increment(a, d) >= 0
    assert life.increment(a, d) + life.increment(a + d, e) == pytest.approx(whole, rel=1e-11, abs=1e-290)
    assert life.cumulative_hazard(a) + whole == pytest.approx(life.cumulative_hazard(a + d + e), rel=1e-11)
    assert life.increment(a, 0) == 0
    assert life.increment(a, math.inf) == math.inf


@every
@given(data=st.data())
def test_powers_of_age_say_so(name, data):
    """H(θ·age) = θ^β·H(age) exactly where a distribution states its degree β; without a location these three do."""
    life, age, ratio = data.draw(lives(name)), data.draw(grid), data.draw(st.floats(0.01, 100))
    if "location" in life.dimensions and name != "extreme_value":
        life = replace(life, location=data.draw(st.sampled_from([0.0, life.location])))
    unshifted = getattr(life, "location", 0.0) == 0
    assert (life.degree is not None) == (name in ("exponential", "rayleigh", "weibull") and unshifted)
    if life.degree is not None:
        assert life.cumulative_hazard(ratio * age) == pytest.approx(
            ratio**life.degree * life.cumulative_hazard(age), rel=1e-12, abs=1e-290
        )


@every
@given(data=st.data())
def test_age_at_is_the_inverse(name, data):
    life = data.draw(lives(name))
    age = data.draw(grid)
    H, h = life.cumulative_hazard(age), life.hazard(age)
    assume(1e-290 < H < 1e290 and h > 0)
    # The rounding of H, of the age and, in an exponent, of z.
    assert life.age_at(H) == pytest.approx(age, rel=1e-12, abs=1e-12 * float(H / h))
    assert life.age_at(math.inf) == math.inf
    assert life.cumulative_hazard(math.inf) == math.inf


@every
@given(data=st.data())
def test_survival_failure_and_density(name, data):
    life = data.draw(lives(name))
    age = data.draw(grid)
    assert life.survival(age) + life.failure_probability(age) == pytest.approx(1, rel=1e-15)
    assert life.survival(age) == np.exp(-life.cumulative_hazard(age))
    assert 0 <= life.density(age) < math.inf or life.hazard(age) == math.inf
    assert life.density(1e300) == 0


@every
@given(data=st.data())
def test_hazard_is_the_slope(name, data):
    life = data.draw(lives(name))
    age = data.draw(grid)
    d = 1e-9 * max(age, 1e-3)
    start = life.hazard(age), life.hazard(age + d)
    assume(all(1e-280 < h < 1e280 for h in start) and 0.999 < start[0] / start[1] < 1.001)
    assert life.increment(age, d) / d == pytest.approx(float(start[0]), rel=2e-3)


@every
@given(data=st.data())
def test_quantiles_rise(name, data):
    life = data.draw(lives(name))
    ages = life.quantile([1e-30, 1e-9, 0.01, 0.5, 0.99, 1 - 1e-12])
    assert np.all(np.diff(ages) >= 0)
    assert np.all(np.diff(life.cumulative_hazard(ages)) >= 0)
    assert life.quantile(1) == math.inf


@every
@given(data=st.data())
def test_arrays_are_scalars_side_by_side(name, data):
    life = data.draw(lives(name))
    a, d = np.array([[0.0], [1.0], [3e3], [1e6]]), np.array([SECOND, 1.0, 1e5])
    for method in ("cumulative_hazard", "hazard", "survival", "failure_probability", "density", "age_at"):
        found = getattr(life, method)(a)
        assert found.shape == a.shape
        # Not bit for bit: NumPy's vectorised power and its scalar one differ in the last place.
        assert found[2, 0] == pytest.approx(float(getattr(life, method)(3e3)), rel=1e-13)
        assert np.ndim(getattr(life, method)(3e3)) == 0
    assert life.increment(a, d).shape == (4, 3)
    assert life.increment(a, d)[2, 1] == pytest.approx(float(life.increment(3e3, 1.0)), rel=1e-13)
    assert life.mean_residual_life(a).shape == a.shape


@every
@given(data=st.data())
def test_with_mean_and_with_rate(name, data):
    cls = life_distribution(name)
    mean = data.draw(st.floats(2e3, 1e6))
    if cls.scale_parameter is None:
        with pytest.raises(ModelError, match="no scale"):
            cls.with_mean(mean)
        return
    shape = shapes(data, cls)
    if name == "loglogistic" and shape["shape"] <= 1:
        with pytest.raises(ModelError, match="mean is infinite"):
            cls.with_mean(mean, **shape)
        return
    life = cls.with_mean(mean, **shape)
    assert life.mean() == pytest.approx(mean, rel=1e-12)
    if name != "curve":
        assert cls.with_rate(1 / mean, **shape).mean() == pytest.approx(mean, rel=1e-12)
    assert all(getattr(life, key) == value for key, value in shape.items())
    if "location" in shape and life.lowest == 0:
        with pytest.raises(ModelError, match="mean − location"):
            cls.with_mean(shape["location"] - 1, **shape)


def test_curve_keeps_its_rate():
    assert life_distribution("curve").with_rate(0.25, shape=0.7).rate == 0.25


@pytest.mark.parametrize("name", [name for name in NAMES if name not in SCALELESS])
@given(data=st.data())
def test_the_rate_of_a_life_gives_it_again(name, data):
    cls = life_distribution(name)
    shape = shapes(data, cls)
    assume(name != "loglogistic" or shape["shape"] > 1)
    life = cls.with_mean(data.draw(st.floats(2e3, 1e6)), **shape)
    again = cls.with_rate(life.nominal_rate, **shape)
    scale = getattr(life, cls.scale_parameter)
    assert getattr(again, cls.scale_parameter) == pytest.approx(scale, rel=1e-9, abs=1e-6)


@every
@given(data=st.data(), share=st.sampled_from([1e-9, 0.01, 0.1, 0.5, 0.9]))
def test_with_quantile(name, data, share):
    """S(age) = 1 − share, whatever the shape and the location."""
    cls = life_distribution(name)
    if cls.scale_parameter is None:
        with pytest.raises(ModelError, match="no scale"):
            cls.with_quantile(share, 1e3)
        return
    shape = shapes(data, cls)
    age = shape.get("location", 0.0) + data.draw(st.floats(100, 1e6))
    life = cls.with_quantile(share, age, **shape)
    assert life.failure_probability(age) == pytest.approx(share, rel=1e-8)
    assert life.survival(age) == pytest.approx(1 - share, rel=1e-9)
    assert all(getattr(life, key) == value for key, value in shape.items())
    if "location" in shape and life.lowest == 0:
        with pytest.raises(ModelError, match="age − location"):
            cls.with_quantile(share, shape["location"], **shape)
    for wrong in (0.0, 1.0, -0.1, math.nan, True):
        with pytest.raises(ModelError, match="probability"):
            cls.with_quantile(wrong, age, **shape)
    with pytest.raises(ModelError):
        cls.with_quantile(share, "3 h", **shape)


@every
@given(data=st.data())
def test_what_remains_after_waiting(name, data):
    # m(a) ≥ ∫₀ᵈ S(x | a) dx ≥ d·S(d | a), and m(a) ≤ d + S(d | a)·m(a + d).
    life = data.draw(lives(name))
    a, d = data.draw(grid), data.draw(grid)
    remains, share = life.mean_residual_life(a), np.exp(-life.increment(a, d))
    assume(life.hazard(a) < 1e200)
    assert remains >= d * share * (1 - 1e-12)
    if share > 1e-290:
        assert remains <= (d + share * life.mean_residual_life(a + d)) * (1 + 1e-12)


@every
def test_parameters_are_described_and_checked(name):
    cls = life_distribution(name)
    assert issubclass(cls, LifeDistribution)
    assert [field.name for field in fields(cls)] == list(cls.dimensions)
    assert cls.scale_parameter is None or cls.scale_parameter in cls.dimensions
    assert set(cls.dimensions.values()) <= {-1, 0, 1}
    if name in SCALELESS:
        return
    good = {field.name: 3.0 for field in fields(cls)}
    for key in good:
        signless = key in ("location", "centre", "log_mean")
        for bad in (math.nan, math.inf, "3", None, True, *(() if signless else (0, -1.0))):
            with pytest.raises(ModelError, match=f"{cls.__name__}: {key} = .*expected a finite number"):
                cls(**{**good, key: bad})
    life = cls(**good)
    assert life == cls(*good.values())
    assert hash(life) == hash(cls(**good))
    assert pickle.loads(pickle.dumps(life)) == life
    shape = {key: 3.0 for key in good if key != cls.scale_parameter}
    with pytest.raises(ModelError, match="no shape parameter 'shap'"):
        cls.with_rate(1e-4, **shape, shap=2.0)
    for field in fields(cls):
        if field.default is MISSING and field.name != cls.scale_parameter:
            with pytest.raises(ModelError, match=f"'{field.name}' is missing"):
                cls.with_rate(1e-4, **{key: 3.0 for key in shape if key != field.name})


@every
@given(data=st.data())
def test_what_is_not_a_number_stays_so_and_nonsense_is_refused(name, data):
    life = data.draw(lives(name))
    for method in ("cumulative_hazard", "hazard", "survival", "failure_probability", "density", "age_at"):
        assert np.isnan(getattr(life, method)(math.nan)), method
    assert np.isnan(life.increment(math.nan, 1.0))
    assert np.isnan(life.increment(1.0, math.nan))
    with pytest.raises(ModelError, match="duration = -1"):
        life.increment(5.0, -1.0)
    with pytest.raises(ModelError, match="cumulative hazard = -1"):
        life.age_at(-1.0)
    with pytest.raises(ModelError, match="probability"):
        life.quantile(1.5)


@pytest.mark.parametrize("name", ["curve", "exponential", "gamma", "loglogistic", "lognormal", "rayleigh", "weibull"])
def test_nothing_fails_before_the_location(name):
    cls = life_distribution(name)
    rest = {key: 2.0 for key in cls.dimensions if key != "location"}
    life, plain = cls(**rest, location=10.0), cls(**rest)
    assert life.cumulative_hazard([-5, 9.9, 10]).tolist() == [0, 0, 0]
    assert life.hazard([-5, 9.9]).tolist() == [0, 0]
    assert life.increment(0, 10) == 0
    # Of a duration only what lies beyond counts, though its end is rounded: 9.9 + d − 10 loses five digits.
    for duration in (0.1 + 1e-10, 0.1 + 1e-6, 0.3, 5.0):
        beyond = math.fsum((9.9, duration, -10.0))
        assert life.increment(9.9, duration) == pytest.approx(float(plain.increment(0, beyond)), rel=1e-13)
    assert life.mean_residual_life(4.0) == pytest.approx(6 + float(plain.mean_residual_life(0.0)), rel=1e-14)
    assert life.mean() == pytest.approx(10 + plain.mean(), rel=1e-14)


def test_the_room_opens_without_scipy_and_without_its_plugs():
    code = "import sys, robophm.life; sys.exit(any(m == 'scipy' or m.endswith('weibull') for m in sys.modules))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_piecewise_through_points():
    piecewise = life_distribution("piecewise")
    life = piecewise.from_survival([100, 200, 400], [0.9, 0.9, 0.5])
    assert life.ages == (0, 100, 200)
    assert life.survival([0, 100, 150, 200, 400]) == pytest.approx([1, 0.9, 0.9, 0.9, 0.5], rel=1e-14)
    assert life.survival(300) == pytest.approx(math.sqrt(0.9 * 0.5), rel=1e-14)  # ln S is linear between
    assert life.survival(600) == pytest.approx(0.5 * 0.5 / 0.9, rel=1e-14)  # and beyond
    for ages, survivals in (
        ([0, 1], [0.9, 0.5]),
        ([1, 2], [0.5, 0.6]),
        ([1, 2], [0.5, 0.0]),
        ([1, 2], [0.5]),
        ([2, 1], [0.9, 0.5]),
        ([0], [1]),
        ([0, 1], [1, 1]),
        ([], []),
    ):
        with pytest.raises(ModelError, match="Piecewise"):
            piecewise.from_survival(ages, survivals)
    for ages, rates in (([0], [0]), ([0, 0], [1, 1]), ([-1], [1]), ([0, 1], [1]), ([0], ["x"]), (3, 4)):
        with pytest.raises(ModelError, match="Piecewise"):
            piecewise(ages, rates)
