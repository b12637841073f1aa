"""What decides a robot's health, against closed forms of exponential lives."""

import json
import math
import re
import subprocess
import sys

import numpy as np
import pytest

from robophm.design.file import load
from robophm.health.why import explain
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.replay import replay
from robophm.report.why import reasons, sentence

CASTERS, ELSE = 1e-3, 2e-4
DESIGN = """\
schema_version: 1
name: courier
components:
  casters:
    rate: 1e-3 /h
    acceleration: {model: q10, reference_temperature: 25 degC, q: 2}
    signals: {temperature: {topic: /casters, field: temperature, unit: degC}}
  computer: {rate: 2e-4 /h}
"""


@pytest.fixture
def hot(tmp_path):
    """A courier whose casters have been at 37 °C for a quarter of an hour."""
    (tmp_path / "robot.yaml").write_text(DESIGN)
    rows = "".join(f"{1_700_000_000 + t},37\n" for t in range(900))
    (tmp_path / "drive.csv").write_text(f"time,/casters.temperature\n{rows}")
    return tmp_path


def test_it_is_said_how_long_it_works_on_and_what_decides(hot):
    report = replay(load(hot / "robot.yaml"), hot / "drive.csv")
    found = explain(report)
    faster = 2**1.2
    rate = CASTERS * faster + ELSE
    assert found.works_for == pytest.approx(-math.log(0.9) / rate, rel=1e-6)
    assert found.median == pytest.approx(math.log(2) / rate, rel=1e-6)
    (casters,) = found.parts
    assert casters.share == pytest.approx(CASTERS * faster / rate, rel=1e-6)
    assert casters.pace == pytest.approx(faster, rel=1e-9)
    assert casters.relieved == pytest.approx(math.log(2) / (CASTERS + ELSE), rel=1e-6)
    (stress,) = casters.stresses
    assert (stress.observed, stress.designed, stress.unit) == (pytest.approx(37), 25, "degC")
    assert sentence(report, found) == (
        "Works on for 42.2 h with 90 %. casters decides it (92 % of the failures to come): "
        "37 °C, 2.3 times as fast as designed."
    )
    assert "  temperature 37 °C, designed for 25 °C (/casters.temperature)" in [*reasons(found)]


def test_rates_that_are_not_exactly_known_count(tmp_path):
    """One part of a lognormal rate about its mean: its survival is E exp(−θλt), by quadrature of its own."""
    (tmp_path / "robot.yaml").write_text(
        "schema_version: 1\nname: one\ncomponents:\n  motor: {rate: 1e-4 /h, uncertainty: {error_factor: 5}}\n"
    )
    report = Monitor(load(tmp_path / "robot.yaml")).report()
    found = explain(report)
    deviation = math.log(5) / 1.6448536269514722

    def survives(hours):
        z, weight = np.polynomial.hermite_e.hermegauss(100)
        ratio = np.exp(deviation * z - deviation**2 / 2)
        return float(weight @ np.exp(-ratio * 1e-4 * hours)) / math.sqrt(2 * math.pi)

    assert survives(found.works_for) == pytest.approx(0.9, abs=5e-4)
    assert found.works_for_at_stated_rates == pytest.approx(-math.log(0.9) / 1e-4, rel=1e-9)
    unsure = report.life_with_rates_unsure
    assert [survives(time) for time in unsure] == pytest.approx([0.95, 0.5, 0.05], abs=1e-3)
    words = sentence(report, found)
    assert re.match(r"Works on for 47\.\d days with 90 % \(43\.9 days if its rates were exactly as stated\)\.", words)


def test_a_robot_of_unknown_rates_alone_is_said_to_be_unknown(tmp_path):
    (tmp_path / "robot.yaml").write_text("schema_version: 1\nname: one\ncomponents:\n  motor: {rate: unknown}\n")
    report = Monitor(load(tmp_path / "robot.yaml")).report()
    assert sentence(report, explain(report)) == (
        "How long it works on is unknown, as is the rate of all that can fail: 1 part of unknown rate."
    )


def test_redundancy_is_no_cause(tmp_path):
    """One of two hot parts is enough: the single one decides, whatever their rates."""
    (tmp_path / "robot.yaml").write_text(
        "schema_version: 1\nname: pair\ndiagram: {series: [{parallel: [a, b]}, c]}\n"
        "components: {a: {rate: 5e-5 /h}, b: {rate: 5e-5 /h}, c: {rate: 2e-5 /h}}\nthresholds: {survival: 0.99}\n"
    )
    from robophm.monitoring.monitor import Monitor

    report = Monitor(load(tmp_path / "robot.yaml")).report(horizon=100.0)
    found = explain(report)
    assert found.chance == 0.99
    assert [part.path for part in found.parts] == ["c"]
    assert found.parts[0].relieved is None


def test_the_command_says_it(hot):
    def said(*words):
        command = [sys.executable, "-m", "robophm", "why", "robot.yaml", *words]
        return subprocess.run(command, cwd=hot, capture_output=True, text=True, check=False)

    new = said()
    assert new.returncode == 0, new.stderr
    assert new.stdout.startswith(
        "Works on for 3.66 days with 90 %. casters decides it (83.3 % of the failures to come)."
    )
    document = json.loads(said("--json").stdout)
    assert document["parts"][0]["share"] == pytest.approx(CASTERS / (CASTERS + ELSE), rel=1e-6)
    (hot / "robot.yaml").write_text(f"{DESIGN}thresholds: {{hazard_rate: 1e-6 /h}}\n")
    assert said().returncode == 1
    assert "hazard rate" in said().stdout
