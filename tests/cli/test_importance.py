"""robophm importance, run as a newcomer does."""

import json
import math

import pytest

from robophm.core.signal import SECOND
from robophm.transports.synthetic import SyntheticOta

ROBOT = """
schema_version: 1
name: Pair
task: {duration: 5 h}
components:
  computer: {rate: 10 FPMH}
  motor: {rate: 50 FPMH, quantity: 2, required: 1, initial_exposure: 8000 h}
  bearing: {rate: 40 FPMH, life: {distribution: weibull, shape: 2}, initial_exposure: 9000 h}
functions: {see: computer, move: {series: [computer, motor]}}
"""

TREE = """
<opsa-mef><define-fault-tree name="t">
<define-gate name="top"><and><gate name="one"/><gate name="two"/></and></define-gate>
<define-gate name="one"><or><basic-event name="ValveOne"/><basic-event name="PumpOne"/></or></define-gate>
<define-gate name="two"><or><basic-event name="ValveTwo"/><basic-event name="PumpTwo"/></or></define-gate>
</define-fault-tree><model-data>
<define-basic-event name="ValveOne"><float value="0.4"/></define-basic-event>
<define-basic-event name="PumpOne"><float value="0.6"/></define-basic-event>
<define-basic-event name="ValveTwo"><float value="0.5"/></define-basic-event>
<define-basic-event name="PumpTwo"><float value="0.7"/></define-basic-event></model-data></opsa-mef>
"""  # SCRAM's correct_tree_input_with_probs.xml


@pytest.fixture
def robot(tmp_path):
    path = tmp_path / "robot.yaml"
    path.write_text(ROBOT)
    return path


def test_a_robot_as_a_table_and_as_json(inside, robot):
    text = inside("importance", robot, "--within", "100 h").stdout
    assert "Pair, new and as designed: fails within 100 h of operation with " in text
    assert "bearing" in text.splitlines()[2]
    assert "What to replace first. As it is: median remaining life" in text
    said = json.loads(inside("importance", robot, "--within", "100 h", "--function", "move", "--json").stdout)
    found = said["importance"]["sensor_based"]
    assert (said["system"], found["hours"], found["count"]) == ("Pair: move", 100.0, 3)
    units = {one["unit"]: one for one in found["units"]}
    works = 1 - (1 - math.exp(-0.4)) ** 2  # of the pair till now: nobody has looked at the motors
    p, q = math.exp(-0.4), -math.expm1(-0.005)
    pair_fails = (p * p * q * q + 2 * p * (1 - p) * q) / works
    assert found["failure"] == pytest.approx(1 - math.exp(-0.001) * (1 - pair_fails), rel=1e-10)
    assert units["computer"]["birnbaum"] == pytest.approx(1 - pair_fails, rel=1e-12)
    gains = {one["path"]: one for one in said["replacement"]["sensor_based"]["parts"]}
    assert set(gains) == {"computer", "motor"}
    assert gains["motor"]["completion"] > 0 == gains["computer"]["completion"]


def test_a_bound_is_said_to_be_one_and_nothing_beside_it_says_otherwise(inside, tmp_path):
    known = "schema_version: 1\nname: Two\ncomponents:\n  motor: {rate: 1e-4 /h}\n"
    (tmp_path / "robot.yaml").write_text(f"{known}  board: {{rate: unknown}}\n")
    text = inside("importance", "robot.yaml", "--within", "1000 h").stdout
    assert f"with at least {100 * -math.expm1(-0.1):.3f} %" in text  # whatever the board's rate is
    assert "what is stated is as if" not in text
    assert "a figure without 'at least' or 'at most' is as if it never fails, and may be more or less" in text


def test_what_is_a_bit_below_certain_is_not_called_certain(inside, tmp_path):
    parts = "motor: {rate: 1 /h}, lamp: {rate: 1e-5 /h}"
    (tmp_path / "robot.yaml").write_text(f"schema_version: 1\nname: Two\ncomponents: {{{parts}}}\n")
    text = inside("importance", "robot.yaml", "--within", "12 h").stdout
    assert f"with {100 * -math.expm1(-12 * (1 + 1e-5)):.4f} %" in text  # 99.9994 %
    assert "100 %" not in text


def test_ranked_and_cut(inside, robot):
    text = inside("importance", robot, "--by", "raw", "--most", "2").stdout
    assert "2 more are not listed" in text
    assert "1 more is not listed" in inside("importance", robot, "--most", "3").stdout
    said = json.loads(inside("importance", robot, "--by", "birnbaum", "--json").stdout)["importance"]["sensor_based"]
    births = [one["birnbaum"] for one in said["units"]]
    assert births == sorted(births, reverse=True)
    failed = inside("importance", robot, "--failed", "computer").stdout
    assert "has failed; no part matters more than another" in failed
    assert "computer" in failed.splitlines()[-2]


def test_a_lived_robot_in_both_views(inside, design, tmp_path):
    SyntheticOta(seed=3, duration=600 * SECOND).record(tmp_path / "day.mcap")
    inside("replay", design, tmp_path / "day.mcap", "--store", "past.db")
    text = inside("importance", design, "--store", "past.db", "--most", 3).stdout
    assert "sensor-based, given what is known now" in text
    assert "crit. nominal" in text
    said = json.loads(inside("importance", design, "--store", "past.db", "--json").stdout)
    assert set(said["importance"]) == set(said["replacement"]) == {"nominal", "sensor_based"}


def test_a_fault_tree(inside, tmp_path):
    """Printed in SCRAM's tests/risk_analysis_tests.cc, ImportanceDefault."""
    (tmp_path / "model.xml").write_text(TREE)
    said = json.loads(inside("importance", "model.xml", "--json").stdout)["importance"]["as_given"]
    found = {one["unit"]: one for one in said["units"]}
    assert found["PumpOne"]["birnbaum"] == pytest.approx(0.51, rel=1e-12)
    assert found["ValveTwo"]["criticality"] == pytest.approx(0.1765, abs=5.1e-5)
    assert found["PumpTwo"]["reduction"] == pytest.approx(1.7, rel=1e-12)
    assert "PumpOne" in inside("importance", "model.xml").stdout


def test_a_fault_tree_with_not(inside, tmp_path):
    (tmp_path / "not.xml").write_text(TREE.replace('<gate name="two"/>', '<not><gate name="two"/></not>'))
    text = inside("importance", "not.xml").stdout
    assert "-0.266" in text
    assert "No F–V: it is of minimal cut sets, which a tree with 'not' or 'xor' has none of" in text


def test_mistakes_are_one_line(inside, robot):
    for words, says in (
        (("importance", robot, "--by", "birnbum"), "did you mean 'birnbaum'?"),
        (("importance", robot, "--within", "0 h"), "--within 0 h: expected hours above 0"),
        (("importance", robot, "--within", "3 m"), "does not measure what 'h' does"),
        (("importance", robot, "--function", "mve"), "no function 'mve'; did you mean 'move'?"),
        (("importance", robot, "--failed", "moter[1]"), "did you mean 'motor[1]'?"),
    ):
        done = inside(*words)
        assert done.returncode == 3
        assert says in done.stderr
        assert done.stderr.count("\n") == 1
        assert done.stdout == ""
