"""What breaks late: since when its damage shows, and how long others went on since theirs did."""

import numpy as np
import pytest

from robophm.learning.wear.among_others import Unit, forecast_among
from robophm.learning.wear.averaging import forecast
from robophm.learning.wear.since_onset import onset

LIMIT = 1.2


def bearing(rng, sound, lasts, bend=1.5, noise=0.01):
    """Vibration that stays until ``sound`` and then grows to the limit within ``lasts``, an hour a reading."""
    hours = np.arange(1.0, sound + lasts + 1)
    level = 0.3 + (LIMIT - 0.3) * (np.maximum(hours - sound, 0) / lasts) ** bend
    return hours, level * (1 + noise * rng.standard_normal(len(hours)))


def wear(values):
    return (values - values[0]) / (LIMIT - values[0])


@pytest.mark.parametrize(("sound", "lasts"), [(400, 60), (900, 40)])
def test_damage_shows_soon_after_it_begins(sound, lasts):
    hours, values = bearing(np.random.default_rng(1), sound, lasts)
    began = onset(hours[:-5], wear(values)[:-5])
    assert began is not None
    assert sound <= began <= sound + lasts / 2


def test_what_is_sound_and_what_wears_all_its_life_has_no_onset():
    rng = np.random.default_rng(1)
    hours, values = bearing(rng, 400, 60)
    assert onset(hours[:390], wear(values)[:390]) is None
    steady = 0.3 + 0.001 * hours + 0.003 * rng.standard_normal(len(hours))
    assert onset(hours, wear(steady)) is None
    assert onset(hours[:50], np.zeros(50)) is None  # it stood still
    assert onset(hours[:3], wear(values)[:3]) is None


def test_a_jump_of_late_is_not_taken_for_the_end():
    """A mean of the last stretch leads to a limit that the last readings are short of: what is left is not nothing."""
    rng = np.random.default_rng(1)
    hours = np.arange(1.0, 871.0)
    values = np.where(hours < 850, 0.35, 1.2) * (1 + 0.02 * rng.standard_normal(870))
    found = forecast(hours, values, 1.9)
    assert not found.worn_out
    assert found.reached is None
    assert found.passage.min() > 0


@pytest.mark.full
def test_before_damage_shows_only_lives_count_and_then_how_long_others_went_on():
    """Damage lasts 60 h to a fifth in lives of 200 to 900 h, and grows as √t to t³: a level says little of the rest."""
    rng = np.random.default_rng(4)
    bends = np.geomspace(0.5, 3.0, 8)
    kind = [bearing(rng, rng.uniform(200, 900), 60 * np.exp(0.2 * rng.standard_normal()), bend) for bend in bends]
    others = [Unit(*one, LIMIT) for one in kind]
    held, off, weights = [], [], []
    for k, (hours, values) in [*enumerate(kind)][1::2]:
        rest = [one for j, one in enumerate(others) if j != k]
        sound = forecast_among(rest, hours[:150], values[:150], LIMIT, draws=500)
        assert {name for name, share in sound.weights.items() if share} == {"others' lives"}
        now = len(hours) - 25
        found = forecast_among(rest, hours[:now], values[:now], LIMIT, draws=2000)
        left = float(hours[-1] - hours[now - 1])
        weights.append(found.weights["others since damage showed"])
        held.append(found.remaining.low <= left <= found.remaining.high)
        off.append(abs(found.remaining.median - left) / left)
    assert np.mean(held) == 1.0
    assert np.median(off) < 0.5
    assert max(weights) > 0.5
