"""Against mpmath at 60 digits, evaluated at the very doubles that the distribution is given."""

import math
from functools import cache

import mpmath as mp
import numpy as np
import pytest
from tests.cases import some

from robophm.life.curve import Curve
from robophm.life.exponential import Exponential
from robophm.life.extreme_value import ExtremeValue
from robophm.life.gamma import Gamma
from robophm.life.loglogistic import Loglogistic
from robophm.life.lognormal import Lognormal
from robophm.life.normal import Normal
from robophm.life.piecewise import Piecewise
from robophm.life.rayleigh import Rayleigh
from robophm.life.weibull import Weibull

SECOND = 1 / 3600
SHAPES = (0.3, 0.5, 0.9, 1.0, 1.5, 2.0, 3.7, 8.0)
LIVES = [
    Exponential(1 / 3e4),
    Exponential(1 / 3e4, location=12.3),
    Rayleigh(2e4),
    *(Weibull(2e4, shape) for shape in SHAPES),
    Weibull(2e4, 2.5, location=12.3),
    *(Gamma(3e3, shape) for shape in (0.05, 0.1, *SHAPES, 50.0, 300.0)),
    Gamma(3e3, 2.5, location=12.3),
    *(Loglogistic(2e4, shape) for shape in SHAPES),
    Loglogistic(2e4, 2.5, location=12.3),
    *(Lognormal(9.7, deviation) for deviation in (0.1, 0.3, 1.0, 2.5, 8.0)),
    Lognormal(9.7, 0.8, location=12.3),
    *(Curve(1 / 3e4, shape) for shape in SHAPES),
    Curve(1 / 3e4, 2.5, location=12.3),
    Normal(2e4, 1e2),
    Normal(2e4, 3e3),
    Normal(2e4, 4e5),
    ExtremeValue(2e4, 1e2),
    ExtremeValue(2e4, 3e3),
    ExtremeValue(2e4, 4e5),
    Piecewise((0, 100, 5e3, 2e4), (2e-3, 1e-5, 0, 3e-4)),
    Piecewise((0.1, 100, 5e3), (2e-3, 1e-5, 2e-4)),
]
AGES = [m * 10.0**n for n in range(-3, 6) for m in (1.0, 3.7)] + [1e6]


@pytest.fixture(autouse=True)
def _digits():
    with mp.workdps(60):
        yield


def truth(life):
    """H and h of an age, in mpmath and from the textbook's definition of each distribution."""
    p = {name: mp.mpf(value) for name, value in vars(life).items() if isinstance(value, float)}
    location = p.get("location", mp.mpf(0))
    H, h = (remembered(function) for function in of_x(life, p))
    if life.lowest < 0:
        return (lambda t: H(t - location)), (lambda t: h(t - location))
    return (lambda t: H(max(t - location, 0))), (lambda t: h(t - location) if t >= location else mp.mpf(0))


def remembered(function):
    """The same, worked out once for each x and number of digits."""
    known = cache(lambda x, _: function(x))
    return lambda x: known(x, mp.mp.prec)


