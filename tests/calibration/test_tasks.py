"""Scores of probabilities: hand-worked, identities, and what they accept and reject."""

from dataclasses import replace

import numpy as np
import pytest

from robophm.calibration.predictions import Tasks
from robophm.calibration.tasks import LEVEL, MOST_BINS, likelihood_ratio_p_value, score_tasks
from robophm.calibration.verdict import judge_tasks
from robophm.core.errors import ModelError


def tasks(failure, failed):
    failure = np.asarray(failure, dtype=float)
    return Tasks(failure, 1 - failure, np.asarray(failed, dtype=bool))


def risks(rng, n):
    """Probabilities of failure as a fleet has them: from one in a thousand to one in two, one in twenty on average."""
    return np.minimum(0.5, np.exp(rng.normal(-3.3, 0.8, n)))


def test_brier_by_hand():
    """Ten forecasts of 0.1 with 1 event, five of 0.4 with 3, five of 0.8 with 4; the terms are those of Murphy (1973).

    Score: (9·0.01 + 0.81 + 2·0.16 + 3·0.36 + 0.04·4 + 0.64)/20. Reliability: (5·0.2² + 0)/20 as the observed
    frequencies are 0.1, 0.6, 0.8. Base rate 8/20. Resolution: (10·0.3² + 5·0.2² + 5·0.4²)/20. Uncertainty 0.4·0.6.
    """
    failure = [0.1] * 10 + [0.4] * 5 + [0.8] * 5
    failed = [1] + [0] * 9 + [1, 1, 1, 0, 0] + [1, 1, 1, 1, 0]
    # so few fall into one bin; a hundred times as many keep all shares
    brier = score_tasks(tasks(failure * 100, failed * 100)).brier
    assert brier.score == pytest.approx(3.1 / 20)
    assert brier.reliability == pytest.approx(0.2 / 20)
    assert brier.resolution == pytest.approx(1.9 / 20)
    assert brier.uncertainty == pytest.approx(0.24)
    assert brier.within_bins == pytest.approx(0, abs=1e-15)


@pytest.mark.parametrize("n", [1, 5, 60, 3000])
def test_the_parts_of_the_brier_score_add_up(n):
    rng = np.random.default_rng(n)
    p = risks(rng, n)
    failed = rng.random(n) < 2 * p
    b = score_tasks(tasks(p, failed)).brier
    assert b.score == pytest.approx(np.where(failed, (1 - p) ** 2, p**2).sum() / n, rel=1e-12)
    assert b.reliability - b.resolution + b.uncertainty + b.within_bins == pytest.approx(b.score, rel=1e-12)


def test_logarithmic_score_keeps_both_tails():
    score = score_tasks(Tasks(np.array([1e-30, 1.0]), np.array([1.0, 1e-30]), np.array([True, False])))
    assert score.logarithmic_score == pytest.approx(30 * np.log(10), rel=1e-12)
    sure = score_tasks(Tasks(np.array([1e-20]), np.array([1.0]), np.array([False])))
    assert sure.logarithmic_score == pytest.approx(1e-20, rel=1e-12)


def test_bins_hold_equal_expected_failures_and_share_no_prediction():
    rng = np.random.default_rng(1)
    p = np.round(risks(rng, 8000), 3)
    score = score_tasks(tasks(p, rng.random(8000) < p))
    assert len(score.bins) == MOST_BINS
    assert sum(one.tasks for one in score.bins) == 8000
    assert [one.expected for one in score.bins] == pytest.approx([p.sum() / 10] * 10, rel=0.1)
    assert all(a.highest < b.lowest for a, b in zip(score.bins, score.bins[1:], strict=False))
    assert score.expected == pytest.approx(p.sum())


def test_a_bin_is_outside_where_its_own_band_is_left():
    p = np.full(200, 0.1)
    for failed in range(0, 60, 5):
        (one,) = score_tasks(tasks(p, np.arange(200) < failed)).bins
        assert one.failed == failed
        assert one.outside == (failed < one.band[0] or failed > one.band[1]) == (one.p_value < 0.01)


