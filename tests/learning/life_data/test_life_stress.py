"""Lives at stress against published answers, and simulated ones whose truth is known."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import lognorm, weibull_min

from robophm.core.errors import DataError
from robophm.design.file import parse
from robophm.learning.failure_mode_edits import edited
from robophm.learning.life_data.distribution_fitting import fit
from robophm.learning.life_data.fit_in_design import design_keys, snippet
from robophm.learning.life_data.life_stress import BOLTZMANN, ZERO, fit_life_stress
from robophm.learning.life_data.observed_lives import LifeData, life_data

CASES = {c["name"]: c for c in json.loads((Path(__file__).parents[2] / "data/life_cases.json").read_text())["cases"]}
pytest.importorskip("surpyval")


def cells(rows, stress):
    """Of (stress, failures, censored, their time)."""
    low, high, count, at = [], [], [], []
    for value, failures, censored, end in rows:
        low += [*failures, end][: len(failures) + (censored > 0)]
        high += [*failures, math.inf][: len(failures) + (censored > 0)]
        count += [*[1] * len(failures), censored][: len(failures) + (censored > 0)]
        at += [value] * (len(failures) + (censored > 0))
    arrays = (np.array(one, dtype=float) for one in (low, high, count))
    return LifeData("test", *arrays, "h", {stress: np.array(at, dtype=float)})


def test_nist_arrhenius_lognormal():
    case = CASES["nist_arrhenius_lognormal_mle"]
    expected, tolerance = case["expected"], case["tolerance"]
    end = case["data"]["censor_time"]
    data = cells([(float(T), f, n - len(f), end) for T, (f, n) in case["data"]["cells"].items()], "temperature")
    found = fit_life_stress(data, "lognormal", reference={"temperature": 40.0})
    energy, rel = found.coefficients["temperature"].value, tolerance["params_rel"]
    assert energy == pytest.approx(expected["deltaH_eV"], rel=rel)
    intercept = found.parameters["log_mean"].value - energy / (BOLTZMANN * (40 + ZERO))
    assert intercept == pytest.approx(expected["intercept"], rel=rel)
    assert found.parameters["log_deviation"].value == pytest.approx(expected["sigma"], rel=rel)
    assert found.log_likelihood == pytest.approx(expected["loglik"], abs=tolerance["loglik_abs"])
    assert math.sqrt(found.covariance[2, 2]) == pytest.approx(expected["se_deltaH"], rel=0.002)
    ratio, freedom, p = found.separate
    assert ratio == pytest.approx(expected["LR_vs_separate"], abs=tolerance["LR_abs"])
    assert (freedom, p) == (3, pytest.approx(expected["LR_pvalue_df3"], abs=1e-4))
    assert [(parts, failures) for _, parts, failures, _, _ in found.levels] == [(100, 5), (50, 35), (25, 24)]


def test_nelson_class_b_insulation():
    case = CASES["nelson_class_b_arrhenius_lognormal"]
    rows = [(float(T), *case["data"][T]) for T in ("150", "170", "190", "220")]
    found = fit_life_stress(cells(rows, "temperature"), "lognormal", reference={"temperature": 130.0})
    expected, tolerance = case["expected"], case["tolerance"]
    B = found.coefficients["temperature"].value / BOLTZMANN
    C = math.exp(found.parameters["log_mean"].value - B / (130 + ZERO))
    assert found.parameters["log_deviation"].value == pytest.approx(expected["sigma"], rel=tolerance["sigma_rel"])
    assert pytest.approx(expected["B_K"], rel=tolerance["B_rel"]) == B
    assert pytest.approx(expected["C"], rel=tolerance["C_rel"]) == C
    assert found.separate is None  # at 150 °C nothing failed


def test_mylar_inverse_power():
    case = CASES["me_19_10_mylar_ipl_lognormal"]
    rows = [(float(V), times, 0, 0) for V, times in case["data"].items() if V != "x"]
    found = fit_life_stress(cells(rows, "voltage"), "lognormal", reference={"voltage": 1.0}, level=0.95)
    expected, (sigma, beta0, beta1) = case["expected"], case["tolerance"]["CI_abs"]
    assert found.log_likelihood == pytest.approx(expected["loglik"], abs=case["tolerance"]["loglik_abs"])
    assert found.parameters["log_deviation"][1:] == pytest.approx(expected["sigma_95CI"], abs=sigma)
    assert found.parameters["log_mean"][1:] == pytest.approx(expected["beta0_95CI"], abs=beta0)
    low, high = found.coefficients["voltage"][1:]
    assert (-high, -low) == pytest.approx(expected["beta1_95CI"], abs=beta1)


def test_fatigue_power_weibull():
    """The printed figures are of a search over a, n and β that ends where the likelihood grows by less than 0.001.

    Its a, of 4·10⁵ beside n of −1.4, is then still where it was, 1.3 % off; n and β are at their best for that a. So
    all four printed figures follow within the gate once a is held; without that ours are likelier.
    """
    case = CASES["modarres_fatigue_power_weibull"]
    data, expected = case["data"], case["expected"]
    lives = life_data(
        data["failures"], data["right_censored"],
        stresses={"stress": [*data["failure_stresses"], *data["right_censored_stresses"]]},
    )  # fmt: skip
    found = fit_life_stress(lives, reference={"stress": float(data["use_stress"])})

    def log_likelihood(a, n, beta):
        u = beta * np.log(lives.low / (a * lives.stresses["stress"] ** n))
        return np.sum(np.where(lives.failed, math.log(beta) - np.log(lives.low) + u, 0) - np.exp(u))

    held = expected["mean_life_use"] / (60 ** expected["n"] * math.gamma(1 + 1 / expected["beta"]))
    best = minimize(lambda x: -log_likelihood(held, *x), [-1.0, 2.0], method="Nelder-Mead", options={"xatol": 1e-9})
    n, beta = best.x
    gate = case["tolerance"]["rel"]
    assert n == pytest.approx(expected["n"], rel=gate / 10)
    assert beta == pytest.approx(expected["beta"], rel=gate / 10)
    assert -best.fun == pytest.approx(expected["loglik"], abs=1e-4)
    assert held * 60**n * math.gamma(1 + 1 / beta) == pytest.approx(expected["mean_life_use"], rel=gate / 10)
    # Over all three it goes on, and that is where ours is, by SurPyval.
    best = minimize(
        lambda x: -log_likelihood(math.exp(x[0]), *x[1:]), [13.0, n, beta], method="Nelder-Mead",
        options={"xatol": 1e-10, "fatol": 1e-13, "maxiter": 5000},
    )  # fmt: skip
    assert -found.coefficients["stress"].value == pytest.approx(best.x[1], rel=1e-5)
    assert found.parameters["shape"].value == pytest.approx(best.x[2], rel=1e-5)
    assert found.log_likelihood == pytest.approx(-best.fun, abs=1e-8)
    assert -best.fun > expected["loglik"] + 4e-5
    assert found.log_likelihood == pytest.approx(expected["loglik"], rel=gate)
    assert found.parameters["shape"].value == pytest.approx(expected["beta"], rel=gate)


def test_insulating_oil():
    """Nelson's oil, its data recalled: no gate, and it agrees."""
    case = CASES["nelson_insulating_oil_ipl_weibull"]
    rows = [(float(V), times, 0, 0) for V, times in case["data"].items()]
    found = fit_life_stress(cells(rows, "voltage"), reference={"voltage": 1.0}, level=0.95)
    expected, tolerance = case["expected"], case["tolerance"]
    assert found.coefficients["voltage"].value == pytest.approx(expected["n"], rel=tolerance["n_rel"])
    assert found.parameters["shape"].value == pytest.approx(expected["beta"], abs=tolerance["beta_abs"])
    assert 1 / found.parameters["scale"].value == pytest.approx(expected["K"], rel=tolerance["K_rel"])
    assert found.parameters["shape"][1:] == pytest.approx(expected["beta_95CI"], abs=tolerance["CI_abs"])


