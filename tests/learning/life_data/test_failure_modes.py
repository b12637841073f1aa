"""Failure modes and parts of which some never fail: closed forms, draws of whichever is first, SciPy's search."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.stats import lognorm, weibull_min

from robophm.core.errors import DataError
from robophm.design.file import load
from robophm.learning.life_data.distribution_fitting import FAR, UNKNOWN, fit
from robophm.learning.life_data.failure_modes import edited_modes, fit_modes
from robophm.learning.life_data.fit_in_design import design_keys
from robophm.learning.life_data.limited_failures import fit_limited
from robophm.learning.life_data.observed_lives import LifeData, life_data, read_life_data

pytest.importorskip("surpyval")

# Integrated circuits of which 28 of 4156 failed in 1370 h (Meeker, Technometrics 29, 1987, table 1).
CIRCUITS = [0.1, 0.1, 0.15, 0.6, 0.8, 0.8, 1.2, 2.5, 3, 4, 4, 6, 10, 10, 12.5, 20, 20, 43, 43, 48, 48, 54, 74, 84, 94,
            168, 263, 593]  # fmt: skip


def circuits():
    low, high = np.array([*CIRCUITS, 1370.0]), np.array([*CIRCUITS, math.inf])
    return LifeData("circuits", low, high, np.array([1.0] * 28 + [4128.0]), "h")


def of_modes(low, high, modes, since=()):
    return LifeData("d", np.array(low, float), np.array(high, float), np.ones(len(low)), "h",
                    since=np.array(since, float), modes=tuple(modes))  # fmt: skip


def test_constant_rates():
    """Each mode's rate is its failures over all times; together their sum, and each is first in its share."""
    low, modes = [100, 250, 400, 60, 700, 500], ["a", "b", "a", "a", "b", ""]
    found = fit_modes(of_modes(low, [*low[:5], math.inf], modes), "exponential")
    assert list(found.modes) == ["a", "b"]
    for name, failures in (("a", 3), ("b", 2)):
        assert found.modes[name].parameters["rate"].value == pytest.approx(failures / 2010, rel=1e-4)
        assert found.shares[name] == pytest.approx(failures / 5, rel=1e-4)
    assert found.mean == pytest.approx(2010 / 5, rel=1e-4)
    assert found.quantiles[0.5] == pytest.approx(math.log(2) * 2010 / 5, rel=1e-4)
    assert found.survival(np.array([300.0])) == pytest.approx(math.exp(-300 * 5 / 2010), rel=1e-4)


@pytest.mark.full
def test_modes_of_robots_that_really_fail():
    """Whichever of two is first, some censored, some not watched from new: the truths are in the intervals, and draws
    of the fitted modes have the part's mean, quantiles and shares.
    """
    rng = np.random.default_rng(4)
    wear, shock = weibull_min(3.0, scale=1000), lognorm(1.0, scale=1500)
    a, b = wear.rvs(500, random_state=rng), shock.rvs(500, random_state=rng)
    age, mode = np.minimum(a, b), np.where(a < b, "wear", "shock")
    since, end = np.where(rng.random(500) < 0.3, rng.uniform(0, 500, 500), 0.0), rng.uniform(500, 2000, 500)
    kept = (age > since) & (end > since)
    age, mode, since, end = age[kept], mode[kept], since[kept], end[kept]
    failed = age < end
    low = np.minimum(age, end)
    data = of_modes(low, np.where(failed, low, np.inf), np.where(failed, mode, ""), since)
    found = fit_modes(data, "weibull", level=0.99)
    shape, scale = (found.modes["wear"].parameters[name] for name in ("shape", "scale"))
    assert shape.low < 3.0 < shape.high
    assert scale.low < 1000 < scale.high
    best = fit_modes(data)
    assert best.modes["shock"].name == "lognormal"
    draws = {name: np.asarray(one.life.quantile(rng.random(200_000))) for name, one in best.modes.items()}
    first = np.minimum(draws["wear"], draws["shock"])
    assert best.mean == pytest.approx(first.mean(), rel=0.01)
    assert best.quantiles[0.1] == pytest.approx(np.quantile(first, 0.1), rel=0.01)
    assert best.shares["wear"] == pytest.approx(np.mean(draws["wear"] < draws["shock"]), abs=0.005)
    assert sum(best.shares.values()) == pytest.approx(1.0, abs=1e-4)


def test_intervals_and_single_failures():
    """Of a failure within an interval the other mode worked until it began; one failure gives a constant rate."""
    data = of_modes([50, 0, 30, 80, 90], [60, 20, 30, 80, math.inf], ["a", "b", "a", "a", ""])
    found = fit_modes(data)
    b = found.modes["b"]
    assert b.name == "exponential"
    assert b.data.low.tolist() == [50, 0, 30, 80, 90]
    assert b.data.high.tolist() == [math.inf, 20, math.inf, math.inf, math.inf]
    assert found.modes["a"].data.low.tolist() == [50, 30, 80, 90]  # nothing was seen of it before 20
    assert any("one failure tells no shape" in note for note in found.notes)
    assert any("until the interval began" in note for note in found.notes)
    with pytest.raises(DataError, match=r"d \(b\): 1 failure: too few for weibull"):
        fit_modes(data, "weibull")


