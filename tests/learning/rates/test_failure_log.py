"""Logs of failures: what they add up to by hand, and what is refused, and how."""

import time

import pytest

from robophm.core.errors import DataError
from robophm.design.file import parse
from robophm.learning.rates.failure_log import read_failure_log
from robophm.learning.rates.rate_update import learn

DESIGN = """
schema_version: 1
name: R
usage: {kilometres: 1 km/h}
components:
  motor: {quantity: 2, rate: 10 FPMH}
  bearing: {rate: 1e-4 /km, clock: kilometres, life: {distribution: weibull, shape: 2}}
  arm:
    failure_modes:
      gear: {rate: 20 FPMH}
      belt: {rate: 3e-5 /km, clock: kilometres}
"""
HEAD = "part,robot,when,exposure,censored,action,remaining,count,since\n"


@pytest.fixture
def robot():
    return parse(DESIGN)


@pytest.fixture
def seen(tmp_path, robot):
    def seen(text, name="log.csv"):
        path = tmp_path / name
        path.write_text(text)
        found = read_failure_log(path, robot)
        return {(one.mode.path, one.robot): one for one in found.seen}, found.notes

    return seen


def test_sums_by_hand(seen):
    found, notes = seen(
        "part;robot;exposure [h];censored;action\n"
        "motor[1];a;4000;;replaced\nmotor[1];a;1000;yes;\nmotor[2];a;5000;yes;\nmotor[1];b;300;yes;\n"
    )
    one = found["motor", "a"]
    assert (one.failures, one.exposure, one.expected) == (1, 10_000, pytest.approx(0.1))
    assert (found["motor", "b"].failures, found["motor", "b"].exposure) == (0, 300)
    assert notes == []


def test_a_repair_keeps_a_share_of_the_age(seen, robot):
    """Weibull of shape 2: H = (t/η)². Kijima II: 1000 km, then half of it remains: from 500 to 1500 km."""
    eta = robot.modes[1].life.scale
    found, _ = seen(HEAD + "bearing,a,,1000 km,,repaired,0.5,,\nbearing,a,,2000 km,yes,,,,\n")
    one = found["bearing", "a"]
    assert one.expected == pytest.approx((1000**2 + 1500**2 - 500**2) / eta**2, rel=1e-12)
    as_new, _ = seen(HEAD + "bearing,a,,1000 km,,repaired,0,,\nbearing,a,,2000 km,yes,,,,\n")
    replaced, _ = seen(HEAD + "bearing,a,,1000 km,,replaced,,,\nbearing,a,,1000 km,yes,,,,\n")
    assert as_new["bearing", "a"].expected == pytest.approx(replaced["bearing", "a"].expected, rel=1e-12)
    minimal, _ = seen(HEAD + "bearing,a,,1000 km,,repaired,,,\nbearing,a,,2000 km,yes,,,,\n")
    assert minimal["bearing", "a"].expected == pytest.approx(2000**2 / eta**2, rel=1e-12)


def test_since_when_it_was_watched(seen, robot):
    eta = robot.modes[1].life.scale
    found, _ = seen(HEAD + "bearing,a,,2000 km,yes,,,,1500 km\n")
    assert found["bearing", "a"].expected == pytest.approx((2000**2 - 1500**2) / eta**2, rel=1e-12)
    assert found["bearing", "a"].exposure == 500


def test_modes_on_their_own_clocks(seen):
    """A gear that fails is the end of the belt's life too, where the arm is replaced."""
    found, notes = seen(HEAD + "arm/gear,a,,500 h; 90 km,,replaced,,,\narm,a,,200 h; 40 km,yes,,,,\n")
    gear, belt = found["arm/gear", "a"], found["arm/belt", "a"]
    assert (gear.failures, gear.exposure) == (1, 700)
    assert (belt.failures, belt.exposure) == (0, 130)
    assert notes == []


