"""Every kind is rated by its model: inputs are the model's own, what is assumed is said, rates are the handbook's."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from tests.cases import each_case

from robophm.design.importers.bom.assumptions import OF_ALL, Assumptions, TooLittle
from robophm.design.importers.bom.kinds import KINDS, OTHER, PREFIXES
from robophm.design.importers.bom.models import Rater, rates
from robophm.design.importers.bom.parts import TYPES, Recognised
from robophm.design.importers.bom.rules import RULES
from robophm.hazard.environments import ENVIRONMENTS
from robophm.hazard.handbooks import handbook_model

APPENDIX = json.loads((Path(__file__).parents[3] / "data" / "appendix_a_semiconductors.json").read_text())
JUNCTION = APPENDIX["junction_temperature"]
FACTS = {
    "capacitance": "100 nF",
    "type": "ceramic",
    "rated_voltage": "50 V",
    "rated_power": "0.1 W",
    "mounting": "surface",
    "frequency": "8 MHz",
    "pins": "8",
}
IN_NO_HANDBOOK = {*OTHER, "liquid crystal or OLED display", "supercapacitor", "buzzer", "antenna"}
SAID_BY_THE_KIND = {"schottky diode", "zener diode", "tvs diode", "varistor", "led"}
ASKED_FOR = {
    "capacitor": {"capacitance": "100 nF"},
    "printed board": {"holes": "300"},
    "encoder": {"type": "with contacts"},
}
"""Without which no rate is given; of all other kinds nothing needs to be known."""

ARRHENIUS = math.exp(-0.35 / 8.617e-5 * (1 / 313 - 1 / 298))
RATES = {  # failures/10⁶ h in GM at commercial or lower quality and 40 °C, by the printed tables
    "crystal": 0.013 * 8**0.23 * 2.1 * 10,
    "fuse": 0.010 * 8,
    "capacitor": 0.0020 * ARRHENIUS * 0.1**0.09 * ((0.5 / 0.6) ** 3 + 1) * 10 * 20,
}


def rated(kind, facts, assumptions=None):
    return Rater(assumptions or Assumptions()).rating(Recognised(kind, facts))


def test_kinds_are_kinds():
    assert set(KINDS) - set(RULES) - {"sensor chip"} == IN_NO_HANDBOOK  # that the library has
    assert set(RULES) < set(KINDS)
    assert set(TYPES) < set(KINDS)
    assert {kind for kinds in PREFIXES.values() for kind in kinds} <= set(KINDS)


@each_case("kind", RULES)
def test_every_kind_is_rated_and_all_that_is_assumed_is_said(kind):
    """Of which nothing but its kind is known: each input has its reason, and the model takes them all."""
    rating = rated(kind, ASKED_FOR.get(kind, {}))
    own = {"kind"} if kind in SAID_BY_THE_KIND else set()
    known = {"capacitance"} if kind == "capacitor" else {"automated_holes"} if kind == "printed board" else own
    assert set(rating.inputs) - set(rating.assumed) == known
    assert all(rating.assumed.values())
    assert set(rating.assumed) - set(rating.inputs) <= {"model"}
    model = handbook_model(rating.model)
    environment = {"environment": "GM"} if "environment" in model.inputs else {}
    rate = rates([rating])[0]
    assert rate == model.evaluate(model.settle({**rating.inputs, **environment})).value
    assert 1e-13 < rate < 1e-3


@each_case("environment", ENVIRONMENTS)
def test_every_kind_is_rated_in_every_environment_that_its_section_has(environment):
    rater = Rater(Assumptions(environment=environment))
    for kind, rule in RULES.items():
        part = Recognised(kind, FACTS | ASKED_FOR.get(kind, {}))
        model = handbook_model(rule.model)
        if "environment" in model.inputs and environment not in model.inputs["environment"].options:
            with pytest.raises(TooLittle, match=f"environment '{environment}' is not one of its choices"):
                rater.rating(part)
        else:
            assert rates([rater.rating(part)])[0] > 0, kind


@each_case("kind", RATES)
def test_rates_by_hand(kind):
    assert rates([rated(kind, FACTS)])[0] == pytest.approx(RATES[kind] * 1e-6, rel=1e-12)


@each_case("environment", ["GB", "GF", "GM", "AIF", "MF"])
@each_case(
    ("kind", "facts", "row", "stress", "quality"),
    [
        ("diode", {}, "diode-general", 0.7, "JANTX"),
        ("diode", {"type": "switching"}, "diode-switching", 0.7, "JANTX"),
        ("rectifier", {}, "diode-power-rectifier", 0.7, "JANTX"),
        ("tvs diode", {}, "diode-transient-suppressor", 0.7, "JANTX"),
        ("bipolar transistor", {}, "bjt-small-signal", 0.5, "JANTX"),
        ("fet", {}, "fet-silicon-lf", 0.5, "JANTX"),
        ("thermistor", {}, "resistor-rth", 0.5, "M"),
        ("resistor", {"type": "carbon composition"}, "resistor-rcr", 0.5, "M"),
        ("resistor", {}, "resistor-rlr", 0.5, "M"),
        ("capacitor", {"capacitance": "2 uF", "type": "ceramic"}, "capacitor-cdr", 0.4, "M"),
        ("capacitor", {"capacitance": "2 uF", "type": "ceramic", "mounting": "through hole"}, "capacitor-ck", 0.4, "M"),
        ("transformer", {}, "transformer-power", 0.5, "MIL-SPEC"),
        ("transformer", {"type": "audio"}, "transformer-audio", 0.5, "MIL-SPEC"),
        ("relay", {}, "relay-general", 0.5, "M"),
        ("switch", {"type": "toggle"}, "switch-toggle", 0.0, "MIL-SPEC"),
        ("circuit breaker", {}, "circuit-breaker", 0.5, "MIL-SPEC"),
        ("connector", {"type": "circular"}, "connector-circular", 0.5, "MIL-SPEC"),
        ("connector", {"type": "card edge"}, "connector-card-edge", 0.5, "MIL-SPEC"),
        ("socket", {}, "socket-ic", 0.5, "lower"),
        ("fuse", {}, "fuse", 0.5, None),
    ],
)  # fmt: skip
def test_what_is_assumed_gives_what_the_handbook_prints_for_parts_of_which_nothing_is_known(
    kind, facts, row, stress, quality, environment
):
    """Appendix A's generic rates, at its own temperatures: 20 °C less around a part than at a junction."""
    warm = JUNCTION[environment] - (0 if row.startswith(("diode", "bjt", "fet")) else 20)
    found = rated(kind, facts, Assumptions(f"{warm} degC", stress, "0 K", environment, quality))
    count = handbook_model("mil_hdbk_217f.parts_count")
    printed = count.evaluate(count.settle({"part": row, "quality_factor": 1, "environment": environment})).value
    assert rates([found])[0] == pytest.approx(printed, rel=0.065)  # two digits are printed