def test_bins_do_not_depend_on_the_order_of_rows():
    rng = np.random.default_rng(2)
    p = np.round(risks(rng, 2000), 3)
    failed = rng.random(2000) < p
    order = rng.permutation(2000)
    one, other = score_tasks(tasks(p, failed)), score_tasks(tasks(p[order], failed[order]))
    assert [(b.failed, b.tasks) for b in one.bins] == [(b.failed, b.tasks) for b in other.bins]
    assert one.p_value == pytest.approx(other.p_value, rel=1e-9)


def test_bands_hold_all_bins_of_an_honest_model_with_99_percent():
    rng = np.random.default_rng(3)
    p = risks(rng, 2000)
    bins = score_tasks(tasks(p, np.zeros(2000))).bins
    members = [(p >= one.lowest) & (p <= one.highest) for one in bins]
    runs = 4000
    failed = rng.random((runs, 2000)) < p
    inside = np.ones(runs, dtype=bool)
    for one, group in zip(bins, members, strict=True):
        counts = failed[:, group].sum(axis=1)
        inside &= (counts >= one.band[0]) & (counts <= one.band[1])
    missed = runs - int(inside.sum())
    # At most 1 %, within four standard errors; and not idle: discreteness costs no more than two thirds of it.
    assert missed <= 40 + 4 * 40**0.5
    assert missed >= 40 / 3 - 4 * (40 / 3) ** 0.5
    assert missed > 0


def test_an_honest_model_is_seldom_rejected():
    rng = np.random.default_rng(4)
    p = risks(rng, 1500)
    rejected = sum(score_tasks(tasks(p, rng.random(1500) < p)).p_value < LEVEL for _ in range(400))
    assert rejected <= 4 + 4 * 2


@pytest.fixture(scope="module")
def history():
    """8,000 tasks of which some 400 fail."""
    rng = np.random.default_rng(5)
    p = risks(rng, 8000)
    return p, rng.random(8000) < p


def test_an_honest_model_is_accepted(history):
    score = score_tasks(tasks(*history))
    assert score.p_value > 0.05
    assert judge_tasks(score).finding == "calibrated"
    assert 0.9 < score.ratio < 1.1


def mean_right_bins_wrong(p):
    """All risks drawn towards their mean: right in the large, too high for the safe, too low for the risky."""
    return p.mean() + (p - p.mean()) * 0.2


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda p: p / 2, "promised too much"),
        (lambda p: np.minimum(0.999, 2 * p), "promised too little"),
        (lambda p: 1 - (1 - p) ** 2.5, "promised too little"),  # R^d, d = 2.5 in one unit of distance
        (lambda p: 1 - (1 - p) ** 0.25, "promised too much"),  # R^d, d = 0.25 in another
        (lambda p: 1 - (1 - p) ** 250, "called impossible happened"),  # R^d, d = 250: some R^d are 0 to the last digit
        (lambda p: np.random.default_rng(6).permutation(p), "do not fit the tasks"),
        (mean_right_bins_wrong, "do not fit the tasks"),
    ],
    ids=["half", "double", "R^2.5", "R^0.25", "R^250", "shuffled", "drawn to the mean"],
)
def test_a_wrong_model_is_caught(history, wrong, says):
    p, failed = history
    score = score_tasks(tasks(wrong(p), failed))
    assert score.p_value < 1e-6
    verdict = judge_tasks(score)
    assert verdict.finding == "not calibrated"
    assert says in verdict.text


def test_what_was_called_impossible_and_happened():
    score = score_tasks(tasks([0.0, 0.1, 0.2] * 100, ([1] + [0] * 2) + [0, 0, 1] * 99))
    assert (score.impossible, score.p_value) == (1, 0)
    assert score.logarithmic_score == np.inf
    assert "impossible happened; 100 of 300 tasks failed" in str(judge_tasks(score))
    certain = score_tasks(tasks([1.0, 1.0], [0, 1]))
    assert (certain.impossible, certain.p_value) == (1, 0)
    kept = score_tasks(tasks([0.0, 1.0], [0, 1]))
    assert (kept.impossible, kept.p_value) == (0, 1)


def test_a_constant_probability_is_honest_but_no_help():
    rng = np.random.default_rng(7)
    verdict = judge_tasks(score_tasks(tasks(np.full(8000, 0.05), rng.random(8000) < 0.05)))
    assert verdict.finding == "calibrated"
    assert "no help in telling them apart" in verdict.text