def test_into_a_design_and_from_a_table(tmp_path):
    (tmp_path / "lives.csv").write_text(
        "time [h],cause,event\n10,wear,1\n20,wear,1\n30,surge,1\n35,surge,1\n40,none,0\n"
    )
    (tmp_path / "robot.yaml").write_text(
        "schema_version: 1\nname: R\ncomponents:\n  arm:\n    failure_modes:\n"
        "      wear: {rate: 5 FPMH}  # guess\n      surge: {rate: 1 FPMH}\n"
    )
    found = fit_modes(read_life_data(tmp_path / "lives.csv"), "exponential")
    text = edited_modes(found, tmp_path / "robot.yaml", "arm")
    assert "# guess" in text
    (tmp_path / "new.yaml").write_text(text)
    assert [mode.rate for mode in load(tmp_path / "new.yaml").modes] == pytest.approx([2 / 135, 2 / 135], rel=1e-4)
    (tmp_path / "lives.csv").write_text("time [h],mode\n10,wera\n20,wera\n")
    with pytest.raises(DataError, match="'arm' has no failure mode 'wera'; did you mean 'arm/wear'"):
        edited_modes(fit_modes(read_life_data(tmp_path / "lives.csv"), "weibull"), tmp_path / "robot.yaml", "arm")


def test_circuits_of_which_few_ever_fail():
    """Against the likelihood written down and searched by SciPy: two thirds of a percent ever fail (Meeker 1987)."""
    found = fit_limited(circuits())

    def miss(x):
        share, life = 1 / (1 + math.exp(-x[2])), weibull_min(math.exp(x[1]), scale=math.exp(x[0]))
        return -(np.sum(np.log(share) + life.logpdf(CIRCUITS)) + 4128 * math.log1p(-share * life.cdf(1370)))

    best = minimize(
        miss, [3.0, -0.5, -5.0], method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-11, "maxiter": 9999}
    )
    assert found.share.value == pytest.approx(1 / (1 + math.exp(-best.x[2])), rel=1e-3)
    assert found.share.value == pytest.approx(0.0067, abs=5e-5)
    assert found.parameters["scale"].value == pytest.approx(math.exp(best.x[0]), rel=1e-3)
    assert found.parameters["shape"].value == pytest.approx(math.exp(best.x[1]), rel=1e-3)
    assert found.log_likelihood == pytest.approx(-best.fun, abs=1e-5)
    assert found.shown
    assert found.share.low < 0.0067 < found.share.high < 0.01
    assert found.quantiles[0.01] == math.inf
    eta, beta = found.parameters["scale"].value, found.parameters["shape"].value
    assert found.quantiles[0.001] == pytest.approx(eta * (-math.log1p(-0.001 / found.share.value)) ** (1 / beta))


@pytest.mark.full
def test_where_all_fail_it_is_not_shown():
    rng = np.random.default_rng(3)
    shown = 0
    for _ in range(6):
        ages = 1000 * rng.weibull(2.0, 60)
        shown += fit_limited(life_data(ages[ages < 1100], np.full(np.sum(ages >= 1100), 1100.0))).shown
    assert shown <= 2
    with pytest.raises(DataError, match="all 3 parts failed; expected some that still worked"):
        fit_limited(life_data([1.0, 2, 3]))
    with pytest.raises(DataError, match="a normal life with parts that never fail is not known"):
        fit_limited(circuits(), "normal")
    with pytest.raises(DataError, match="2 failures: too few for 3 parameters"):
        fit_limited(life_data([1.0, 2], [3.0]))


def test_a_figure_far_outside_the_data_is_no_finding():
    """A mean of 10¹⁶ h from 1370 h of test: said, and not put into a design."""
    found = fit(circuits())
    assert found.mean > 1e15
    assert found.known_until == UNKNOWN * 1370
    assert any("of which these data tell nothing; a fit with parts that never fail" in note for note in found.notes)
    with pytest.raises(DataError, match="whose mean would lie beyond 137000 h, 100 times the longest time seen"):
        design_keys(found)
    some = fit(life_data([20.0, 60, 80], [100.0] * 97))
    assert FAR * 100 < some.mean < UNKNOWN * 100
    assert any("it rests on the shape of the distribution alone" in note for note in some.notes)
    assert "rate" in design_keys(some)
    constant = fit(life_data([20.0, 60], [100.0] * 1000), "exponential")  # known by all times together
    assert constant.notes == ()
    assert design_keys(constant)["rate"] == f"{2 / 100_080:.6g} /h"