def of_x(life, p):
    match life:
        case Exponential():
            return (lambda x: p["rate"] * x), (lambda x: p["rate"])
        case Weibull() | Rayleigh():
            scale, shape = p["scale"], p.get("shape", mp.mpf(2))
            return (lambda x: (x / scale) ** shape), (lambda x: shape / scale * (x / scale) ** (shape - 1))
        case Loglogistic():
            scale, shape = p["scale"], p["shape"]
            return (
                lambda x: mp.log1p((x / scale) ** shape),
                lambda x: shape / scale * (x / scale) ** (shape - 1) / (1 + (x / scale) ** shape),
            )
        case Curve():
            rate, shape = p["rate"], p["shape"]
            return (
                lambda x: mp.expm1((rate * x) ** shape),
                lambda x: shape * rate * (rate * x) ** (shape - 1) * mp.exp((rate * x) ** shape),
            )
        case ExtremeValue():
            return (lambda x: mp.exp(x / p["scale"])), (lambda x: mp.exp(x / p["scale"]) / p["scale"])
        case Piecewise():
            knots = [mp.mpf(age) for age in life.ages]
            pieces = list(zip(knots, [*knots[1:], mp.inf], map(mp.mpf, life.hazard_rates), strict=True))
            return (
                lambda x: mp.fsum(rate * max(min(x, end) - start, 0) for start, end, rate in pieces),
                lambda x: mp.fsum(rate for start, end, rate in pieces if start <= x < end),
            )
        case Gamma():
            k, scale = p["shape"], p["scale"]
            return of_tails(
                lambda x: mp.gammainc(k, 0, x / scale, regularized=True),
                lambda x: mp.gammainc(k, x / scale, regularized=True),
                lambda x: (x / scale) ** (k - 1) * mp.exp(-x / scale) / scale / mp.gamma(k),
            )
        case Normal():
            return of_z(lambda x: (x - p["centre"]) / p["deviation"], lambda x: p["deviation"])
        case Lognormal():
            mu, sigma = p["log_mean"], p["log_deviation"]
            return of_z(lambda x: (mp.log(x) - mu) / sigma if x else -mp.inf, lambda x: sigma * x)


def of_z(z, unit):
    return of_tails(lambda x: upper(-z(x)), lambda x: upper(z(x)), lambda x: mp.npdf(z(x)) / unit(x))


def upper(z):
    """The upper tail of the standard normal."""
    return mp.erfc(z / mp.sqrt(2)) / 2


def of_tails(F, S, f):
    return (lambda x: -mp.log1p(-failed) if (failed := F(x)) < 0.5 else -mp.log(S(x))), (lambda x: f(x) / S(x))


def error(value, expected):
    """Relative error; what is beyond a double counts as right where it is inf or 0."""
    value = float(value)
    if expected > 1e300:
        return 0.0 if value > 0.99e300 else math.inf
    if expected < 1e-290:
        return 0.0 if 0 <= value < 1e-289 else math.inf
    return float(abs(mp.mpf(value) / expected - 1))


@pytest.mark.parametrize("life", some(LIVES), ids=str)
def test_increments_of_a_second_and_of_an_age(life):
    H, _ = truth(life)
    for age in AGES:
        for duration in (SECOND, age / 100, age / 3, age, 2.5 * age, 10 * age, 1e4 * age):
            after = H(mp.mpf(age) + mp.mpf(duration))
            expected = after - H(mp.mpf(age))
            # Beyond the tails exp(z) and z² carry the rounding of z itself. SciPy's own F is good to 1e-13.
            tolerance = 3e-14 if 1e-30 < expected < 1e3 and not isinstance(life, Gamma) else 5e-13
            assert error(life.increment(age, duration), expected) < tolerance, (age, duration)


@pytest.mark.parametrize("life", LIVES, ids=str)
def test_cumulative_hazard_and_hazard(life):
    H, h = truth(life)
    for age in AGES:
        expected = H(mp.mpf(age))
        assert error(life.cumulative_hazard(age), expected) < 5e-13, age
        assert error(life.hazard(age), h(mp.mpf(age))) < 5e-13, age
        if expected < 700:
            assert error(life.survival(age), mp.exp(-expected)) < 5e-13, age
            assert error(life.failure_probability(age), -mp.expm1(-expected)) < 5e-13, age


@pytest.mark.parametrize("life", [life for life in LIVES if not getattr(life, "location", 0)], ids=str)
@pytest.mark.parametrize("H_asked", [1e-30, 1e-12, 1e-3, 0.5, 30.0, 30 * math.log(10), 1e3])
def test_age_at_in_both_tails(life, H_asked):
    H, h = truth(life)
    age = mp.mpf(float(life.age_at(H_asked)))
    if isinstance(life, Piecewise) and life.ages[0] > 0 and H_asked < 1e-20:
        assert age == life.ages[0]  # the nearest double is the knot itself
    elif age == 0 or mp.isinf(age):
        assert of_power(life, H_asked)
    else:
        assert abs((H(age) - mp.mpf(H_asked)) / (h(age) * age)) < 1e-13


