"""Laws that may change: distributions by quadrature over what Gott's argument says, and what stays as it was."""

import numpy as np
import pytest
from scipy.integrate import quad

from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.law_to_come import given_slowing_ends, off_by_a_factor
from robophm.learning.wear.models.candidates import course_of

DRAWS = 200_000


def course(wear=0.4, age=50.0):
    """A course from time 0 to ``age`` whose wear is steady at its end, so that its mean is its last."""
    times = np.linspace(0, age, 30)
    return course_of(times, np.r_[np.linspace(0, wear, 20), np.full(10, wear)], 1.0, 1.0)


def ended_by(time, law, wear=0.4, age=50.0):
    """P(threshold reached by a time), of a law that alone would reach it at ``law``, by quadrature.

    The law lasts for s more with density age/(age + s)²; from there the share 1 − s/law of the way left takes w with
    P(w ≤ x) = x/(x + what it would have taken at the mean pace).
    """
    if time >= law:
        return 1.0

    def then(s):
        usual = (1 - s / law) * (1 - wear) / wear * age
        return age / (age + s) ** 2 * (time - s) / (time - s + usual)

    return quad(then, 0, time)[0]


@pytest.mark.parametrize("law", [40.0, 300.0, 1e9])
def test_what_slows_may_end_as_gott_says(law):
    found = given_slowing_ends(np.full(DRAWS, law), np.full(DRAWS, -1), course(), np.random.default_rng(1))
    assert found.max() <= law
    for time in (2.0, 10.0, 35.0, 200.0, 2000.0):
        assert np.mean(found <= time) == pytest.approx(ended_by(time, law), abs=0.005)


def test_laws_that_do_not_slow_keep_their_passages():
    passage, accelerates = np.array([3.0, np.inf, 8.0, np.inf]), np.array([0, 0, 1, 1])
    assert given_slowing_ends(passage, accelerates, course(), np.random.default_rng(1)).tolist() == passage.tolist()
    before = course(wear=-0.2)  # no wear yet, so that nothing has a pace
    assert given_slowing_ends(passage, accelerates - 2, before, np.random.default_rng(1)).tolist() == passage.tolist()


@pytest.mark.parametrize(("wear", "doublings"), [(0.8, 1.0), (0.25, 2.0), (0.001, np.log2(100))])
def test_the_factor_of_a_law_that_wanders(wear, doublings):
    for which, deviation, mean in ((0, 0.15, 0.0), (1, 0.25, -0.2), (-1, 0.25, 0.0)):
        logs = np.log(off_by_a_factor(np.ones(DRAWS), np.full(DRAWS, which), course(wear), np.random.default_rng(2)))
        assert logs.mean() == pytest.approx(mean, abs=0.01)
        assert logs.std() == pytest.approx(deviation * np.sqrt(doublings), rel=0.01)


def test_a_fade_that_slows_is_not_followed_to_many_times_its_age():
    """Wear as √t, a third of the way after 100 h: its law alone says 800 h more; by Gott's argument there is less."""
    rng = np.random.default_rng(3)
    hours = np.arange(1.0, 101.0)
    found = forecast(hours, np.sqrt(hours) / 30 + 0.002 * rng.standard_normal(100), 1 / 30 + 29 / 30, judged=False)
    sooner = ended_by(400.0, 800.0, wear=(10 - 1) / 29, age=99.0)
    assert np.mean(found.passage < 400) == pytest.approx(sooner, abs=0.12)  # and all laws are a little other
    assert sooner > 0.4


def test_real_cells_whose_fade_bends_down_at_last(measured_wear):
    """CALCE's, halfway to 0.77 Ah: what truly came is within what is said."""
    for times, capacity in measured_wear("calce_battery_capacity").values():
        end = float(times[np.argmax(capacity <= 0.77)])
        known = times <= end / 2
        said = forecast(times[known], capacity[known], 0.77, falls=True, judged=False).remaining
        assert said.low <= end - times[known][-1] <= said.high
