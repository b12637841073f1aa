"""What was learned in the design: beside its rate, all else letter for letter, and said again the same way."""

import math

import pytest
from scipy.stats import gamma

from robophm.core.errors import DesignError
from robophm.design.file import parse
from robophm.learning.failure_mode_edits import edited
from robophm.learning.rates.evidence import with_evidence
from robophm.learning.rates.failure_log import Seen
from robophm.learning.rates.gamma_poisson import update
from robophm.learning.rates.rate_update import learn

TEXT = """\
schema_version: 1  # first
name: R
environment: GM
modules:
  Power:
    components:
      cell: {quantity: 3, rate: 5 FPMH}  # maker's
      "lamp: old":
        hazard:  # handbook
          model: general.mtbf
          inputs: {mtbf: 40000 h, source: maker}
        uncertainty: {failures: 2}
      # behind it
components:
  bearing:
    rate: 2 FPMH
    life: {distribution: weibull, shape: 2}
  own: {life: {distribution: weibull, scale: 1000 h, shape: 1}}
  fan:
    l10: 20000 h  # by the sheet
    life: {distribution: weibull, shape: 1.5}
    quantity: 2
  laser: {part: lidar_2d}
  gear:
    failure_modes:
      tooth: {rate: 1 FPMH, }
"""


@pytest.fixture
def text():
    try:
        parse(TEXT)
    except DesignError as error:
        pytest.fail(str(error))
    return TEXT


def seen(robot, failures=20, hours=1e6):
    return [Seen(mode, "a", failures, float(mode.life.cumulative_hazard(hours)), hours) for mode in robot.modes]


def test_all_else_stays(text):
    robot = parse(text)
    learned = learn(robot, seen(robot))
    new = with_evidence(text, "R", learned)
    kept = [line for line in new.splitlines() if "learned" not in line]
    was = [line for line in text.splitlines() if line in new.splitlines()]
    assert kept == was
    after = {mode.path: mode for mode in parse(new).modes}
    for one in learned:
        assert after[one.mode.path].rate == pytest.approx(one.mode.rate * one.factor, rel=1e-5)
        assert after[one.mode.path].life.mean() == pytest.approx(1 / after[one.mode.path].rate, rel=1e-9)
        assert after[one.mode.path].uncertainty.failures == pytest.approx(one.shape, rel=1e-5)
    assert "# maker's" in new
    assert "      # behind it" in new


def test_learned_again_it_is_not_counted_twice(text):
    robot = parse(text)
    once = with_evidence(text, "R", learn(robot, seen(robot)))
    again = parse(once)
    learned = learn(again, seen(again))
    assert with_evidence(once, "R", learned) == once
    more = with_evidence(once, "R", learn(again, seen(again, 40)))
    assert more.count("learned:") == once.count("learned:")


def test_of_a_weibull_it_is_the_root_of_the_hazard(text):
    """θ of a Weibull of shape 2: the hazard is θ² times, of which test_gamma_poisson has what it is by quadrature."""
    robot = parse(text)
    mode = next(one for one in robot.modes if one.path == "bearing")
    (learned,) = learn(robot, [Seen(mode, "a", 3, 2.0, 1.0)])
    hazard = update(3, 2.0, 1.0)
    assert learned.factor == pytest.approx(math.sqrt(hazard.estimate), rel=1e-9)  # at which the hazard is the mean one
    assert (learned.low, learned.high) == pytest.approx([math.sqrt(end) for end in hazard.interval], rel=1e-9)
    low, high = gamma.ppf((0.05, 0.95), learned.shape)
    assert high / low == pytest.approx(learned.high / learned.low, rel=1e-6)


def test_an_alias_cannot_have_evidence_of_its_own():
    text = ("schema_version: 1\nname: R\nmodules:\n  a: &a\n    components:\n      m: {rate: 1 FPMH}\n"
            "  b: *a\n")  # fmt: skip
    robot = parse(text)
    with pytest.raises(DesignError, match=r"R:7: 'b' is an alias, which several parts share; expected 'b/m'"):
        with_evidence(text, "R", learn(robot, seen(robot)))


def test_a_result_that_is_no_design_is_refused(text):
    with pytest.raises(DesignError, match="learned"):
        edited(text, "R", {"bearing": {"learned": "{factor: -1, shape: 1, failures: 1, expected: 1}"}})


def test_failure_modes_of_the_library_are_to_be_copied():
    text = "schema_version: 1\nname: R\nusage: {cycles: 1 cycle/h}\ncomponents:\n  B: {part: battery_lipo}\n"
    mode = parse(text).modes[0]
    with pytest.raises(DesignError, match="place of its own: failure_modes copied from 'battery_lipo' of the library"):
        edited(text, "R", {mode.path: {"learned": "{factor: 2, shape: 1, failures: 1, expected: 1}"}})


def test_a_fitted_rate_takes_the_place_of_a_mean_life():
    text = "schema_version: 1\nname: R\ncomponents:\n  fan:\n    mtbf: 9000 h  # guess\n    quantity: 2\n"
    said = edited(text, "R", {"fan": {"rate": "1e-5 /h", "mtbf": None}})
    assert said.splitlines()[3:] == ["  fan:", "    rate: 1e-5 /h", "    quantity: 2"]
    assert parse(said).modes[0].rate == 1e-5