def drawn(rng, stresses, acceleration, shape=2.0, count=40):
    """Weibull lives of η = 5000 h at the reference, by stress."""
    low = np.concatenate([5000 * rng.weibull(shape, count) / acceleration(*one) for one in stresses])
    columns = [np.repeat(column, count) for column in np.array(stresses, dtype=float).T]
    return low, columns


def k(celsius):
    return celsius + ZERO


def test_eyring_peck_and_a_design():
    """Truths of a simulation are within their intervals, and the design accelerates as the fit does."""
    rng = np.random.default_rng(8)
    energy = 0.7

    def arrhenius(T):
        return math.exp(energy / BOLTZMANN * (1 / k(40) - 1 / k(T)))

    low, (T,) = drawn(rng, [(80,), (100,), (120,)], lambda T: arrhenius(T) * k(T) / k(40))
    found = fit_life_stress(life_data(low, stresses={"temperature": T}), reference={"temperature": 40.0},
                            laws={"temperature": "eyring"}, level=0.99)  # fmt: skip
    assert found.coefficients["temperature"].low < energy < found.coefficients["temperature"].high
    # A likelihood of the times themselves, not of the times speeded up by the known factor.
    af = np.exp(found.coefficients["temperature"].value / BOLTZMANN * (1 / k(40) - 1 / k(T))) * k(T) / k(40)
    scaled = low * af / found.parameters["scale"].value
    beta = found.parameters["shape"].value
    by_hand = np.sum(np.log(beta / found.parameters["scale"].value * af) + (beta - 1) * np.log(scaled) - scaled**beta)
    assert found.log_likelihood == pytest.approx(by_hand, abs=1e-3)
    low, (T, RH) = drawn(rng, [(85, 85), (85, 60), (60, 85)], lambda T, RH: arrhenius(T) * (RH / 50) ** 3.0)
    both = fit_life_stress(life_data(low, stresses={"temperature": T, "humidity": RH}), level=0.99,
                           reference={"temperature": 40.0, "humidity": 50.0})  # fmt: skip
    assert both.coefficients["temperature"].low < energy < both.coefficients["temperature"].high
    assert both.coefficients["humidity"].low < 3.0 < both.coefficients["humidity"].high
    lines = "\n".join(["schema_version: 1", "name: R", "components:", "  sensor:", "    rate: 5 FPMH  # guess"])
    new = parse(edited(lines, "R", {"sensor": design_keys(both)}))
    (stress,) = new.modes[0].stresses
    factor = float(stress.factor({"temperature": np.array(85.0), "humidity": np.array(60.0)}).value)
    assert factor == pytest.approx(both.acceleration({"temperature": 85.0, "humidity": 60.0}), rel=1e-4)
    assert new.modes[0].life.mean() == pytest.approx(both.life.mean(), rel=1e-4)
    assert new.modes[0].life.shape == pytest.approx(both.life.shape, rel=1e-4)


