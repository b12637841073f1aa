"""Repaired systems that were watched until their last failure: a published answer, and intervals that hold."""

import numpy as np
import pytest

from robophm.core.errors import DataError
from robophm.learning.life_data.observed_lives import LifeData
from robophm.learning.life_data.repairable_systems import fit_power_law, power_laws

pytest.importorskip("surpyval")

# A test that ended with its 22nd failure: ReliaWiki, "Crow-AMSAA (NHPP)", first example (MLE β 0.6142, λ 0.4239, and
# by them 45.9 h between failures at its end).
PROTOTYPE = [2.7, 10.3, 12.5, 30.6, 57.0, 61.3, 80.0, 109.5, 125.0, 128.6, 143.8, 167.9, 229.2, 296.7, 320.6, 328.2,
             366.2, 396.7, 421.1, 438.2, 501.2, 620.0]  # fmt: skip


def test_published():
    data = LifeData("d", np.array(PROTOTYPE), np.array(PROTOTYPE), np.ones(22), "h", items=("a",) * 22)
    by = power_laws(data)
    likeliest, unbiased = by["maximum likelihood"], by["unbiased"]
    assert likeliest.at_failure
    assert likeliest.shape.value == pytest.approx(0.6142, abs=5e-5)
    assert likeliest.scale == pytest.approx(0.4239, abs=5e-5)
    assert likeliest.mean_time.value == pytest.approx(45.9, abs=0.05)
    assert unbiased.shape.value == pytest.approx(0.6142 * 20 / 22, abs=5e-5)
    assert unbiased.shape[1:] == pytest.approx(likeliest.shape[1:], rel=1e-12)
    assert unbiased.mean_time[1:] == pytest.approx(likeliest.mean_time[1:], rel=1e-12)


@pytest.mark.full
@pytest.mark.parametrize("n", [4, 12])
def test_by_simulation(n):
    """Power law processes of known β, ended by their n-th failure: Crow's estimate is unbiased, intervals are exact."""
    rng, beta, held, rates, mean, repetitions = np.random.default_rng(7), 1.7, 0, 0, 0.0, 600
    for _ in range(repetitions):
        times = np.cumsum(rng.exponential(size=n)) ** (1 / beta)  # λ = 1
        found = fit_power_law({"a": times.tolist()}, {"a": float(times[-1])})
        mean += found.shape.value / repetitions
        held += found.shape.low < beta < found.shape.high
        rates += found.mean_time.low < 1 / (beta * times[-1] ** (beta - 1)) < found.mean_time.high
    if n == 12:  # of 4 it has no variance by which to compare
        assert mean == pytest.approx(beta, rel=0.05)
    assert held / repetitions == pytest.approx(0.9, abs=0.035)
    assert rates / repetitions == pytest.approx(0.9, abs=0.035)


def test_whose_end_is_not_said():
    items = ("a", "a", "a", "b", "b", "b")
    times = np.array([5.0, 9, 20, 3, 8, 30])
    with pytest.raises(DataError, match="until when was 'a' watched"):
        power_laws(LifeData("d", times, times, np.ones(6), "h", items=items))
    with pytest.raises(DataError, match="of several systems one ends with its failure"):
        fit_power_law({"a": [5.0, 9, 20], "b": [3.0]}, {"a": 20.0, "b": 40.0})
    for more, said in (({"since": np.ones(6)}, "'since'"), ({"modes": ("x",) * 6}, "'mode'")):
        with pytest.raises(DataError, match=f"of repaired systems {said} is not known"):
            power_laws(LifeData("d", times, times, np.ones(6), "h", items=("a",) * 6, **more))