@each_case("environment", ["GB", "GM", "NS"])
@each_case(
    ("kind", "row", "facts"),
    [
        ("thyristor", "thyristor", {}),
        ("photodetector", "opto_phototransistor", {}),
        ("optocoupler", "opto_isolator_phototransistor_single", {}),
        ("led", "opto_led", {}),
        ("display", "display", {"characters": "7"}),
    ],
)
def test_other_semiconductors_are_as_printed_too(kind, row, facts, environment):
    if environment in APPENDIX["rows"][row]["disputed"]:
        return
    assumptions = Assumptions(f"{JUNCTION[environment]} degC", 0.7, "0 K", environment, "JANTX")
    printed = APPENDIX["rows"][row]["rates"][environment] * 1e-6
    assert rates([rated(kind, facts, assumptions)])[0] == pytest.approx(printed, **APPENDIX["tolerance"])


@each_case(
    ("kind", "facts", "words"),
    [
        ("encoder", {}, "the list does not say that it has contacts"),
        ("capacitor", {"type": "ceramic"}, "the list does not say its capacitance"),
        ("capacitor", {"type": "polymer", "capacitance": "1 uF"}, "the handbook has no polymer capacitors"),
        ("capacitor", {"type": "ceramic", "capacitance": "9 F"}, "capacitance 9000000 uF is outside"),
        ("supercapacitor", {"capacitance": "1 F"}, "no handbook has a model of a supercapacitor"),
        ("printed board", {}, "the list does not say how many plated holes it has"),
        ("", {}, "is not clear"),
    ],
)
def test_too_little(kind, facts, words):
    with pytest.raises(TooLittle) as raised:
        rated(kind, facts)
    assert words in str(raised.value)


def test_a_quality_that_a_model_does_not_know_is_its_default_and_said():
    assert rated("capacitor", FACTS, Assumptions(quality="M")).inputs["quality"] == "M"
    rating = rated("capacitor", FACTS, Assumptions(quality="JANTX"))  # of semiconductors alone
    assert (rating.inputs["quality"], rating.assumed["quality"]) == ("commercial", "this model knows no JANTX")


