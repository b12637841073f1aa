"""Scores of remaining lives: closed forms, scipy, and what they accept and reject."""

import numpy as np
import pytest
from scipy.special import erfinv
from scipy.stats import beta, binom, kstest, norm, weibull_min

from robophm.calibration.lives import INTERVALS, crps, score_lives
from robophm.calibration.predictions import LEVELS, Lives
from robophm.calibration.tasks import LEVEL
from robophm.calibration.verdict import judge_lives

LEVEL_ARRAY = np.array(LEVELS)


def exponential_quantiles(mean):
    return -np.log1p(-LEVEL_ARRAY) * np.asarray(mean)[..., None]


def lives(true, *, predicted=None, censored_at=None):
    """Lives of exponential means ``true``, one of each robot, predicted as exponential of means ``predicted``."""
    rng = np.random.default_rng(11)
    true = np.asarray(true, dtype=float)
    predicted = true if predicted is None else np.asarray(predicted, dtype=float)
    life = rng.exponential(true)
    end = np.full(true.size, np.inf) if censored_at is None else censored_at
    observed = np.minimum(life, end)
    return Lives(np.arange(true.size), np.zeros(true.size), exponential_quantiles(predicted),
                 -np.expm1(-observed / predicted), observed, life > end)  # fmt: skip


def means(n):
    return np.random.default_rng(12).uniform(20, 500, n)


def test_crps_of_an_exponential_is_exact():
    """Closed form: y + 2 μ exp(−y/μ) − 3 μ / 2 (Jordan, Krüger, Lerch 2019, J. Stat. Softw. 90(12), appendix A)."""
    mean = 37.0
    y = np.array([0.0, 0.3, 5.0, 37.0, 100.0, 1000.0])
    expected = y + 2 * mean * np.exp(-y / mean) - 1.5 * mean
    assert crps(np.tile(exponential_quantiles(mean), (y.size, 1)), y) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("deviation", "off"), [(3, 0.015), (10, 0.003), (20, 0.002)])
def test_crps_of_a_normal_is_near_its_closed_form(deviation, off):
    """σ (z (2Φ(z) − 1) + 2φ(z) − 1/√π) (Gneiting, Raftery 2007, J. Am. Stat. Assoc. 102, 359, §4.2).

    Nine quantiles do not say all of a distribution; the mean, which is what is reported, is the nearest.
    """
    z = norm.ppf((np.arange(2000) + 0.5) / 2000)
    expected = deviation * (z * (2 * norm.cdf(z) - 1) + 2 * norm.pdf(z) - np.pi**-0.5)
    quantiles = 100 + deviation * 2**0.5 * erfinv(2 * LEVEL_ARRAY - 1)
    found = crps(np.tile(quantiles, (z.size, 1)), 100 + deviation * z)
    assert found == pytest.approx(expected, abs=0.1 * deviation)
    assert found.mean() == pytest.approx(expected.mean(), rel=off)


def test_crps_is_the_integral_that_it_says():
    """Against ∫ (F − [x ≥ y])² dx on a fine grid, F as documented; repeated quantiles are a jump of F."""
    quantiles = np.array([1.0, 2, 2, 3, 7, 7, 9, 12, 15])
    x = np.linspace(0, 400, 4_000_001)
    hazard = np.interp(x, [0, *quantiles], -np.log1p(-np.array([0, *LEVELS])))
    slope = np.log(0.05 / 0.025) / 3
    hazard = np.where(x > 15, -np.log(0.025) + (x - 15) * slope, hazard)
    F = -np.expm1(-hazard)
    for y in (0.0, 0.5, 2.0, 6.0, 7.0, 14.0, 40.0):
        expected = np.trapezoid((F - (x >= y)) ** 2, x)
        assert crps(quantiles[None], np.array([y]))[0] == pytest.approx(expected, abs=2e-4)


def test_a_point_prediction_scores_its_error():
    assert crps(np.full((3, 9), 10.0), np.array([4.0, 10.0, 13.0])) == pytest.approx(
        # all but the line from 0 to the first quantile, which holds 2.5 %
        [6, 0, 3], abs=0.05 * 10
    )  # fmt: skip


