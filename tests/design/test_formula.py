"""A user's own formula and the accelerations of a design, against the same by hand."""

import math

import numpy as np
import pytest

from robophm.core.errors import DesignError
from robophm.design.file import parse

HEAD = "schema_version: 1\nname: R\nusage: {cycles: 6 cycle/h}\n"
FORMULA = """
components:
  Pump:
    hazard:
      formula: base * exp(0.05 * (temperature - 25)) * max(1, pressure / 2) ** 3
      unit: FPMH
      source: own test, report 12
      variables:
        base: {value: 3}
        temperature: {value: 40 degC, unit: degC, range: [-20, 80]}
        pressure: {value: 600 kPa, unit: bar, range: [0, 10]}
"""


def modes(text):
    return {mode.path: mode for mode in parse(HEAD + text).modes}


def fault(text):
    with pytest.raises(DesignError) as caught:
        parse(HEAD + text)
    return str(caught.value)


def test_a_formula_is_a_hazard_rate_in_its_units():
    mode = modes(FORMULA)["Pump"]
    assert mode.rate == pytest.approx(3e-6 * math.exp(0.05 * 15) * 3**3, rel=1e-14)
    assert mode.source == "own test, report 12"
    assert mode.measured == ()


def test_its_variables_are_measured_as_any_input():
    mode = modes("signals: {temperature: {topic: /t, field: t, unit: degF, range: [0, 200]}}\n" + FORMULA.lstrip())[
        "Pump"
    ]
    (stress,) = mode.measured
    channel = stress.channels["temperature"]
    assert channel.scale * 104 + channel.offset == pytest.approx(40, rel=1e-12)
    factor, extrapolated = stress.factor({"temperature": np.array([40.0, 50.0, 81.0])})
    assert factor.tolist() == pytest.approx([1, math.exp(0.5), math.exp(0.05 * 41)], rel=1e-13)
    assert extrapolated.tolist() == [False, False, True]


def test_where_it_has_no_answer_live_the_rate_stays_and_is_flagged():
    mode = modes(
        "signals: {x: {topic: /x, field: x, range: [-9, 9]}}\ncomponents: {A: {hazard: "
        "{formula: sqrt(x), unit: FIT, source: s, variables: {x: {value: 4}}}}}"
    )["A"]
    factor, extrapolated = mode.stresses[0].factor({"x": np.array([9.0, -1.0])})
    assert factor.tolist() == [1.5, 1.0]
    assert extrapolated.tolist() == [False, True]


def test_two_formulas_are_two():
    text = "{{hazard: {{formula: {}, unit: FIT, source: s, variables: {{x: {{value: 2{}}}}}}}}}"
    found = modes(
        "components:\n" + "".join(f"  {name}: {text.format(formula, more)}\n" for name, formula, more in [
            ("A", "x * 3", ""), ("B", "x ** 3", ""), ("C", "x * 3", ", range: [1, 3]"), ("D", "x * 3", ""),
        ])
    )  # fmt: skip
    keys = {name: mode.stresses[0].key for name, mode in found.items()}
    assert keys["A"] == keys["D"]
    assert len(set(keys.values())) == 3
    assert found["B"].rate == pytest.approx(8e-9, rel=1e-15)


@pytest.mark.parametrize(
    ("unit", "clock", "rate"),
    [
        ("1/h", "operating", 5.0),
        ("FPMH", "calendar", 5e-6),
        ("1/cycle", "cycles", 5.0),
        ("/10^6 cycle", "cycles", 5e-6),
    ],
)
def test_the_unit_of_its_result(unit, clock, rate):
    part = f"{{clock: {clock}, hazard: {{formula: 2 + 3, unit: {unit}, source: s}}}}"
    assert modes(f"components: {{A: {part}}}")["A"].rate == pytest.approx(rate, rel=1e-15)


def given(**changes):
    said = {"formula": "x + 1", "unit": "FIT", "source": "s", "variables": "{x: {value: 1}}"} | changes
    return "components: {A: {hazard: {" + ", ".join(f"{k}: {v}" for k, v in said.items() if v) + "}}}"


