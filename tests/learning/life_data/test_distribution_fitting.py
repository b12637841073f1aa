"""Life data against published answers (tests/data/life_cases.json says whose), and what is refused in words."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import weibull_min

from robophm.core.errors import DataError, DesignError
from robophm.design.file import load, parse
from robophm.learning.life_data.distribution_fitting import (
    FAMILIES,
    as_good_as_best,
    can_be_corrected,
    fit,
    fit_all,
    goodness,
)
from robophm.learning.life_data.fit_in_design import edited_design
from robophm.learning.life_data.observed_lives import LifeData, life_data, read_life_data
from robophm.learning.life_data.repairable_systems import (
    fit_grouped,
    fit_power_law,
    mean_time_between,
    power_laws,
    systems,
)

ANSWERS = json.loads((Path(__file__).parents[2] / "data/life_cases.json").read_text())
CASES = {case["name"]: case for case in ANSWERS["cases"]}
LUNG = ANSWERS["lung"]
pytest.importorskip("surpyval")


def case(name):
    one = CASES[name]
    return one["data"], one["expected"], one["tolerance"]


def lung():
    died = [t for t, status in zip(LUNG["time"], LUNG["status"], strict=True) if status]
    return life_data(died, [t for t, status in zip(LUNG["time"], LUNG["status"], strict=True) if not status])


def test_abernethy_weibull():
    data, expected, tolerance = case("abernethy_C5_weibull_rc")
    found = fit(life_data(data["failures"], data["right_censored"]))
    assert found.parameters["shape"].value == pytest.approx(expected["beta"], rel=tolerance["rel"])
    assert found.parameters["scale"].value == pytest.approx(expected["eta"], rel=tolerance["rel"])


def test_nist_weibull():
    data, expected, tolerance = case("nist_weibull_rc_mle")
    lives = life_data(data["failures"], data["right_censored"])
    found = fit(lives)
    assert found.parameters["scale"].value == pytest.approx(expected["weibull_eta"], rel=tolerance["params_rel"])
    assert found.parameters["shape"].value == pytest.approx(expected["weibull_beta"], rel=tolerance["params_rel"])
    assert found.log_likelihood == pytest.approx(expected["loglik"], abs=tolerance["loglik_abs"])
    assert found.aic == pytest.approx(expected["AIC_weibull"], abs=tolerance["AIC_abs"])
    assert fit(lives, "lognormal").aic == pytest.approx(expected["AIC_lognormal"], abs=tolerance["AIC_abs"])
    assert found.mean == pytest.approx(expected["mean_h"], rel=tolerance["moments_rel"])
    assert found.life.standard_deviation() == pytest.approx(expected["sd_h"], rel=tolerance["moments_rel"])


def test_gumbel_is_the_logarithm_of_a_weibull():
    data, expected, _ = case("nist_weibull_rc_mle")
    found = fit(life_data(np.log(data["failures"]), np.log(data["right_censored"])), "gumbel")
    rel = CASES["gumbel_sev_identity"]["tolerance"]["rel"]
    assert found.parameters["location"].value == pytest.approx(math.log(expected["weibull_eta"]), rel=rel)
    assert found.parameters["scale"].value == pytest.approx(1 / expected["weibull_beta"], rel=rel)


def test_meeker_escobar_lognormal():
    data, expected, tolerance = case("meeker_escobar_p199_lognormal")
    found = fit(life_data(data["failures"], data["right_censored"]), "lognormal", level=0.95)
    mu, low, high = found.parameters["log_mean"]
    assert mu == pytest.approx(expected["mu"], abs=tolerance["mu_abs"])
    assert (low, high) == pytest.approx(expected["mu_95CI"], abs=tolerance["CI_abs"])
    assert found.covariance == pytest.approx(np.array(expected["cov"]), abs=tolerance["cov_abs"])


def test_lung_exponential():
    _, expected, tolerance = case("lung_exponential_rc")
    found = fit(lung(), "exponential")
    rate = found.parameters["rate"].value
    assert -math.log(rate) == pytest.approx(expected["ln_mean"], rel=tolerance["rel"])
    assert found.log_likelihood == pytest.approx(expected["loglik"], abs=tolerance["loglik_abs"])
    # var(ln θ) = var(λ)/λ², which is 1/failures
    assert float(found.covariance[0, 0]) / rate**2 == pytest.approx(expected["var_ln_mean"], rel=1e-4)


@pytest.mark.parametrize(
    ("name", "distribution", "figures"),
    [
        ("lung_weibull_rc", "weibull", lambda p: {"ln_eta": math.log(p["scale"]), "one_over_beta": 1 / p["shape"]}),
        ("lung_loglogistic_rc", "loglogistic", lambda p: {"mu": math.log(p["scale"]), "s": 1 / p["shape"]}),
        ("lung_gamma_rc", "gamma", lambda p: {"shape": p["shape"], "rate": 1 / p["scale"]}),
    ],
)
def test_lung(name, distribution, figures):
    _, expected, tolerance = case(name)
    found = fit(lung(), distribution)
    for key, value in figures({k: one.value for k, one in found.parameters.items()}).items():
        assert value == pytest.approx(expected[key], rel=tolerance["rel"])
    assert found.log_likelihood == pytest.approx(expected["loglik"], abs=tolerance["loglik_abs"])


def test_normal_with_every_kind_of_censoring(tmp_path):
    data, expected, tolerance = case("interval_normal")
    lines = ["from,to"]
    for left, right in zip(data["columns"]["left"], data["columns"]["right"], strict=True):
        lines.append(f"{left or ''},{'' if right is None else right}")
    path = tmp_path / "lives.csv"
    path.write_text("\n".join(lines) + "\n")
    found = fit(read_life_data(path), "normal")
    assert found.parameters["centre"].value == pytest.approx(expected["mean"], rel=tolerance["rel"])
    assert found.parameters["deviation"].value == pytest.approx(expected["sd"], rel=tolerance["rel"])
    assert found.log_likelihood == pytest.approx(expected["loglik"], abs=tolerance["loglik_abs"])


def test_grouped_exponential_and_shock_absorbers():
    """Recalled from Meeker and Escobar, so no gates; they agree."""
    data, expected, tolerance = case("me_berkson_exponential")
    low = [0.0, *data["lower"][1:-1]]
    rows = [(a, b, n) for a, b, n in zip(low, data["upper"][:-1], data["count"][:-1], strict=True)]
    lower, upper, count = (np.array(column, dtype=float) for column in zip(*rows, strict=True))
    found = fit(LifeData("berkson", lower, upper, count, "h"), "exponential")
    assert 1 / found.parameters["rate"].value == pytest.approx(expected["theta"], rel=tolerance["rel"])
    data, expected, tolerance = case("me_shock_absorber")
    sides = (
        [m for m, e in zip(data["miles"], data["event"], strict=True) if e == kind] for kind in ("Failure", "Censored")
    )
    weibull = fit(life_data(*sides))
    assert math.log(weibull.parameters["scale"].value) == pytest.approx(expected["weibull_mu"], abs=tolerance["abs"])
    assert 1 / weibull.parameters["shape"].value == pytest.approx(expected["weibull_sigma"], abs=tolerance["abs"])


def test_rank_regressions():
    data, expected, tolerance = case("abernethy_fig2_5_rank_regression")
    found = fit(life_data(data["failures"], data["right_censored"]), how="ranks")
    assert found.parameters["shape"].value == pytest.approx(expected["beta"], rel=tolerance["rel"])
    assert found.parameters["scale"].value == pytest.approx(expected["eta"], rel=tolerance["rel"])
    data, expected, tolerance = case("nist_weibull_plot_regression")
    plot = fit(life_data(data["failures"], [500.0] * 10)).plot
    assert plot.failed == pytest.approx((np.arange(1, 11) - 0.3) / 20.4, rel=1e-12)
    slope, intercept = np.polyfit(plot.x / math.log(10), plot.y / math.log(10), 1)
    assert (slope, intercept) == pytest.approx((expected["slope"], expected["intercept"]), abs=tolerance["abs"])


def test_ranks_that_forget_who_still_worked_say_so():
    """Benard's ranks of two failures among a hundred: the line through both is written down, and has all fail by 500 h
    at which 98 still worked.
    """
    found = fit(life_data([2, 3], [500] * 98), how="ranks")
    first, second = (-math.log1p(-(rank - 0.3) / 100.4) for rank in (1, 2))
    shape = math.log(second / first) / math.log(3 / 2)
    expected = sum(first * (t / 2) ** shape for t in (2, 3, *[500] * 98))
    assert found.parameters["shape"].value == pytest.approx(shape, rel=1e-6)
    assert any(f"by this line {expected:.3g} failures would have been expected where 2" in one for one in found.notes)
    assert not any("by this line" in one for one in fit(life_data([200, 300, 420], [500]), how="ranks").notes)


@pytest.mark.full
def test_lives_younger_than_anything_watched_are_said():
    """Of parts watched from half of their age on, with the share before the youngest by SciPy."""
    rng = np.random.default_rng(1)
    ages = rng.weibull(1.5, 20) * 100
    late = replace(life_data(ages.tolist()), since=ages / 2)
    found = fit(late, "weibull")
    before = weibull_min.cdf(ages.min() / 2, found.parameters["shape"].value, scale=found.parameters["scale"].value)
    assert before > 0.01
    assert any(f"{100 * before:.3g} % of its lives end before {ages.min() / 2:.4g} h" in one for one in found.notes)
    with pytest.raises(DataError, match="normal has no best fit here"):  # its mean runs off below zero
        fit(late, "normal")


def test_three_parameters():
    """Simulated beyond a location of 500; published three-parameter answers were not to be had."""
    rng = np.random.default_rng(2)
    found = fit(life_data(500 + 1000 * rng.weibull(2.0, 300)), "weibull3")
    values = {name: one.value for name, one in found.parameters.items()}
    assert values == pytest.approx({"scale": 1000, "shape": 2.0, "location": 500}, rel=0.15)
    assert found.life.survival(499.0) == 1.0 or found.life.location < 500


def test_the_right_distribution_wins():
    rng = np.random.default_rng(9)
    lives = {
        "weibull": 1000 * rng.weibull(3.0, 200), "lognormal": np.exp(rng.normal(6, 1.0, 200)),
        "exponential": rng.exponential(1000, 200),
    }  # fmt: skip
    for name, times in lives.items():
        fits, refused = fit_all(life_data(times))
        assert not refused
        near = as_good_as_best(fits)
        assert name in [one.name for one in (fits[0], *near)]
        far = [one for one in fits[1:] if one not in near]
        assert all(one.aic_corrected >= fits[0].aic_corrected + 2 for one in far)
        assert far
        assert {one.name for one in fits} == set(FAMILIES) - {"weibull3"}
    assert fits[-1].below_zero > 0.01 or fits[-1].name in ("normal", "gumbel")


@pytest.mark.full
def test_three_parts_are_ranked_without_the_correction():
    fits, _ = fit_all(life_data([100.0, 100.0001, 100.0002]))
    assert math.isinf(next(one for one in fits if one.name == "weibull").aic_corrected)
    assert fits[-1].name == "exponential"
    assert not can_be_corrected(fits)
    assert all(one.aic < fits[0].aic + 2 for one in as_good_as_best(fits))


def test_goodness_of_fit():
    rng = np.random.default_rng(4)
    good = fit(life_data(rng.exponential(100, 40)), "exponential")
    assert not goodness(good, 30, 1).doubtful
    bad = fit(life_data(100 + rng.normal(0, 1, 40)), "exponential")
    assert goodness(bad, 30, 1).doubtful


@pytest.mark.parametrize(("shape", "samples"), [(2.5, 15), pytest.param(0.9, 400, marks=pytest.mark.full)])
def test_intervals_hold(shape, samples):
    """90 % intervals of shape and scale of samples of 40, a third of them censored."""
    rng = np.random.default_rng(31)
    held = []
    for _ in range(samples):
        t = 1000 * rng.weibull(shape, 40)
        end = 1000 * math.log(3) ** (1 / shape)
        found = fit(life_data(t[t < end], [end] * int(np.sum(t >= end))))
        for name, true in (("shape", shape), ("scale", 1000.0)):
            held.append(found.parameters[name].low <= true <= found.parameters[name].high)
    assert np.mean(held) == pytest.approx(0.9, abs=2.6 * math.sqrt(0.09 / samples))  # with 99 %, one for each sample


def test_repaired_systems():
    data, expected, tolerance = case("nist_power_law_repair")
    found = fit_power_law({"a": data["event_times"]}, {"a": data["T"]}, level=0.8)
    rel = tolerance["rel"]
    assert 1 - found.shape.value == pytest.approx(expected["beta_modified_growth"], rel=rel)
    assert found.shape.value == pytest.approx(expected["b"], rel=rel)
    assert found.scale == pytest.approx(expected["a"], rel=rel)
    assert found.mean_time.value == pytest.approx(expected["MTBF_at_T"], rel=rel)
    assert (found.mean_time.low, found.mean_time.high) == pytest.approx(expected["MTBF_80CI"], rel=rel)
    data, expected, tolerance = case("milhdbk189_crow_grouped")
    scale, shape = fit_grouped(data["interval_ends"], data["counts"])
    assert (scale, shape) == pytest.approx((expected["lambda"], expected["beta"]), rel=tolerance["rel"])
    intensity = scale * shape * 100 ** (shape - 1)
    assert intensity == pytest.approx(expected["intensity_T"], rel=tolerance["rel"])
    assert 1 / intensity == pytest.approx(expected["MTBF_T"], rel=tolerance["rel"])
    data, expected, _ = case("nist_mtbf_chi2_bounds")
    assert tuple(mean_time_between(data["failures"], data["hours"])) == pytest.approx(
        (expected["MTBF"], expected["lower"], expected["upper"]), abs=1.0
    )
    assert mean_time_between(0, 100.0).high == math.inf


def test_systems_watched_for_different_times():
    """Maximum likelihood of unequal ends solves n/β + Σ ln t = n Σ T^β ln T / Σ T^β."""
    rng = np.random.default_rng(3)
    ends = {"a": 1000.0, "b": 700.0, "c": 400.0}
    times = {name: np.sort(end * rng.random(12) ** (1 / 1.5)).tolist() for name, end in ends.items()}
    beta = fit_power_law(times, ends).shape.value
    n, T = 36, np.array(list(ends.values()))
    logs = sum(np.log(t).sum() for t in times.values())
    assert n / beta + logs == pytest.approx(n * (T**beta @ np.log(T)) / np.sum(T**beta), abs=1e-4)


def lifts(tmp_path, text):
    (tmp_path / "lift.csv").write_text("item,time [h],censored\n" + text)
    return read_life_data(tmp_path / "lift.csv")


def test_repaired_systems_by_both_estimates(tmp_path):
    """NIST's (apr452), and MIL-HDBK-189's n / Σ ln(T/t) by hand."""
    times = [5, 40, 43, 175, 389, 712, 747, 795, 1299, 1478]
    both = power_laws(lifts(tmp_path, "".join(f"a,{t},\n" for t in times) + "a,1500,yes\n"), level=0.8)
    assert list(both) == ["unbiased", "maximum likelihood"]
    unbiased, likeliest = both.values()
    assert unbiased.trend == likeliest.trend == "improving"
    assert unbiased.shape.value == pytest.approx(0.483506, rel=1e-5)
    assert unbiased.mean_time == pytest.approx((310.2, 158, 549), rel=3e-3)
    by_hand = len(times) / sum(math.log(1500 / t) for t in times)
    assert likeliest.shape.value == pytest.approx(by_hand, rel=1e-12)
    assert likeliest.scale == pytest.approx(len(times) / 1500**by_hand, rel=1e-12)
    assert likeliest.mean_time.value == pytest.approx(1500 / (len(times) * by_hand), rel=1e-12)
    for bound in ("low", "high"):  # what is known is the same by both
        assert getattr(unbiased.shape, bound) == pytest.approx(getattr(likeliest.shape, bound), rel=1e-12)


def test_a_trend_is_told_where_there_is_one(tmp_path):
    """The mirror image of failures that come ever later come ever faster; evenly spread ones do neither."""
    late = [1500 - t for t in (5, 40, 43, 175, 389, 712, 747, 795, 1299, 1478)]
    faster = power_laws(lifts(tmp_path, "".join(f"a,{t},\n" for t in sorted(late)) + "a,1500,yes\n"))
    assert faster["unbiased"].trend in (None, "wearing")
    worn = [1500 * (i / 20) ** (1 / 4) for i in range(1, 20)]
    assert (
        power_laws(lifts(tmp_path, "".join(f"a,{t},\n" for t in worn) + "a,1500,yes\n"))["unbiased"].trend == "wearing"
    )
    even = [75 * i for i in range(1, 20)]
    assert power_laws(lifts(tmp_path, "".join(f"a,{t},\n" for t in even) + "a,1500,yes\n"))["unbiased"].trend is None


def test_systems_watched_unequally_have_no_unbiased_estimate(tmp_path):
    text = "a,5,\na,40,\na,90,yes\nb,20,\nb,30,\nb,60,yes\n"
    assert list(power_laws(lifts(tmp_path, text))) == ["maximum likelihood"]
    with pytest.raises(DataError, match=r"lift.csv: 1 failure of repaired systems"):
        power_laws(lifts(tmp_path, "a,5,\na,9,yes\n"))


def test_lives_of_items_that_are_repaired_are_no_lives(tmp_path):
    data = lifts(tmp_path, "a,5,\na,40,\nb,20,\n")
    assert data.items_repeat
    for asked in (fit, fit_all):
        with pytest.raises(DataError, match="items have several rows; expected one life each, or repaired systems"):
            asked(data)
    assert not lifts(tmp_path, "a,5,\nb,40,\n").items_repeat


def test_a_fitted_life_in_a_design(tmp_path):
    """Exponential: n failures in all that was lived."""
    (tmp_path / "robot.yaml").write_text("schema_version: 1\nname: R\ncomponents:\n  pump: {rate: 5 FPMH}  # old\n")
    found = fit(replace(life_data([100.0, 300.0], [400.0]), unit="h", source="lives.csv"), "exponential")
    text = edited_design(found, tmp_path / "robot.yaml", "pump")
    (mode,) = parse(text).modes
    assert mode.rate == pytest.approx(2 / 800, rel=1e-5)
    assert "# old" in text
    assert load(tmp_path / "robot.yaml").modes[0].rate == pytest.approx(5e-6)  # nothing is written
    with pytest.raises(DesignError, match="no part 'pmp'; did you mean 'pump'"):
        edited_design(found, tmp_path / "robot.yaml", "pmp")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "time [h],censored\n100,yes\n200,yes\n",
            r"no failure among 2 parts: .* below 0.00999 /h with 95 %; expected at",
        ),
        (
            "time [h]\n100\n",
            r"1 failure: too few for weibull, which has 2 parameters; .* or an exponential distribution",
        ),
        ("time [h]\n100\n100\n100\n", r"all 3 failures at 100 h: no spread to fit; expected at least two different"),
        ("time [h]\n-5\n7\n", r":2: time: -5 is negative; expected a life, above 0"),
        ("time [h]\n0\n7\n", r":2: time: a life of 0; expected above 0"),
        ("time [h]\nnan\n7\n", r"'nan' is not a number with a unit"),
        ("time\n5 h\n7 km\n", r":3: time: '7 km' is in km, but line 2 is in h; expected one clock for all"),
        ("time\n5\n7 h\n", r":3: time: '7 h' is in h, but line 2 is in no unit"),
        ("time\n5 V\n", r"time: '5 V' is no unit of life; expected h, km, cycles or starts"),
        ("time [V]\n5\n", r"time: 'V' in its heading is no unit of life"),
        ("from [h],to [h]\n9,3\n", r":2: from: from 9 to 3 contradicts itself"),
        ("from [h],to [h]\n,\n", r"holds no lives"),
        ("from [h],to [h],count\n,,3\n", r"has no times; expected a column 'time \[h\]'"),
        ("from [h],to [h]\n0,100\n50,200\n", r"its intervals do not tell a spread"),
        ("time [h],from [h]\n9,3\n", r"states a time and an interval too"),
        ("from [h],to [h],censored\n1,3,yes\n", r"still worked, and failed before 3: contradicts itself"),
        ("time [h],count\n5,0\n", r"all counts are 0"),
        ("time [h],count\n5,1.5\n", r"count: 1.5; expected a whole number"),
    ],
)
def test_refusals(tmp_path, text, said):
    path = tmp_path / "lives.csv"
    path.write_text(text)
    with pytest.raises(DataError, match=said) as error:
        fit_all(read_life_data(path))
    assert "\n" not in str(error.value)


def test_more_refusals():
    lives = life_data([10.0, 20, 30, 40])
    with pytest.raises(
        DataError, match=r"4 failures: too few for weibull3, which has 3 parameters; expected at least 5"
    ):
        fit(lives, "weibull3")
    with pytest.raises(DataError, match=r"no distribution 'weibul'; did you mean 'weibull'"):
        fit(lives, "weibul")
    assert fit(life_data([100.0], [200.0]), "exponential").parameters["rate"].value == pytest.approx(1 / 300)
    with pytest.raises(DataError, match="needs at least 3"):
        fit_power_law({"a": [5.0]}, {"a": 10.0})
    with pytest.raises(DataError, match="expected after 0, by 10"):
        fit_power_law({"a": [5.0, 11.0, 3]}, {"a": 10.0})
    times = np.array([5.0, 6.0])
    with pytest.raises(DataError, match="until when was 'a' watched"):
        systems(LifeData("x", times, times, np.ones(2), "h", items=("a", "b")))
    with pytest.raises(DataError, match="whose failures"):
        systems(lives)