def test_dual_stress_of_temperature_and_voltage():
    rng = np.random.default_rng(12)
    low, (T, V) = drawn(rng, [(85, 30), (85, 40), (110, 30)], lambda T, V: 2 ** ((T - 40) / 10) * (V / 24) ** 4)
    found = fit_life_stress(life_data(low, stresses={"temperature": T, "voltage": V}), "lognormal", level=0.99,
                            reference={"temperature": 40.0, "voltage": 24.0}, laws={"temperature": "q10"})  # fmt: skip
    assert found.coefficients["temperature"].low < 2 < found.coefficients["temperature"].high
    assert found.coefficients["voltage"].low < 4 < found.coefficients["voltage"].high
    assert "acceleration: [{model: q10" in "\n".join(snippet(found))


def test_step_stress_by_cumulative_exposure():
    """Voltage goes up in steps, of another length for every fourth part; what a step used up stays used up."""
    rng = np.random.default_rng(6)
    items, low, high, volts = [], [], [], []
    for i in range(60):
        left, t = 2000 * rng.weibull(2.0), 0.0
        for V in (24, 30, 36, 42, 48):
            speed = (V / 24) ** 3.0
            step = min((25.0, 100.0, 400.0, 1600.0)[i % 4], left / speed)
            t, left = t + step, left - step * speed
            items.append(f"i{i}")
            low.append(t)
            volts.append(V)
            high.append(math.inf if left > 1e-9 else t)
            if left <= 1e-9:
                break
    data = LifeData("steps", np.array(low), np.array(high), np.ones(len(low)), "h",
                    {"voltage": np.array(volts, dtype=float)}, tuple(items))  # fmt: skip
    found = fit_life_stress(data, reference={"voltage": 24.0}, level=0.99)
    assert found.steps
    assert found.coefficients["voltage"].low < 3 < found.coefficients["voltage"].high
    assert found.parameters["scale"].low < 2000 < found.parameters["scale"].high
    bad = LifeData("steps", np.array([5.0, 3.0]), np.array([math.inf, 3.0]), np.ones(2), "h",
                   {"voltage": np.array([1.0, 2.0])}, ("a", "a"))  # fmt: skip
    with pytest.raises(DataError, match=r"(steps that end at 5 and then 3|failures for 3 parameters)"):
        fit_life_stress(bad, reference={"voltage": 1.0})


