"""What stands in place of a rate: a mean life, or the age by which a tenth have failed, against closed forms."""

import json
import math
import re

import pytest
from scipy import stats
from scipy.special import erfinv
from tests.cases import each_case

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.design.robot import CLOCK_UNITS
from robophm.hazard.handbooks import handbook_model
from robophm.life import life_distributions

HEAD = "schema_version: 1\nname: R\n"
USAGE = "usage: {kilometres: 1 km/h, cycles: 1 cycle/h, starts: 1 start/h}\n"


def mode(text):
    (found,) = parse(f"{HEAD}{USAGE}components: {{A: {{{text}}}}}").modes
    return found


Z = math.sqrt(2) * erfinv(2 * 0.1 - 1)  # of the standard normal the age by which a tenth are over
TENTH = -math.log(0.9)

LIVES = {  # what the design says: the mean, and the age by which a tenth have failed, of a scale of 1 (or 0, moved)
    "": (1.0, TENTH),
    "weibull, shape: 1.5": (math.gamma(1 + 1 / 1.5), TENTH ** (1 / 1.5)),
    "weibull, shape: 0.7": (math.gamma(1 + 1 / 0.7), TENTH ** (1 / 0.7)),
    "rayleigh": (math.sqrt(math.pi) / 2, math.sqrt(TENTH)),
    "gamma, shape: 2.5": (2.5, stats.gamma(2.5).ppf(0.1)),
    "lognormal, log_deviation: 0.6": (math.exp(0.18), math.exp(0.6 * Z)),
    "loglogistic, shape: 3": (math.pi / 3 / math.sin(math.pi / 3), (1 / 9) ** (1 / 3)),
    "curve, shape: 0.8": (None, math.log1p(TENTH) ** (1 / 0.8)),
}
MOVED = {
    "normal, deviation: 90 h": (0.0, 90 * Z),
    "extreme_value, scale: 90 h": (-90 * 0.5772156649015329, 90 * math.log(TENTH)),
}


def life_of(said, location=0):
    more = f", location: {location} h" if location else ""
    return f"life: {{distribution: {said or 'exponential'}{more}}}"


def test_these_are_all_lives_that_have_a_scale():
    said = {(one or "exponential").partition(",")[0] for one in (*LIVES, *MOVED)}
    assert said == set(life_distributions()) - {"markov", "piecewise"}


@each_case("location", [0, 300])
@each_case("said", LIVES)
@each_case("key", ["mtbf", "mttf", "l10", "b10"])
def test_the_scale_is_that_of_the_figure(key, said, location):
    mean, tenth = LIVES[said]
    found = mode(f"{key}: 1000 h, {life_of(said, location)}")
    if key in ("l10", "b10"):
        assert found.life.survival(1000.0) == pytest.approx(0.9, rel=1e-12)
        if mean is not None:
            assert found.life.mean() == pytest.approx(location + (1000 - location) * mean / tenth, rel=1e-11)
    else:
        assert found.life.mean() == pytest.approx(1000, rel=1e-11)
        if mean is not None:
            assert found.life.quantile(0.1) == pytest.approx(location + (1000 - location) * tenth / mean, rel=1e-11)
    if said.startswith("curve"):  # its rate is λ itself: see docs/theory/numbers.md
        assert found.rate == found.life.rate
        assert found.life.cumulative_hazard(location + 1 / found.rate) == pytest.approx(math.e - 1, rel=1e-12)
    else:
        assert found.rate == pytest.approx(1 / found.life.mean(), rel=1e-12)
    assert getattr(found.life, "location", 0) == location


@each_case("said", MOVED)
def test_lives_that_are_moved_by_their_figure(said):
    mean, tenth = MOVED[said]
    by_mean, by_tenth = (mode(f"{key}: 1000 h, {life_of(said)}").life for key in ("mtbf", "l10"))
    assert by_mean.mean() == pytest.approx(1000, rel=1e-12)
    assert by_mean.quantile(0.1) == pytest.approx(1000 - mean + tenth, rel=1e-11)
    assert by_tenth.survival(1000.0) == pytest.approx(0.9, rel=1e-12)
    assert by_tenth.mean() == pytest.approx(1000 - tenth + mean, rel=1e-12)


@each_case("said", ["", "weibull, shape: 1.5", "weibull, shape: 3"])
def test_a_tenth_is_that_of_the_handbooks_model(said):
    """The model is the closed form of the Weibull; the key asks the life itself. They are one figure."""
    shape = float(said.rpartition(" ")[2] or 1)
    model = handbook_model("general.b10")
    rate = float(model.evaluate(model.settle({"b10": "1000 h", "shape": shape, "source": "s"})).value)
    assert mode(f"b10: 1000 h, {life_of(said)}").rate == pytest.approx(rate, rel=1e-13)


@each_case("clock", CLOCK_UNITS)
def test_a_figure_is_in_the_unit_of_its_clock(clock):
    unit = CLOCK_UNITS[clock]
    assert mode(f"mtbf: 200 {unit}, clock: {clock}").rate == pytest.approx(1 / 200, rel=1e-15)
    assert mode("mtbf: 2 year").rate == pytest.approx(1 / (2 * 365.25 * 24), rel=1e-12)
    assert mode("l10: 5e6 m, clock: kilometres").rate == pytest.approx(TENTH / 5000, rel=1e-12)


