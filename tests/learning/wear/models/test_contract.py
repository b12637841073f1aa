"""The contract of every degradation model: weights, scores, surprise and passages, on wear whose law is known."""

import numpy as np
import pytest

from robophm.learning.wear.models import candidates_of, degradation_models
from robophm.learning.wear.models.candidates import course_of

TIMES = np.arange(1.0, 61.0)


def course(bend=1.0, threshold=2.0, noise=0.0):
    """Growing wear of a known power of time, in gamma increments; ends at 1."""
    rng = np.random.default_rng(1)
    shape = 400 * np.diff((TIMES / 60) ** bend, prepend=0.0)
    values = np.cumsum(rng.gamma(np.maximum(shape, 1e-3), 1 / 400)) + noise * rng.standard_normal(60)
    return course_of(TIMES, values + 1.0, threshold + 1.0, 60.0)


@pytest.fixture(params=degradation_models())
def name(request):
    return request.param


def test_weights_scores_and_surprise(name):
    found = candidates_of(name, course())
    assert found.prior.sum() == pytest.approx(1)
    assert np.all(found.prior >= 0)
    for each in (found.scores, found.noise(), found.accelerates, found.surprise()):
        assert each.shape == found.prior.shape
        assert np.isfinite(each).all()
    assert np.all((found.surprise() >= 0) & (found.surprise() <= 1))
    assert set(np.unique(found.accelerates)) <= {-1, 0, 1}


def test_passages_are_later_for_farther_goals_and_by_seed(name):
    found = candidates_of(name, course())
    which = np.full(400, int(np.argmax(found.prior * np.exp(found.scores - found.scores.max()))))
    near, again, far = (found.passages(which, np.full(400, goal), np.random.default_rng(3)) for goal in (0.6, 0.6, 1.0))
    assert np.array_equal(near, again)
    assert np.all(near >= 0)
    assert np.median(near) < np.median(far)
    assert np.all(found.passages(which, np.full(400, -1.0), np.random.default_rng(3)) == 0)


def test_straight_wear_arrives_when_a_line_does(name):
    """The best candidate of each model can follow straight wear: half of it took 60, so does the other half."""
    found = candidates_of(name, course())
    which = np.full(400, int(np.argmax(found.prior * np.exp(found.scores - found.scores.max()))))
    arrives = np.median(found.passages(which, np.ones(400), np.random.default_rng(3)))
    assert arrives == pytest.approx(1.0, rel=0.5 if name in ("power_growth", "exponential", "power_time") else 0.15)


def test_speed_is_wear_per_time(name):
    found = candidates_of(name, course())
    which = np.full(400, int(np.argmax(found.prior * np.exp(found.scores - found.scores.max()))))
    assert np.median(found.speed(which, np.random.default_rng(2))) == pytest.approx(0.5, rel=0.3)  # half in one time


def test_what_a_model_cannot_be():
    """A gamma process never turns back; growth by its own size needs a zero; the others take any course."""
    noisy = course(noise=0.2)
    assert candidates_of("gamma_process", noisy) is None
    crossing = course_of(TIMES, TIMES - 30, 60.0, 60.0)
    assert candidates_of("power_growth", crossing) is None
    assert all(candidates_of(name, crossing) for name in ("wiener", "power_time", "exponential"))


def test_passages_of_a_wiener_process_are_inverse_gaussian():
    """Of the candidate without noise and wandering, whose drift and σ a thousand readings tell."""
    rng = np.random.default_rng(6)
    times = np.arange(1.0, 1001.0)
    course = course_of(times, np.cumsum(1.0 + 2.0 * rng.standard_normal(1000)), 2000.0, 1000.0, most=1000)
    found = candidates_of("wiener", course)
    drawn = found.passages(np.zeros(4000, dtype=int), np.ones(4000), rng)  # NOISE 1e-5, WANDERING 0
    first, last = course.wear[0] * 1999, course.wear[-1] * 1999
    drift = (last - first) / 999
    exact = rng.wald((1999 - last) / drift, (1999 - last) ** 2 / 4.0, 4000) / 1000
    exact = exact * (drift / (drift + 2 / np.sqrt(1000) * rng.standard_normal(4000)))  # the drift is not known better
    assert np.quantile(drawn, [0.1, 0.5, 0.9]) == pytest.approx(np.quantile(exact, [0.1, 0.5, 0.9]), rel=0.05)