@pytest.mark.parametrize(
    ("stresses", "reference", "laws", "said"),
    [
        ({}, {}, {}, "states no stress; expected a column such as"),
        ({"temperature": [50, 50, 50, 80]}, {"temperature": 25}, {}, "failures at only one temperature"),
        ({"temperature": [50, 60, 60, 50]}, {}, {}, "at which temperature will parts be used"),
        ({"temperature": [50, 60, 60, 50]}, {"temprature": 25}, {}, "'temprature'; did you mean 'temperature'"),
        ({"temperature": [50, 60, 60, 50]}, {"temperature": -300}, {}, "below absolute zero"),
        ({"voltage": [5, 6, 0, 5]}, {"voltage": 3}, {}, "voltage of 0 or less has no power law"),
        ({"voltage": [5, 6, 6, 5]}, {"voltage": 3}, {"voltage": "arrhenius"}, "arrhenius is a law of temperature"),
        ({"voltage": [5, 6, 6, 5]}, {"voltage": 3}, {"voltage": "power"}, "no law 'power'"),
        ({"voltage": [5, 6, 6, 5], "temperature": [50, 60, 60, 50]}, {"voltage": 3, "temperature": 20}, {},
         "(go up and down together|failures for 4 parameters)"),
    ],
)  # fmt: skip
def test_refusals(stresses, reference, laws, said):
    data = life_data([5.0, 6, 9], [10.0], stresses=stresses)
    with pytest.raises(DataError, match=said):
        fit_life_stress(data, reference=reference, laws=laws)


def test_what_a_design_cannot_say():
    rng = np.random.default_rng(1)
    low, (x,) = drawn(rng, [(1,), (2,), (4,)], lambda x: x**2)
    found = fit_life_stress(life_data(low, stresses={"grit": x}), reference={"grit": 1.0})
    with pytest.raises(DataError, match="a design knows no power law of 'grit'"):
        design_keys(found)
    mode = parse("{schema_version: 1, name: R, usage: {kilometres: 1 km/h}, components: {a: {rate: 1 /km, clock:"
                 " kilometres}}}").modes[0]  # fmt: skip
    with pytest.raises(DataError, match=r"'a' ages by km \(kilometres clock\), but data counts h"):
        design_keys(found, mode)
    endless = fit(life_data([1.0, 2, 40, 3000, 90000]), "loglogistic")
    with pytest.raises(DataError, match="no mean life"):
        snippet(endless)


def looked_at(rng, name, levels, every, end, parts):
    """Parts at inverse-power stress that somebody looks at now and then: between which looks each failed."""
    low, high, at = [], [], []
    for stress in levels:
        scale = 4000 * (10 / stress) ** 2.5
        lives = scale * (rng.weibull(2.0, parts) if name == "weibull" else np.exp(0.4 * rng.standard_normal(parts)))
        before = np.floor(lives / every) * every
        low += np.where(lives < end, before, end).tolist()
        high += np.where(lives < end, before + every, np.inf).tolist()
        at += [float(stress)] * parts
    return np.array(low), np.array(high), np.array(at)


