"""Prognostic metrics: worked by hand, and side by side with NASA's progpy where it is installed."""

import numpy as np
import pytest

from robophm.calibration.lives import score_lives
from robophm.calibration.predictions import LEVELS, Lives
from robophm.core.errors import ModelError
from robophm.core.prognostics import (
    History,
    alpha_lambda,
    convergence,
    cumulative_relative_accuracy,
    prognostic_horizon,
    relative_accuracy,
)

# Ends at 100; the errors are 30, 15, 6, 2, 0.
BY_HAND = History(np.arange(0.0, 100, 20), np.array([130.0, 95, 66, 42, 20]), 100.0)


def test_horizon_by_hand():
    """Within ±20 of the truth from t = 20 on, within ±10 from 40 on, within ±0 at 80 alone."""
    assert prognostic_horizon(BY_HAND, alpha=0.2) == 80
    assert prognostic_horizon(BY_HAND, alpha=0.16) == 80  # of the end; 0.16 of what is left would be too little
    assert prognostic_horizon(BY_HAND, alpha=0.1) == 60
    assert prognostic_horizon(BY_HAND, alpha=0) == 20
    assert prognostic_horizon(History(np.array([0.0]), np.array([300.0]), 100.0)) is None


def test_alpha_lambda_by_hand():
    """Half way is t = 50, first predicted at 60, where 40 is left and the error is 2."""
    assert alpha_lambda(BY_HAND, 0.5, alpha=0.05) is True
    assert alpha_lambda(BY_HAND, 0.5, alpha=0.04) is False
    assert alpha_lambda(BY_HAND, 0.0, alpha=0.29) is False
    assert alpha_lambda(BY_HAND, 0.9) is None


def test_share_of_the_distribution():
    """Ten of 0, 10, …, 90 hours where 45 are left: four lie within 20 (30 … 60)."""
    one = History(np.array([5.0]), np.arange(0.0, 100, 10)[None], 50.0)
    assert one.within(20) == pytest.approx([0.4])
    assert alpha_lambda(one, 0.0, alpha=20 / 45, beta=0.4) is True
    assert alpha_lambda(one, 0.0, alpha=20 / 45, beta=0.41) is False
    assert one.point == pytest.approx([45])


def test_relative_accuracy_by_hand():
    assert relative_accuracy(BY_HAND) == pytest.approx([0.7, 0.8125, 0.9, 0.95, 1])
    assert cumulative_relative_accuracy(BY_HAND) == pytest.approx(0.8725)
    assert cumulative_relative_accuracy(BY_HAND, np.array([0, 0, 0, 1, 3])) == pytest.approx(0.9875)


def test_convergence_by_hand():
    """Steps 30, 15, 6, 2 high and 20 wide: area 1060, centroid (23800/1060, 11650/1060)."""
    assert convergence(BY_HAND) == pytest.approx((22.4528301887**2 + 10.9905660377**2) ** 0.5, rel=1e-10)
    later = History(BY_HAND.time + 1e6, BY_HAND.remaining, BY_HAND.end + 1e6)
    assert convergence(later) == pytest.approx(convergence(BY_HAND), rel=1e-12)
    # a constant error over [0, 80]: the middle of a rectangle
    flat = History(BY_HAND.time, BY_HAND.left + 7, 100.0)
    assert convergence(flat) == pytest.approx((40**2 + 3.5**2) ** 0.5)
    assert convergence(History(BY_HAND.time, BY_HAND.left, 100.0)) is None


@pytest.mark.parametrize(
    ("time", "remaining", "end"),
    [([], [], 1), ([0, 1], [1], 2), ([1, 0], [1, 1], 2), ([0, 2], [1, 1], 2), ([0], [np.nan], 2), ([0], [1], np.inf)],
)
def test_what_is_no_history(time, remaining, end):
    with pytest.raises(ModelError, match="history: "):
        History(np.array(time, dtype=float), np.array(remaining, dtype=float), end)


