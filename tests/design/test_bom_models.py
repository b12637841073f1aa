"""Every kind that has a model is rated by it: the inputs are the model's own, the rate is the handbook's by hand."""

import math

import numpy as np
import pytest

from robophm.design.bom.models import MODELS, Assumptions, Rater, TooLittle, rates
from robophm.design.bom.parts import KINDS, PREFIXES, Recognised
from robophm.hazard.handbooks import handbook_model, handbook_models

FACTS = {
    "capacitance": "100 nF",
    "type": "ceramic",
    "rated_voltage": "50 V",
    "rated_power": "0.1 W",
    "mounting": "surface",
    "frequency": "8 MHz",
    "pins": "8",
}
NEVER = {
    "connector",
    "relay",
    "switch",
    "thermistor",
    "potentiometer",
    "transformer",
    "bipolar transistor",
    "fet",
    "thyristor",
    "microcircuit",
    "transistor",
}
"""Kinds whose models ask for what no parts list says."""

ARRHENIUS = math.exp(-0.35 / 8.617e-5 * (1 / 313 - 1 / 298))
RATES = {  # failures/10⁶ h in GM at commercial or lower quality and 40 °C, by the printed tables
    "crystal": 0.013 * 8**0.23 * 2.1 * 10,
    "fuse": 0.010 * 8,
    "capacitor": 0.0020 * ARRHENIUS * 0.1**0.09 * ((0.5 / 0.6) ** 3 + 1) * 10 * 20,
}


def test_kinds_are_kinds():
    assert set(MODELS) <= set(KINDS)
    assert {kind for kinds in PREFIXES.values() for kind in kinds} <= set(KINDS)


@pytest.mark.parametrize("kind", MODELS)
def test_every_model_takes_what_it_is_given(kind):
    model = MODELS[kind][0]
    if model not in handbook_models():
        pytest.skip(f"no model {model} yet")
    part = Recognised(kind, FACTS)
    if kind in NEVER:
        with pytest.raises(TooLittle, match="the list does not say"):
            Rater(Assumptions()).rating(part)
        return
    rating = Rater(Assumptions()).rating(part)
    rate = rates([rating])[0]
    settled = handbook_model(model).settle({**rating.inputs, "environment": "GM"})
    assert rate == handbook_model(model).evaluate(settled).value
    assert 1e-13 < rate < 1e-3
    if kind in RATES:
        assert rate == pytest.approx(RATES[kind] * 1e-6, rel=1e-12)
    for name in ("temperature", "dc_voltage", "voltage", "power"):
        if name in rating.inputs and rating.inputs[name] != "0 W":
            assert any(text.startswith(name) for text in rating.assumed), name


@pytest.mark.parametrize(
    ("kind", "facts", "words"),
    [
        ("capacitor", {"capacitance": "1 uF"}, "whether it is ceramic, electrolytic, tantalum or film"),
        ("capacitor", {"type": "ceramic"}, "the list does not say its capacitance"),
        ("capacitor", {"type": "polymer", "capacitance": "1 uF"}, "the handbook has no polymer capacitors"),
        ("capacitor", {"type": "ceramic", "capacitance": "9 F"}, "capacitance 9e+06 uF is outside"),
        ("supercapacitor", {"capacitance": "1 F"}, "there is no model of a supercapacitor"),
        ("no part", {}, "it is no electrical part"),
        ("", {}, "is not clear"),
    ],
)
def test_too_little(kind, facts, words):
    with pytest.raises(TooLittle) as raised:
        Rater(Assumptions()).rating(Recognised(kind, facts))
    assert words in str(raised.value)


def test_a_quality_that_a_model_does_not_know_is_its_default_and_said():
    rater = Rater(Assumptions(quality="M"))
    assert rater.rating(Recognised("capacitor", FACTS)).inputs["quality"] == "M"
    rater.assumed = Assumptions(quality="JANTX")  # of semiconductors alone
    rating = rater.rating(Recognised("capacitor", FACTS))
    assert "quality" not in rating.inputs
    assert "quality commercial: this model knows no JANTX" in rating.assumed


def test_parts_rated_together_are_rated_as_each_alone():
    rater = Rater(Assumptions())
    parts = [
        rater.rating(
            Recognised("capacitor", {**FACTS, "type": kind, "capacitance": f"{n} nF", "rated_voltage": f"{n} V"})
        )
        for n in range(1, 40)
        for kind in ("ceramic", "electrolytic", "tantalum", "film")
    ]
    together = rates(parts)
    np.testing.assert_allclose(together, [rates([one])[0] for one in parts], rtol=1e-14)
    assert rates([]).shape == (0,)


@pytest.mark.parametrize(
    ("kind", "inputs"),
    [
        ("resistor", {"style": "RM", "power": "0.05 W", "rated_power": "0.1 W", "temperature": "40 degC"}),
        ("resistor network", {"style": "RZ"}),
        ("diode", {"kind": "general_purpose_analog", "temperature": "50 degC", "power": "0 W", "voltage": "25 V"}),
        ("schottky diode", {"kind": "power_rectifier_schottky", "rated_voltage": "50 V"}),
        ("zener diode", {"kind": "voltage_regulator_zener", "voltage": None}),
        ("led", {"kind": "led", "temperature": "50 degC"}),
        ("inductor", {"kind": "fixed", "temperature": "40 degC", "temperature_rise": "10 K"}),
    ],
)
def test_inputs(kind, inputs):
    made = Rater(Assumptions()).rating(Recognised(kind, FACTS)).inputs
    assert {name: made.get(name) for name in inputs} == inputs
