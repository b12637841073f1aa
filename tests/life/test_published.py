"""Figures that others have printed."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from robophm.life.extreme_value import ExtremeValue
from robophm.life.loglogistic import Loglogistic
from robophm.life.lognormal import Lognormal
from robophm.life.normal import Normal
from robophm.life.weibull import Weibull

NAME = "reliability_distributions.json"
CASES = json.loads((Path(__file__).parents[1] / "data" / NAME).read_text(encoding="utf-8"))["cases"]

# The peer's names of the parameters, in the order in which it writes them.
OURS = {
    "Gumbel_Distribution": (ExtremeValue, {"mu": "location", "sigma": "scale"}),
    "Loglogistic_Distribution": (Loglogistic, {"alpha": "scale", "beta": "shape", "gamma": "location"}),
    "Lognormal_Distribution": (Lognormal, {"mu": "log_mean", "sigma": "log_deviation", "gamma": "location"}),
    "Normal_Distribution": (Normal, {"mu": "centre", "sigma": "deviation"}),
}
QUANTILES = (0.001, 0.01, 0.1, 0.9, 0.99, 0.999)
FIGURES = {
    "mean": lambda life, ages: life.mean(),
    "standard_deviation": lambda life, ages: life.standard_deviation(),
    "quantile(0.2)": lambda life, ages: life.quantile(0.2),
    "inverse_SF(q=0.7)": lambda life, ages: life.age_at(-math.log(0.7)),
    "mean_residual_life(10)": lambda life, ages: life.mean_residual_life(10),
    "mean_residual_life(20)": lambda life, ages: life.mean_residual_life(20),
    "PDF": lambda life, ages: life.density(ages),
    "CDF": lambda life, ages: life.failure_probability(ages),
    "SF": lambda life, ages: life.survival(ages),
    "HF": lambda life, ages: life.hazard(ages),
    "CHF": lambda life, ages: life.cumulative_hazard(ages),
}


@pytest.mark.parametrize(
    ("case", "figure"),
    [pytest.param(case, figure, id=f"{case['name']}-{figure}") for case in CASES for figure in case["expected"]],
)
def test_the_package_reliability(case, figure):
    distribution, names = OURS[case["system"]["distribution"]]
    given = dict(item.strip().split("=") for item in case["system"]["params"].split(","))
    life = distribution(**{names[key]: float(value) for key, value in given.items()})
    first = {"dist.gamma - 1": getattr(life, "location", 0.0) - 1, "0": 0.0}
    ages = [
        first[item] if item in first else float(life.quantile(float(item[len("dist.quantile(") : -1])))
        for item in case["system"]["xvals"].strip("[]").split(", ")
    ]
    value = np.asarray(FIGURES[figure](life, np.array(ages)))
    expected = np.asarray(case["expected"][figure])
    tolerance = case["tolerance"].get(figure, case["tolerance"]["*"])
    assert value.shape == expected.shape
    assert np.all(np.abs(value - expected) <= tolerance["rel"] * np.abs(expected))
    assert np.all(np.abs(value - expected) <= tolerance["abs"])


def test_the_copy_is_the_shared_file(shared: Path):
    assert json.loads((shared / "cases" / NAME).read_text(encoding="utf-8"))["cases"] == CASES


def test_weibull_of_the_repyability_documentation():
    life = Weibull(scale=100, shape=2)
    assert life.quantile(0.1) == pytest.approx(32.46, abs=0.0050005)
    assert life.mean() == pytest.approx(88.62, abs=0.0050005)
    assert life.mean_residual_life(40) == pytest.approx(59.45, abs=0.0050005)
    assert math.exp(-life.increment(50, 10)) == pytest.approx(0.8958, abs=5.0005e-05)
    assert life.survival(60) == pytest.approx(0.6977, abs=5.0005e-05)


def test_the_papers_misprints_are_not_there():
    # Equations 20–22 print 1/α for t/α, exp twice and exp in the hazard.
    life, t = Weibull(scale=100, shape=2), 30.0
    assert life.density(t) == pytest.approx(2 / 100 * 0.3 * math.exp(-0.09), rel=1e-14)
    assert life.failure_probability(t) == pytest.approx(1 - math.exp(-0.09), rel=1e-14)
    assert life.hazard(t) == pytest.approx(2 / 100 * 0.3, rel=1e-14)
    # Equation 24: lives begin at t ≥ 0. Equation 26: R is P(T > t).
    assert life.survival(-1.0) == 1
    assert life.hazard(-1.0) == 0
    assert life.survival(1e9) == 0