@each_case("key", ["mtbf", "l10"])
@each_case("location", [0, 300])
def test_what_is_learned_is_of_the_rate_that_follows(key, location):
    life = life_of("weibull, shape: 1.5", location)
    stated = mode(f"{key}: 1000 h, {life}")
    learned = mode(f"{key}: 1000 h, {life}, learned: {{factor: 2, shape: 3, failures: 2, expected: 1}}")
    assert learned.rate == pytest.approx(2 * stated.rate, rel=1e-12)
    assert learned.life.mean() == pytest.approx(stated.life.mean() / 2, rel=1e-12)


def test_a_curve_with_a_scale_of_its_own_is_learned_of_by_its_rate():
    life = "life: {distribution: curve, rate: 1e-3 /h, shape: 0.8}"
    assert mode(life).rate == 1e-3
    assert mode(f"{life}, learned: {{factor: 2, shape: 3, failures: 2, expected: 1}}").life.rate == 2e-3


def test_rates_drawn_are_shares_of_the_rate_that_follows():
    found = mode("mtbf: 1000 h, uncertainty: {samples: [5e-4 /h, 2e-3 /h]}")
    assert found.uncertainty.samples == pytest.approx((0.5, 2.0))


def test_failure_modes_have_figures_of_their_own():
    found = parse(f"{HEAD}components: {{A: {{failure_modes: {{a: {{mttf: 5 h}}, b: {{l10: 5 h}}}}}}}}").modes
    assert [one.rate for one in found] == pytest.approx([0.2, TENTH / 5], rel=1e-12)


def test_a_tenth_without_a_life_says_by_which_it_was_taken():
    def notes(text):
        return parse(f"{HEAD}components: {{A: {{{text}}}}}").notes

    assert notes("l10: 5 h") == ("A: its l10 is by an exponential life, as none is stated",)
    assert notes("b10: 5 h") == ("A: its b10 is by an exponential life, as none is stated",)
    for said in ("l10: 5 h, life: {distribution: exponential}", "mtbf: 5 h", "rate: 5 FIT"):
        assert notes(said) == ()


FAULTS = {
    "rate: 20000 h": "A/rate: unit 'h' does not measure what '1/h' does; an MTBF? write mtbf: 20000 h",
    "rate: 2e5 km, clock: kilometres": "does not measure what '1/km' does; an MTBF? write mtbf: 2e5 km",
    "mtbf: 12 FIT": "A/mtbf: unit 'FIT' does not measure what 'h' does",
    "mtbf: 20000": "A/mtbf: '20000' has no unit; expected e.g. '20000 h'",
    "mtbf: unknown": "A/mtbf: 'unknown' is not a number with a unit",
    "mtbf: 0 h": "A/mtbf: mtbf 0 h; expected above zero",
    "l10: -3 h": "A/l10: l10 -3 h; expected above zero",
    "l10: .nan": "A/l10: nan is not a finite number",
    "mtbf: 3 h, rate: 1 FIT": "A/rate: both 'rate' and 'mtbf' are given; expected one of the two",
    "mtbf: 3 h, mttf: 3 h": "A/mtbf: both 'mtbf' and 'mttf' are given",
    "mtbf: 3 h, rate: unknown": "A/rate: both 'rate' and 'mtbf' are given",
    "b10: 3 h, hazard: {model: general.mtbf, inputs: {mtbf: 3 h, source: s}}": "A/b10: both 'b10' and 'haz",
    "l10: 3 h, life: {distribution: weibull, shape: 2, scale: 3 h}": "A/life/scale: 'l10' and the life's own scale are",
    "l10: 3 h, life: {distribution: weibull}": "A/life: Weibull: shape parameter 'shape' is missing",
    "l10: 3 h, life: {distribution: weibull, shape: 2, location: 4 h}": "A/life: Weibull: age − location = -1.0",
    "mtbf: 3 h, life: {distribution: rayleigh, location: 4 h}": "A/life: Rayleigh: mean − location = -1.0",
    "mtbf: 3 h, life: {distribution: loglogistic, shape: 0.9}": "A/life: Loglogistic: with {'shape': 0.9} the mean is ",
    "l10: 3 h, life: {distribution: loglogistic, shape: 0.9}": "A/life: Loglogistic: its mean is inf, expected a",
    "life: {distribution: loglogistic, shape: 0.9, scale: 3 h}": "A/life: Loglogistic: its mean is inf, expected a",
    "life: {distribution: normal, centre: 0 h, deviation: 3 h}": "A/life: Normal: its mean is 0, expected a finite",
    "mtbf: 3 h, life: {distribution: piecewise, ages: [0 h], hazard_rates: [1 /h]}": "A/life: Piecewise: no scale ",
    "mtbf: 3 h, failure_modes: {a: {rate: 1 FIT}}": "A: has failure_modes and its own mtbf",
}


@each_case("text", FAULTS)
def test_what_is_wrong_is_said_at_its_key(text):
    with pytest.raises(DesignError, match=re.escape(FAULTS[text])):
        mode(text)


def test_the_robot_is_the_same_however_its_figure_is_said():
    said = {"rate": "1e-3 /h", "mtbf": "1000 h", "mttf": "1 kh"}
    found = [mode(f"{key}: {json.dumps(text)}, {life_of('gamma, shape: 2')}") for key, text in said.items()]
    assert {round(one.life.scale, 9) for one in found} == {500.0}