FAULTS = {
    "both": (given(model="general.constant"), "components/A/hazard: expected either model or formula"),
    "neither": ("components: {A: {hazard: {inputs: {}}}}", "components/A/hazard: expected either model or formula"),
    "no unit": (given(unit=""), "components/A/hazard: a formula needs its unit and source"),
    "no source": (given(source=""), "components/A/hazard: a formula needs its unit and source"),
    "inputs": (given(inputs="{x: 1}"), "a formula needs its unit and source, and has variables in place of inputs"),
    "model with a source": (
        "components: {A: {hazard: {model: general.constant, source: x}}}",
        "a model has inputs; unit, variables and source are of a formula",
    ),
    "unknown variable": (given(formula="x + temprature", variables="{x: {value: 1}, temperature: {value: 1}}"),
                         "hazard/formula: formula, character 5: no variable or function 'temprature'; did you"),
    "unused": (given(variables="{x: {value: 1}, y: {value: 1}}"), "formula does not use its variable 'y'"),
    "bad name": (given(variables="{x: {value: 1}, exp: {value: 1}}"), "'exp' cannot be a variable"),
    "hostile": (given(formula="'__import__(1)'"), "hazard/formula: formula, character 1: no variable or function '"),
    "tower": (given(formula="9**9**9 * x"), "components/A/hazard: hazard rate inf; expected a number"),
    "no number": (given(formula="log(x - 2)"), "components/A/hazard: hazard rate nan; expected a number"),
    "negative": (given(formula="x - 2"), "components/A/hazard: hazard rate -1e-09; expected above zero"),
    "a unit that is none": (given(unit="blob"), "hazard/unit: unit 'blob' does not measure what '1/h' does"),
    "a unit of another kind": (given(unit="V"), "hazard/unit: unit 'V' does not measure what '1/h' does"),
    "a unit of another clock": (given(unit="1/cycle"), "hazard/unit: unit '1/cycle' does not measure what '1/h' does"),
    "a variable's unit": (given(variables="{x: {value: 1 V, unit: volts7}}"), "hazard/variables/x/unit: '"),
    "a value of another unit": (given(variables="{x: {value: 1 V, unit: A}}"), "x: formula: x: unit 'V' does"),
    "a value without unit": (given(variables="{x: {value: 1, unit: A}}"), "variables/x: formula: x: '1' has no unit"),
    "a value out of range": (given(variables="{x: {value: 1, range: [2, 3]}}"), "formula: x 1 is outside 2 … 3"),
    "a range upside down": (given(variables="{x: {value: 1, range: [3, 2]}}"), "range [3.0, 2.0] does not ascend"),
    "a formula that is a number": (given(formula="5", variables=""), "components/A/hazard/formula: "),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_what_is_wrong_is_said_with_its_place(name):
    text, expected = FAULTS[name]
    said = fault(text)
    assert expected in said
    assert "\n" not in said


def test_two_measured_stresses_of_one_acceleration():
    text = """
signals:
  humidity: {topic: /h, field: h, unit: percent, range: [0, 100]}
  temperature: {topic: /t, field: t, unit: degC, range: [-20, 90]}
components:
  A: {rate: 10 FIT, acceleration: {model: peck, reference_humidity: 50 %, reference_temperature: 40 degC}}
"""
    (stress,) = modes(text)["A"].measured
    assert set(stress.channels) == {"humidity", "temperature"}
    expected = (80 / 50) ** 2.66 * math.exp(0.79 / 8.617333e-5 * (1 / 313.15 - 1 / 333.15))
    assert stress.factor({"humidity": 80.0, "temperature": 60.0}).value == pytest.approx(expected, rel=1e-13)
    assert stress.reference == 1


def test_coffin_manson_is_of_cycles():
    of = "acceleration: {model: coffin_manson, reference_temperature_swing: 40 K, exponent: 2}"
    bound = "signals: {temperature_swing: {topic: /s, field: s, unit: K, range: [0, 200]}}\n"
    (stress,) = modes(bound + f"components: {{A: {{rate: 1e-6 /cycle, clock: cycles, {of}}}}}")["A"].measured
    assert stress.factor({"temperature_swing": 80.0}).value == pytest.approx(4, rel=1e-15)
    said = fault(f"components: {{A: {{rate: 1 FIT, {of}}}}}")
    assert "coffin_manson is of cycles, but its clock is 'operating'; expected cycles or starts" in said


@pytest.mark.parametrize(
    ("acceleration", "expected"),
    [
        ("{model: peck}", "peck needs 'reference_humidity', at which the stated rate holds"),
        ("{model: peck, humidity: 50 %}", "'humidity' is what is measured; expected reference_humidity here"),
        ("{model: peck, reference_humidity: 50 %, temperature: 40 degC}", "'temperature' is what is measured"),
        (
            "[{model: peck, reference_humidity: 50 %}, {model: q10}]",
            "double acceleration: two factors of 'temperature'",
        ),
        ("{model: eyring}", "eyring needs the input 'activation_energy'"),
    ],
)
def test_accelerations_that_are_not_taken(acceleration, expected):
    assert expected in fault(f"components: {{A: {{rate: 1 FIT, acceleration: {acceleration}}}}}")


def test_a_b10_and_a_life_are_of_one_shape():
    text = "components: {{A: {{hazard: {{model: general.b10, inputs: {{b10: 1000 h, source: s{}}}}}{}}}}}"
    weibull = ", life: {distribution: weibull, shape: 2.5}"
    life = modes(text.format(", shape: 2.5", weibull))["A"].life
    assert life.cumulative_hazard(1000.0) == pytest.approx(-math.log(0.9), rel=1e-12)
    assert modes(text.format("", ""))["A"].life.cumulative_hazard(1000.0) == pytest.approx(-math.log(0.9), rel=1e-12)
    for shape, said in (("", weibull), (", shape: 2.5", ""), (", shape: 2", weibull)):
        assert "by which the mean follows from the B10" in fault(text.format(shape, said))