def of_power(life, H):
    """Where the true age is beyond a double: x = scale·H^(1/shape), or scale·exp(H/shape)."""
    match life:
        case Gamma(scale=scale, shape=shape):
            return mp.log(scale) + (mp.log(H) + mp.loggamma(shape + 1)) / shape < -708
        case Loglogistic(scale=scale, shape=shape):
            return mp.log(scale) + H / mp.mpf(shape) > 709
    return False


@pytest.mark.parametrize("life", LIVES, ids=str)
def test_quantiles_where_failure_or_survival_is_1e_30(life):
    H, h = truth(life)
    tiny = mp.mpf(1e-30)
    early = mp.mpf(float(life.quantile(1e-30)))
    if early > 0 and early not in (getattr(life, "location", 0), getattr(life, "ages", (0,))[0]):
        assert abs((-mp.expm1(-H(early)) - tiny) / (mp.exp(-H(early)) * h(early) * early)) < 1e-12
    late = mp.mpf(float(life.age_at(-math.log(1e-30))))
    assert abs((mp.exp(-H(late)) - tiny) / (mp.exp(-H(late)) * h(late) * late)) < 1e-12
    assert error(life.survival(float(late)), mp.exp(-H(late))) < 1e-12
    assert error(life.failure_probability(float(early)), -mp.expm1(-H(early))) < 1e-12
    assert error(life.hazard(float(late)), h(late)) < 1e-12


MEAN_LIVES = [
    Exponential(1 / 3e4, location=12.5),
    Rayleigh(2e4, location=12.5),
    *(Weibull(2e4, shape) for shape in SHAPES),
    Weibull(2e4, 50.0),
    *(Gamma(3e3, shape) for shape in (*SHAPES, 50.0, 300.0)),
    *(Loglogistic(2e4, shape) for shape in (1.1, 1.5, 2.5, 8.0, 50.0)),
    *(Lognormal(9.7, deviation) for deviation in (0.01, 0.1, 0.3, 1.0, 2.5)),
    Curve(1 / 3e4, 1.0),
    Normal(2e4, 1e2),
    Normal(2e4, 4e5),
    ExtremeValue(2e4, 1e2),
    ExtremeValue(2e4, 4e5),
    Piecewise((0, 1e4), (2e-4, 1e-5)),
]


def mean_residual_life(life, t):
    """The closed form of each, from the textbook."""
    H, _ = truth(life)
    p = {name: mp.mpf(value) for name, value in vars(life).items() if isinstance(value, float)}
    location = p.get("location", mp.mpf(0)) if life.lowest == 0 else mp.mpf(0)
    wait, x = max(location - t, 0), (max(t - location, 0) if life.lowest == 0 else t)
    y = H(t)
    match life:
        case Exponential():
            rest = 1 / p["rate"]
        case Rayleigh() | Weibull():
            shape = p.get("shape", mp.mpf(2))
            rest = p["scale"] / shape * mp.exp(y) * mp.gammainc(1 / shape, y)
        case Gamma():
            k, scale = p["shape"], p["scale"]
            more, S = (mp.gammainc(n, x / scale, regularized=True) for n in (k + 1, k))
            rest = k * scale * more / S - x
        case Loglogistic():
            q = 1 / p["shape"]
            with mp.workdps(300):  # S is very near to 1
                y = H(t)
                rest = p["scale"] * q * mp.exp(y) * mp.betainc(1 - q, q, 0, mp.exp(-y))
        case Lognormal():
            s = p["log_deviation"]
            z = (mp.log(x) - p["log_mean"]) / s if x else -mp.inf
            rest = mp.exp(p["log_mean"] + s**2 / 2) * upper(z - s) / upper(z) - x
        case Curve():  # shape 1
            rest = mp.exp(1 + y) * mp.e1(1 + y) / p["rate"]
        case Normal():
            z = (x - p["centre"]) / p["deviation"]
            rest = p["deviation"] * (mp.npdf(z) / upper(z) - z)
        case ExtremeValue():
            rest = p["scale"] * mp.exp(y) * mp.e1(y)
        case Piecewise(ages=(_, knot), hazard_rates=(early, late)):
            early, late, left = mp.mpf(early), mp.mpf(late), max(mp.mpf(knot) - x, 0)
            rest = -mp.expm1(-early * left) / early + mp.exp(-early * left) / late
    return wait + rest