def test_over_many_lives():
    """Exact foresight: horizon all of the life, every criterion met, accuracy 1; no error, so no convergence."""
    robots, each, mean = 5, 4, 50.0
    robot = np.repeat(np.arange(robots), each)
    time = np.tile([0.0, 10, 20, 30], robots)
    observed = mean - time
    sharp = observed[:, None] * np.linspace(0.98, 1.02, len(LEVELS))
    one = Lives(robot, time, sharp, np.full(robot.size, 0.5), observed, np.zeros(robot.size, bool))
    found = score_lives(one).prognosis
    assert found is not None
    assert (found.lives, found.never, found.half_way_lives) == (5, 0, 5)
    assert (found.horizon, found.half_way) == (1, 1)
    assert found.relative_accuracy == pytest.approx(1, abs=1e-3)


def test_over_one_life_by_hand():
    """The history above as a file states it, in hours since the epoch, among robots without an end or a second row."""
    hours = np.concatenate([BY_HAND.time, [0.0], BY_HAND.time]) + 472_222.0
    robot = np.repeat([0, 1, 2], [5, 1, 5])
    medians = np.concatenate([BY_HAND.point, [50.0], BY_HAND.point])
    observed = np.concatenate([BY_HAND.left, [50.0], BY_HAND.left])
    quantiles = np.repeat(medians[:, None], len(LEVELS), axis=1)
    rows = np.random.default_rng(22).permutation(11)
    one = Lives(robot[rows], hours[rows], quantiles[rows], np.full(11, 0.5), observed[rows], (robot == 2)[rows])
    found = score_lives(one).prognosis
    assert found is not None
    assert (found.lives, found.half_way_lives, found.never) == (1, 1, 0)
    assert found.horizon == pytest.approx(0.8)
    assert found.half_way == 1
    assert found.relative_accuracy == pytest.approx(0.8725)
    assert found.convergence == pytest.approx((22.4528301887**2 + 10.9905660377**2) ** 0.5)


@pytest.fixture(scope="module")
def random_histories():
    rng = np.random.default_rng(21)
    found = []
    for _ in range(20):
        end = rng.uniform(50, 200)
        time = np.sort(rng.uniform(0, end, 9))
        found.append(History(time, (end - time)[:, None] * rng.lognormal(0.1, 0.3, (9, 41)), end))
    return found


def profile_of(history):
    predictors = pytest.importorskip("progpy.predictors", reason="progpy is not installed: pip install robophm[peers]")
    data = pytest.importorskip("progpy.uncertain_data")
    profile = predictors.ToEPredictionProfile()
    for time, remaining in zip(history.time.tolist(), history.remaining, strict=True):
        profile.add_prediction(time, data.UnweightedSamples([{"end": time + float(r)} for r in remaining]))
    return profile


@pytest.mark.parametrize("alpha", [0.1, 0.3])
def test_horizon_as_progpy(random_histories, alpha):
    for history in random_histories:

        def good(remaining, truth, margin=alpha * history.end):
            share = remaining.percentage_in_bounds([truth["end"] - margin, truth["end"] + margin])
            return {"end": share["end"] >= 0.5}

        found = profile_of(history).prognostic_horizon(good, {"end": history.end})["end"]
        assert prognostic_horizon(history, alpha, 0.5) == (None if found is None else pytest.approx(found))


@pytest.mark.parametrize("share", [0.2, 0.5, 0.8])
def test_alpha_lambda_as_progpy(random_histories, share):
    """progpy's λ is a time; ours is the share of the way to the end."""
    for history in random_histories:
        due = history.time[0] + share * (history.end - history.time[0])
        found = profile_of(history).alpha_lambda({"end": history.end}, due, 0.2, 0.5)
        assert alpha_lambda(history, share, 0.2, 0.5) == (found and found["end"])


def test_relative_accuracy_as_progpy(random_histories):
    """progpy takes the mean, so ours is given it; its profile's accuracy is relative to the end, not to what's left."""
    for history in random_histories:
        means = History(history.time, history.remaining.mean(axis=1), history.end)
        profile = profile_of(history)
        of_remaining = [
            (predicted - time).relative_accuracy({"end": history.end - time})["end"]
            for time, predicted in profile.items()
        ]
        assert relative_accuracy(means) == pytest.approx(of_remaining, rel=1e-9)
        of_end = profile.cumulative_relative_accuracy({"end": history.end})["end"]
        weighted = 1 - np.mean((1 - relative_accuracy(means)) * means.left / means.end)
        assert of_end == pytest.approx(weighted, rel=1e-9)