def test_yaml_and_dates(seen):
    found, notes = seen(
        "schema_version: 1\nfailures:\n"
        "  - {part: bearing, robot: a, when: 2024-03-01, exposure: 800 km}\n"
        "  - {part: bearing, robot: a, when: 2024-01-01, exposure: 100 km, censored: yes}\n",
        "log.yaml",
    )
    assert found["bearing", "a"].exposure == 800  # in order of the dates
    assert "ends with a replacement" in notes[0]


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("motr,a,,1 h,,,,,", r"log.csv:2: part: no part 'motr' in the design; did you mean 'motor'"),
        ("motor,a,,-5 h,,,,,", r"exposure: -5 h is negative; expected the age of the part"),
        ("motor,a,,5,,,,,", r"exposure: '5' has no unit; expected e.g. '5 h'; or head the column 'exposure \[h\]'"),
        ("motor,a,,5 km,,,,,", r"unit 'km' does not measure what 'h' does"),
        ("motor,a,,,,,,,", r"exposure: is empty; expected how old the part was"),
        ("motor,a,,nan h,,,,,", r"exposure: 'nan h' is not a number with a unit"),
        ("motor,a,,0 h,,,,,", "log.csv:2: exposure: failed at an age of 0, before it worked"),
        ("motor,a,,1e300 h,yes,,,,", r"log.csv:2: exposure: 1e300 h is no age of a part; expected 0 … 1e.15 h"),
        ("bearing,a,,500 km,yes,,,,\nbearing,a,,300 km,,,,,", r"300 km contradicts itself: line 2 says 500 km"),
        ("arm,a,,5 h,,,,,", r"'arm' failed, but by which of its modes is not said; expected 'arm/gear', 'arm/belt'"),
        ("arm/belt,a,,5 h,,,,,", r"says nothing in km, in which 'arm/belt' ages"),
        ("motor,a,,5 h,,repaired,,,", r"which of 2 was repaired\? expected 'motor\[1\]'"),
        ("motor[3],a,,5 h,,,,,", r"there are \[1\] … \[2\]"),
        ("bearing,a,,5 km,,repaired,1.5,,", r"remaining: 1.5; expected 0 \(as good as new\)"),
        ("bearing,a,,5 km,,,0.5,,", r"remaining: is of a repair"),
        ("bearing,a,,5 km,,,,2,", r"a robot has one 'bearing'"),
        ("motor,a,,5 h,perhaps,,,,", r"censored: 'perhaps'; expected yes or no"),
        ("bearing,a,tomorrow,5 km,,,,,", r"no date; expected e.g. 2024-03-18"),
        ("motor[1],a,2024-01-01,10 h,yes,,,,\nmotor[1],a,2024-01-03,500 h,yes,,,,", r"490 h since line 2, .* 48 h"),
        ("motor,a,,1 h,,,,,,,9", r"has 11 cells; expected 9"),
    ],
)
def test_refusals(seen, rows, said):
    text = rows if "tomorrow" not in rows else rows + "\nbearing,a,tomorrow,6 km,,,,,"
    with pytest.raises(DataError, match=said) as error:
        seen(HEAD + text + "\n")
    assert "\n" not in str(error.value)


def test_refused_tables(seen, tmp_path):
    with pytest.raises(DataError, match=r"unknown column 'expsure'; did you mean 'exposure'"):
        seen("part,expsure\nmotor,5 h\n")
    with pytest.raises(DataError, match=r"holds no failures; expected columns part, robot"):
        seen("part,exposure\n")
    with pytest.raises(DataError, match=r"unknown key 'failure'; did you mean 'failures'"):
        seen("schema_version: 1\nfailure: []\n", "log.yaml")
    with pytest.raises(DataError, match="no such file"):
        read_failure_log(tmp_path / "none.csv", parse(DESIGN))


def test_what_a_prior_may_be(seen, tmp_path, robot):
    path = tmp_path / "log.csv"
    path.write_text("part,exposure\nmotor,5000 h\nbearing,100 km\n")
    found = read_failure_log(path, robot).seen
    assert {one.posterior.prior for one in learn(robot, found, "3 failures")} == {3.0}
    with pytest.raises(DataError, match=r"'bearing' ages by km"):
        learn(robot, found, "5000 h")
    only = [one for one in found if one.mode.path == "motor"]
    assert learn(robot, only, "5000 h")[0].posterior.prior == pytest.approx(0.05)
    with pytest.raises(DataError, match="more than nothing"):
        learn(robot, only, "0 failures")
    with pytest.raises(DataError, match=r"counts as 1e.300 failures of 'motor'; expected at most 1e.09"):
        learn(robot, only, "1e300 failures")
    with pytest.raises(DataError, match=r"no robot 'x'"):
        learn(robot, only, of="x")


def test_dates_are_the_same_everywhere(tmp_path, monkeypatch):
    """A date of no time zone is UTC: not a time that a summer somewhere leaves out."""
    robot = parse("{schema_version: 1, name: R, components: {a: {rate: 1 FPMH}}}")
    path = tmp_path / "log.csv"
    rows = "a,r,2024-03-01T00:00Z,0 h,yes\na,r,2024-03-31T00:00,{hours} h,yes\n"
    for zone in ("UTC", "Pacific/Kiritimati", "America/Los_Angeles"):
        monkeypatch.setenv("TZ", zone)
        time.tzset()
        path.write_text("part,robot,when,exposure,censored\n" + rows.format(hours=30 * 24 + 24))
        assert read_failure_log(path, robot).seen[0].exposure == 31 * 24
        path.write_text("part,robot,when,exposure,censored\n" + rows.format(hours=30 * 24 + 25))
        with pytest.raises(DataError, match="which is 720 h earlier by its date"):
            read_failure_log(path, robot)
    monkeypatch.undo()
    time.tzset()