@pytest.mark.parametrize("life", MEAN_LIVES, ids=str)
def test_mean_residual_life(life):
    H, _ = truth(life)
    ages = [age for age in (0.0, 1e-3, 7.0, 300.0, 9e3, 2e4, 7e4, 1e6) if H(mp.mpf(age)) < 1e4]
    found = life.mean_residual_life(np.array(ages))
    for age, value in zip(ages, found, strict=True):
        assert error(value, mean_residual_life(life, mp.mpf(age))) < 1e-11, age
    if life.lowest == 0:
        assert error(life.mean(), mean_residual_life(life, mp.mpf(0))) < 1e-13


@pytest.mark.parametrize(
    "life",
    [
        Exponential(1 / 3e4, location=12.5),
        Rayleigh(2e4),
        Weibull(2e4, 0.7),
        Weibull(2e4, 3.7, location=12.5),
        Gamma(3e3, 2.5),
        Loglogistic(2e4, 3.7),
        Lognormal(9.7, 0.5),
        Curve(1 / 3e4, 0.7),
        Curve(1 / 3e4, 2.5, location=12.5),
        Normal(2e4, 3e3),
        ExtremeValue(2e4, 3e3),
        Piecewise((0, 1e4, 2e4), (2e-4, 0, 1e-5)),
    ],
    ids=str,
)
def test_mean_and_standard_deviation_are_the_integrals(life):
    with mp.workdps(20):
        H, _ = truth(life)
        cuts = [0, 1, 12.5, 100, 1e3, 1e4, 2e4, 3e4, 5e4, 1e5, 3e5, 1e6]
        cuts += [1e7, mp.inf] if H(mp.mpf(1e6)) < 1e3 else []
        first = mp.quad(lambda t: mp.exp(-H(t)), cuts)
        second = mp.quad(lambda t: 2 * t * mp.exp(-H(t)), cuts)
        if life.lowest < 0:
            below = [-1e5, -3e4, -1e4, 0]
            first -= mp.quad(lambda t: -mp.expm1(-H(t)), below)
            second -= mp.quad(lambda t: -2 * t * mp.expm1(-H(t)), below)
        assert error(life.mean(), first) < 1e-12
        assert error(life.standard_deviation(), mp.sqrt(second - first**2)) < 1e-11


def test_long_tails_have_no_mean():
    assert Loglogistic(100, 1.0).mean() == math.inf
    assert Loglogistic(100, 0.7).mean_residual_life(5.0) == math.inf
    assert Loglogistic(100, 2.0).standard_deviation() == math.inf
    assert math.isfinite(Loglogistic(100, 1.01).mean_residual_life(5.0))


@pytest.mark.full
@pytest.mark.parametrize("shape", [1e3, 1e4, 1e6])
@pytest.mark.parametrize("sigmas", [3, 20, 60])
def test_gamma_of_a_large_shape(shape, sigmas):
    age = shape + sigmas * shape**0.5
    k, x = mp.mpf(shape), mp.mpf(age)
    rest = mp.mpf(0)  # the continued fraction of DLMF 8.9.2, run until it no longer moves
    for n in range(20000, 0, -1):
        rest = n * (n - k) / (x + 2 * n + 1 - k - rest)
    hazard = (x + 1 - k - rest) / x
    H = mp.log(hazard) - ((k - 1) * mp.log(x) - x - mp.loggamma(k))
    assert error(Gamma(1.0, shape).hazard(age), hazard) < 1e-11
    assert error(Gamma(1.0, shape).cumulative_hazard(age), H) < 1e-11