def test_coverage_is_clopper_pearson():
    score = score_lives(lives(means(400)))
    for one, level in zip(score.coverage, INTERVALS, strict=True):
        k = round(one.share * 400)
        tail = LEVEL / 3 / 2
        assert one.level == level
        assert one.low == pytest.approx(beta.ppf(tail, k, 400 - k + 1), rel=1e-9)
        assert one.high == pytest.approx(beta.ppf(1 - tail, k + 1, 400 - k), rel=1e-9)
        assert one.low < level < one.high


def test_coverage_of_all_and_of_none():
    inside = Lives(np.arange(50), np.zeros(50), np.tile(exponential_quantiles(10.0), (50, 1)),
                   np.full(50, 0.5), np.full(50, 10 * np.log(2)), np.zeros(50, bool))  # fmt: skip
    assert [(c.share, c.high) for c in score_lives(inside).coverage] == [(1, 1)] * 3
    outside = Lives(
        np.arange(50), np.zeros(50), inside.quantiles, np.full(50, 0.999), np.full(50, 69.0), inside.censored
    )
    assert [(c.share, c.low) for c in score_lives(outside).coverage] == [(0, 0)] * 3


def test_histogram_and_shape():
    predicted = lives(means(1000), predicted=1.08 * means(1000))
    score = score_lives(predicted)
    edges = np.linspace(0, 1, 11)
    assert score.histogram == tuple(np.histogram(predicted.fraction, edges)[0])
    assert score.p_shape == pytest.approx(kstest(predicted.fraction, "uniform").pvalue, rel=1e-9)
    assert score.mean == pytest.approx(predicted.fraction.mean())
    worst = 2 * 10 * min(min(binom.cdf(k, 1000, 0.1), binom.sf(k - 1, 1000, 0.1)) for k in score.histogram)
    assert score.p_worst_bin == pytest.approx(min(1, worst))
    assert score.p_value == pytest.approx(min(1, 2 * min(score.p_shape, score.p_worst_bin)))
    low, high = score.band
    assert binom.cdf(low - 1, 1000, 0.1) <= LEVEL / 20 < binom.cdf(low, 1000, 0.1)
    assert binom.sf(high, 1000, 0.1) <= LEVEL / 20 < binom.sf(high - 1, 1000, 0.1)


def test_the_band_holds_the_histograms_of_honest_models_with_99_percent():
    runs = 20_000
    low, high = score_lives(lives(means(500))).band
    bars = np.random.default_rng(13).multinomial(500, [0.1] * 10, runs)
    missed = int(np.any((bars < low) | (bars > high), axis=1).sum())
    assert 40 < missed <= 200 + 4 * 200**0.5


@pytest.mark.full
def test_an_honest_model_is_seldom_rejected_censored_or_not():
    rng = np.random.default_rng(14)
    rejected = 0
    for _ in range(300):
        life, end = rng.exponential(100, 200), rng.exponential(150, 200)
        observed = np.minimum(life, end)
        one = Lives(np.arange(200), np.zeros(200), np.tile(exponential_quantiles(100.0), (200, 1)),
                    -np.expm1(-observed / 100), observed, life > end)  # fmt: skip
        rejected += score_lives(one).p_value < LEVEL
    assert rejected <= 3 + 4 * 3**0.5


def test_an_honest_model_is_accepted():
    score = score_lives(lives(means(800)))
    assert score.p_value > 0.05
    assert judge_lives(score).finding == "calibrated"
    assert (score.lives, score.censored, score.prognosis) == (800, 0, None)


@pytest.mark.parametrize(("factor", "says"), [(2, "shorter than it said"), (0.5, "longer than it said")])
def test_a_model_off_by_two_is_caught(factor, says):
    true = means(400)
    score = score_lives(lives(true, predicted=factor * true))
    assert score.p_value < 1e-6
    assert says in str(judge_lives(score))


@pytest.mark.parametrize(("shape", "says"), [(4, "too narrow"), (1, "too wide")])
def test_intervals_of_the_wrong_width_are_caught(shape, says):
    """Lives of Weibull shape 2, predicted with the same median and another shape."""
    life = weibull_min.rvs(2, size=800, random_state=15) * 100 / np.log(2) ** 0.5
    scale = 100 / np.log(2) ** (1 / shape)
    quantiles = weibull_min.ppf(LEVEL_ARRAY, shape, scale=scale)
    one = Lives(np.arange(800), np.zeros(800), np.tile(quantiles, (800, 1)), weibull_min.cdf(life, shape, scale=scale),
                life, np.zeros(800, bool))  # fmt: skip
    score = score_lives(one)
    assert score.p_value < 1e-6
    assert says in str(judge_lives(score))