def test_too_little_data_says_what_would_have_been_seen():
    score = score_tasks(tasks(np.full(100, 0.05), [1] * 6 + [0] * 94))
    verdict = judge_tasks(score)
    assert verdict.finding == "too little data"
    assert "6 of 100 tasks failed where 5 were expected" in verdict.text
    assert "of too few none" in verdict.text


@pytest.mark.full
@pytest.mark.parametrize("side", [0, 1])
def test_what_would_have_been_seen_is_seen(side):
    """At the stated factor nine of ten histories are rejected: simulated, for a rare failure."""
    p = np.full(5000, 0.02)
    count = score_tasks(tasks(p, np.zeros(5000)))
    factor = count.seen[side]
    assert (factor - 1) * (-1, 1)[side] > 0
    rng = np.random.default_rng(8)
    seen = 0
    for failures in rng.binomial(5000, 0.02 * factor, 300):
        failed = np.arange(5000) < failures
        seen += score_tasks(tasks(p, failed)).p_total < LEVEL / 3
    assert 0.85 < seen / 300 < 0.96


def test_a_verdict_names_the_p_value_that_is_known():
    score = score_tasks(tasks(np.full(3000, 1e-6), np.ones(3000)))
    assert str(judge_tasks(score)).startswith("Not calibrated (p < 1e-279): it promised too much: 3,000 of 3,000")


def test_a_single_task():
    score = score_tasks(tasks([0.3], [True]))
    assert (score.tasks, score.failed, len(score.bins)) == (1, 1, 1)
    assert score.p_value == pytest.approx(1)  # thrice 2 · 0.3
    assert judge_tasks(score).finding == "too little data"
    assert replace(score, expected=0.0).ratio == np.inf


# One model beside another


def test_a_right_model_is_found_out_as_rarely_as_said():
    """Against any alternative p-values are uniform: of 2,000 draws 5 % lie below 0.05, and 1 % below 0.01."""
    rng = np.random.default_rng(8)
    p = risks(rng, 2000)
    other = np.clip(p * np.exp(rng.normal(0, 0.5, p.size)), 0, 0.9)
    values = []
    for _ in range(2000):
        failed = rng.random(p.size) < p
        values.append(likelihood_ratio_p_value(tasks(p, failed), tasks(other, failed)))
    assert np.mean(np.array(values) < 0.05) == pytest.approx(0.05, abs=0.02)
    assert np.mean(np.array(values) < 0.01) == pytest.approx(0.01, abs=0.008)


def test_no_test_finds_more():
    """Brute force: of five tasks, the outcomes of least p-value are those of the lemma of Neyman and Pearson."""
    p, other = np.array([0.1, 0.3, 0.05, 0.5, 0.2]), np.array([0.2, 0.25, 0.3, 0.6, 0.2])
    outcomes = [np.array([n >> i & 1 for i in range(5)], dtype=bool) for n in range(32)]

    def likelihood(model, failed):
        return np.prod(np.where(failed, model, 1 - model))

    ratios = [likelihood(other, failed) / likelihood(p, failed) for failed in outcomes]
    values = [likelihood_ratio_p_value(tasks(p, failed), tasks(other, failed)) for failed in outcomes]
    order = np.argsort(ratios)
    assert np.all(np.diff(np.array(values)[order]) <= 1e-12)


def test_it_is_found_out_far_sooner_than_by_its_own_score():
    """A model that is wrong about one robot in ten alone."""
    rng = np.random.default_rng(3)
    truth = risks(rng, 20_000)
    model = np.where(rng.random(truth.size) < 0.1, truth / 2, truth)
    failed = rng.random(truth.size) < truth
    assert (
        likelihood_ratio_p_value(tasks(model, failed), tasks(truth, failed))
        < 1e-6
        < score_tasks(tasks(model, failed)).p_value
    )
    assert likelihood_ratio_p_value(tasks(truth, failed), tasks(model, failed)) > LEVEL


def test_what_is_called_impossible_and_happens_finds_out():
    assert likelihood_ratio_p_value(tasks([0, 0.5], [1, 0]), tasks([0.1, 0.5], [1, 0])) == 0
    assert likelihood_ratio_p_value(tasks([0.5, 0.5], [1, 0]), tasks([0.5, 0.5], [1, 0])) == 1
    with pytest.raises(ModelError, match="not of the same tasks"):
        likelihood_ratio_p_value(tasks([0.5], [1]), tasks([0.5], [0]))