def test_what_the_list_says_is_not_assumed():
    rating = rated("capacitor", FACTS)
    assert rating.assumed.keys() == {"style", "dc_voltage", "temperature"}
    concluded = Rater(Assumptions()).rating(Recognised("resistor", FACTS, {"rated_power": "by its size 0603"}))
    assert concluded.assumed["rated_power"] == "by its size 0603"


def test_parts_rated_together_are_rated_as_each_alone():
    rater = Rater(Assumptions())
    parts = [
        rater.rating(
            Recognised("capacitor", {**FACTS, "type": kind, "capacitance": f"{n} nF", "rated_voltage": f"{n} V"})
        )
        for n in range(1, 40)
        for kind in ("ceramic", "electrolytic", "tantalum", "film")
    ] + [rater.rating(Recognised(kind, ASKED_FOR.get(kind, {}))) for kind in RULES]
    together = rates(parts)
    np.testing.assert_allclose(together, [rates([one])[0] for one in parts], rtol=1e-14)
    assert rates([]).shape == (0,)


@each_case(
    ("kind", "more", "inputs"),
    [
        ("resistor", {}, {"style": "RM", "power": "0.05 W", "rated_power": "0.1 W", "temperature": "40 degC"}),
        ("resistor network", {}, {"style": "RZ"}),
        ("diode", {}, {"kind": "general_purpose_analog", "temperature": "50 degC", "power": "0 W", "voltage": "25 V"}),
        ("schottky diode", {}, {"kind": "power_rectifier_schottky", "rated_voltage": "50 V"}),
        ("zener diode", {}, {"kind": "voltage_regulator_zener", "voltage": None}),
        ("led", {}, {"kind": "led", "temperature": "50 degC"}),
        ("inductor", {}, {"kind": "fixed", "temperature": "40 degC", "temperature_rise": "10 K"}),
        ("fet", {"type": "JFET"}, {"kind": "JFET", "rated_power": "0.1 W"}),
        (
            "relay",
            {"type": "reed", "contact_form": "DPDT"},
            {"construction": "signal-dry-reed", "contact_form": "DPDT"},
        ),
        ("relay", {"rated_current": "10 A"}, {"load_current": "5 A", "rated_current": "10 A"}),
        ("switch", {"type": "rocker"}, {"style": "rocker"}),
        ("connector", {"type": "radio frequency"}, {"style": "rf-coaxial", "current": None, "wire_gauge": None}),
        ("microcontroller", {"bits": "8 bit", "pins": "28"}, {"bits": "8 bit", "pins": "28", "family": "CMOS"}),
        ("microcontroller", {"pins": "400"}, {"pins": "400"}),
        ("memory", {"bits": "262144 bit"}, {"bits": "262144 bit", "style": "MOS-EEPROM-flotox"}),
        ("memory", {"bits": "134217728 bit", "type": "DRAM"}, {"bits": "134217728 bit", "programming_cycles": None}),
        ("battery", {"type": "primary"}, {"chemistry": "primary"}),
        ("motor", {"type": "stepper"}, {"kind": "stepper", "design_life": "10000 h"}),
        ("oscillator", {"frequency": "125 MHz"}, {"frequency": "105 MHz"}),
        ("capacitor", {"type": None, "capacitance": "10 uF"}, {"style": "CE"}),
        ("capacitor", {"type": None}, {"style": "CDR"}),
    ],
)
def test_inputs(kind, more, inputs):
    facts = {name: text for name, text in (FACTS | more).items() if text}
    made = rated(kind, facts).inputs
    assert {name: made.get(name) for name in inputs} == inputs


@each_case("kind", RULES)
def test_what_is_assumed_of_all_parts_is_what_the_wishes_change(kind):
    """And nothing else is: what a report may leave out beside each kind, it says once."""
    facts = ASKED_FOR.get(kind, {})
    usual, other = rated(kind, facts), rated(kind, facts, Assumptions("55 degC", 0.3, "15 K"))
    changed = {name for name in usual.inputs if usual.inputs[name] != other.inputs[name]}
    assert changed <= OF_ALL & set(usual.assumed)
    assert {name for name in OF_ALL & set(usual.assumed) if usual.inputs[name] != "0 W"} <= changed | {"quality"}


def test_what_is_taken_for_another_kind_says_so():
    assert rated("transistor", {}).assumed["model"] == "taken for a field-effect transistor"
    assert "without its circuit" in rated("oscillator", {}).assumed["model"]