@pytest.mark.full
@pytest.mark.parametrize("name", ["weibull", "lognormal"])
def test_lives_within_intervals(name):
    """Against the likelihood of all censoring written down and searched by scipy: intervals, left, right, and known."""
    low, high, at = looked_at(np.random.default_rng(4), name, (20, 30, 45), 120.0, 900.0, 25)
    low[::9] = high[::9] = np.where(np.isfinite(high[::9]), low[::9] + 50, low[::9] + 1)  # some are known
    lives = LifeData("data", low, high, np.ones(len(low)), "h", {"voltage": at})
    assert np.any((low == 0) & (high > 0))
    found = fit_life_stress(lives, name, reference={"voltage": 10.0})

    def miss(x):
        scale, shape, n = math.exp(x[0]), math.exp(x[1]), x[2]
        life = (weibull_min(shape, scale=scale) if name == "weibull" else lognorm(shape, scale=scale))  # fmt: skip
        u, v = (side * (at / 10) ** n for side in (low, high))
        exact = low == high
        log = np.where(
            exact, life.logpdf(u) + n * np.log(at / 10), np.log(np.maximum(life.cdf(v) - life.cdf(u), 1e-300))
        )
        return -log.sum()

    options = {"xatol": 1e-9, "fatol": 1e-12, "maxiter": 20_000, "maxfev": 20_000}
    best = minimize(miss, [math.log(4000), 0.0, 2.0], method="Nelder-Mead", options=options)
    assert found.log_likelihood == pytest.approx(-best.fun, rel=1e-8)
    assert found.coefficients["voltage"].value == pytest.approx(best.x[2], rel=1e-4)
    shape = found.parameters["shape" if name == "weibull" else "log_deviation"]
    assert shape.value == pytest.approx(math.exp(best.x[1]), rel=1e-4)
    assert found.life.quantile(0.5) == pytest.approx(
        (
            weibull_min(shape.value, scale=math.exp(best.x[0]))
            if name == "weibull"
            else lognorm(1, scale=math.exp(best.x[0]))
        ).ppf(0.5),
        rel=1e-3,
    )
    assert found.coefficients["voltage"].low < 2.5 < found.coefficients["voltage"].high
    assert found.quantiles[0.5].low < found.quantiles[0.5].value < found.quantiles[0.5].high


def test_narrow_intervals_are_known_times():
    """By Eyring, whose known part is of the times: what a narrow interval says is what its time says."""
    rng, kelvins = np.random.default_rng(6), np.repeat([80.0, 100.0, 120.0], 12)
    times = 1000 * np.exp(-0.03 * kelvins) * rng.weibull(2.0, 36) * 100
    known = LifeData("data", times, times, np.ones(36), "h", {"temperature": kelvins})
    narrow = LifeData("data", times * (1 - 1e-4), times * (1 + 1e-4), np.ones(36), "h", {"temperature": kelvins})
    a, b = (
        fit_life_stress(one, reference={"temperature": 40.0}, laws={"temperature": "eyring"}) for one in (known, narrow)
    )
    assert b.coefficients["temperature"].value == pytest.approx(a.coefficients["temperature"].value, rel=1e-4)
    assert b.life.mean() == pytest.approx(a.life.mean(), rel=1e-3)
    # A width of 2e-4 t in the place of a density: ln of it apart.
    assert b.log_likelihood == pytest.approx(a.log_likelihood + np.log(2e-4 * times).sum(), abs=1e-2)


def test_intervals_that_tell_no_spread():
    low = np.array([100.0, 100.0, 100.0, 10.0, 10.0, 10.0])
    lives = LifeData("data", low, 2 * low, np.ones(6), "h", {"voltage": np.repeat([10.0, 20.0], 3)})
    with pytest.raises(DataError, match="at each stress one moment explains all lives"):
        fit_life_stress(lives, reference={"voltage": 5.0})
    assert fit_life_stress(lives, "exponential", reference={"voltage": 5.0}).life.mean() > 100
    same = LifeData("data", low, low, np.ones(6), "h", {"voltage": np.repeat([10.0, 20.0], 3)})
    with pytest.raises(DataError, match="at each stress one moment explains all lives"):
        fit_life_stress(same, reference={"voltage": 5.0})