def test_censored_lives_do_not_look_short():
    """Half the robots still work: an honest model stays accepted, one off by two is still caught."""
    true = means(1200)
    end = np.random.default_rng(16).exponential(true * 1.2)
    honest = score_lives(lives(true, censored_at=end))
    assert 0.4 < honest.censored / honest.lives < 0.5
    assert judge_lives(honest).finding == "calibrated"
    assert score_lives(lives(true, predicted=2 * true, censored_at=end)).p_value < 1e-6


def test_too_many_censored_are_refused_in_words():
    true = means(600)
    score = score_lives(lives(true, censored_at=true * 0.2))
    verdict = judge_lives(score)
    assert score.censored > 450
    assert verdict.finding == "too little data"
    assert "still going on" in verdict.text


def test_of_predictions_that_wait_for_one_failure_the_first_counts():
    """Two lives of one robot, the second begun by a repair, each predicted three times; another robot's once."""
    time = np.array([0.0, 10, 20, 30, 40, 50, 5])
    observed = np.array([30.0, 20, 10, 25, 15, 5, 100])
    fraction = np.linspace(0.1, 0.7, 7)
    rows = np.array([4, 1, 6, 0, 3, 2, 5])
    # quantiles are made up: only windows matter here
    one = Lives(np.array([0] * 6 + [1])[rows], time[rows], np.tile(exponential_quantiles(30.0), (7, 1)),
                fraction[rows], observed[rows], np.zeros(7, bool))  # fmt: skip
    score = score_lives(one)
    assert (score.predictions, score.lives) == (7, 3)
    assert score.mean == pytest.approx((0.1 + 0.4 + 0.7) / 3)
    assert score.prognosis is not None
    assert score.prognosis.lives == 2


def test_what_was_called_impossible_and_happened():
    one = lives(means(50))
    fraction = one.fraction.copy()
    fraction[7] = 0
    score = score_lives(Lives(one.robot, one.time, one.quantiles, fraction, one.observed, one.censored))
    assert (score.impossible, score.p_value) == (1, 0)
    assert "impossible happened" in str(judge_lives(score))


@pytest.mark.parametrize(("fraction", "censored", "impossible"), [(0, 0, 1), (0, 1, 0), (1, 0, 0), (1, 1, 1)])
def test_what_is_impossible(fraction, censored, impossible):
    """To have ended where no life is so short, or to go on where every life is shorter."""
    one = lives([100.0])
    fraction, censored = np.array([float(fraction)]), np.array([bool(censored)])
    assert (
        score_lives(Lives(one.robot, one.time, one.quantiles, fraction, one.observed, censored)).impossible
        == impossible
    )


@pytest.mark.full
def test_what_would_have_been_seen_is_seen():
    n = 300
    factor = score_lives(lives(np.full(n, 100.0))).seen
    rng = np.random.default_rng(17)
    seen = 0
    for _ in range(200):
        life = rng.exponential(100, n)
        predicted = 100 * factor  # the true hazard is that factor higher
        one = Lives(np.arange(n), np.zeros(n), np.tile(exponential_quantiles(predicted), (n, 1)),
                    -np.expm1(-life / predicted), life, np.zeros(n, bool))  # fmt: skip
        seen += score_lives(one).p_shape < LEVEL / 2
    assert seen / 200 >= 0.85


def test_a_single_life_is_too_little():
    score = score_lives(lives([100.0]))
    assert score.lives == 1
    assert judge_lives(score).finding == "too little data"
    assert np.isnan(score_lives(lives([100.0], censored_at=np.array([1.0]))).crps)


def test_a_life_that_ends_as_it_is_predicted_has_no_prognosis():
    """1e-12 h before the end of 1e6 h: the two moments are one."""
    time, observed = np.array([0.0, 1e6]), np.array([1e6, 1e-12])
    predicted = Lives(np.zeros(2, dtype=int), time, exponential_quantiles(np.full(2, 1e6)),
                      -np.expm1(-observed / 1e6), observed, np.zeros(2, dtype=bool))  # fmt: skip
    assert score_lives(predicted).prognosis is None
