"""MIL-HDBK-217F Notice 2 §6.4, §6.8 and §6.9: Appendix A and the printed formulas."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks.mil_hdbk_217f import (
    transistor_fet_high_frequency,
    transistor_fet_low_frequency,
    transistor_gaas_fet,
)
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import ENVIRONMENT, QUALITY, RF_ENVIRONMENT, RF_QUALITY

DATA = Path(__file__).parents[3] / "data" / "transistor_fet.json"
CASES = json.loads(DATA.read_text(encoding="utf-8"))["cases"]
PLAIN = {
    "kind": "MOSFET",
    "application": "switching",
    "temperature": "25 degC",
    "power": "0 W",
    "rated_power": "0.5 W",
    "environment": "GB",
}
GAAS = {
    "frequency": "5 GHz",
    "output_power": "1 W",
    "temperature": "25 degC",
    "power": "0 W",
    "application": "cw",
    "matching": "none",
    "environment": "GB",
}


@pytest.fixture
def fet(section):
    return section("transistor_fet_low_frequency")


@pytest.fixture
def gaas(section):
    return section("transistor_gaas_fet")


@pytest.fixture
def high_frequency(section):
    return section("transistor_fet_high_frequency")


def written(published):
    """The inputs of a published case as a user writes them; a name that is not known fails."""
    gallium = "piM" in published
    # Appendix A's silicon is a small-signal switch, which the case does not say
    given = {"power": "0 W"} if gallium else {"power": "0 W", "rated_power": "0.5 W"}
    for name, value in published.items():
        match name:
            case "fet":
                given["kind"] = value
            case "TJ_C":
                given["temperature"] = f"{value} degC"
            case "F_GHz":
                given["frequency"] = f"{value} GHz"
            case "P_W":
                given["output_power"] = f"{value} W"
            case "piM":
                given["matching"] = next(w for w, number in transistor_gaas_fet.MATCHING.items() if number == value)
            case "piQ":
                table = RF_QUALITY if gallium else QUALITY
                given["quality"] = next(word for word, number in table.items() if number == value)
            case "application" | "environment":
                given[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return given


def test_the_cases_are_all_there(carried):
    assert carried("transistor_fet", "6.4", "6.8", "6.9") == len(CASES) == 11


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published_rates(case, fet, gaas, agrees):
    part = {"6.4": fet, "6.8": gaas}[case["section"]]
    agrees(case, part.rate(written(case["inputs"])))


def test_worked_by_hand(fet, gaas, high_frequency):
    """A power MOSFET of 50 W as a switch; a GaAs FET; a JFET of high frequency: TJ = 40 + 0.5 · 70 = 75 °C."""
    heat = {"temperature": "40 degC", "power": "0.5 W", "environment": "GM"}
    inputs = {**PLAIN, **heat, "rated_power": "50 W"}
    pi_t = math.exp(1925 * (1 / 298 - 1 / 348))
    assert fet.rate(inputs) == pytest.approx(0.012 * pi_t * 8 * 8 * 9, rel=1e-14)
    inputs = {"kind": "jfet", **heat}
    assert high_frequency.rate(inputs) == pytest.approx(0.023 * pi_t * 5 * 5, rel=1e-14)
    inputs = {**GAAS, **heat, "frequency": "8000 MHz", "output_power": "2 W"}
    base = 0.0093 * math.exp(0.429 * 8 + 0.486 * 2)
    expected = base * math.exp(4485 * (1 / 298 - 1 / 348)) * 4 * 4 * 5 * 5
    assert gaas.rate(inputs) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("application", ["linear", "switching"])
@pytest.mark.parametrize(
    ("watts", "expected"),
    [(0.1, None), (1.999, None), (2, 2), (4.99, 2), (5, 4), (49.9, 4), (50, 8), (249, 8), (250, 10), (1000, 10)],
)
def test_from_2_watts_on_only_the_power_counts(application, watts, expected, fet):
    """A switch of 50 W at 0.7 would be 11.4 times too low."""
    found = fet.factors({**PLAIN, "application": application, "rated_power": f"{watts} W"})["πA"]
    assert found == (expected or {"linear": 1.5, "switching": 0.7}[application])


def test_the_mosfet_of_high_frequency_is_not_ten_times_worse(high_frequency):
    """The 2020 tool has 0.6 for 0.060."""
    assert high_frequency.factors({**PLAIN_HIGH, "kind": "MOSFET"})["λb"] == 0.060
    assert high_frequency.factors({**PLAIN_HIGH, "kind": "JFET"})["λb"] == 0.023


PLAIN_HIGH = {"kind": "MOSFET", "temperature": "25 degC", "power": "0 W", "environment": "GB"}


@pytest.mark.parametrize(
    ("gigahertz", "watts", "expected"),
    [
        (1, 0.05, 0.052),
        (10, 0.0999, 0.052),
        (4, 0.1, 0.0093 * math.exp(0.429 * 4 + 0.486 * 0.1)),
        (10, 6, 0.0093 * math.exp(0.429 * 10 + 0.486 * 6)),
    ],
)
def test_the_two_bases_of_gallium_arsenide(gigahertz, watts, expected, gaas):
    found = gaas.factors({**GAAS, "frequency": f"{gigahertz} GHz", "output_power": f"{watts} W"})["λb"]
    assert found == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("gigahertz", "watts", "message"),
    [
        (3.9, 0.1, "λb is outside the handbook's range: .*no model from 0.1 W on below 4 GHz"),
        (1, 6, "λb is outside"),
        (10.1, 0.05, "frequency 10.1 GHz is outside"),
        (0.9, 0.05, "frequency 0.9 GHz is outside"),
        (5, 6.1, "output_power 6.1 W is outside"),
    ],
)
def test_where_gallium_arsenide_has_no_model(gigahertz, watts, message, gaas):
    with pytest.raises(ModelError, match=message):
        gaas.rate({**GAAS, "frequency": f"{gigahertz} GHz", "output_power": f"{watts} W"})


def test_a_missing_model_is_flagged_live(gaas):
    design = gaas.model.settle({**GAAS, "frequency": "2 GHz", "output_power": "0.05 W"})
    value, extrapolated = gaas.model.evaluate({**design, "output_power": np.array([0.05, 0.09, 0.1, 1.0])})
    assert extrapolated.tolist() == [False, False, True, True]
    assert np.all(value > 0)


def test_the_tables_agree_row_by_row(second, fet, gaas, high_frequency):
    table = second("transistors")
    low, gallium, high = table["6.4_fet_lf"], table["6.8_gaas_fet"], table["6.9_rf_si_fet"]
    assert dict(transistor_fet_low_frequency.KIND) == low["lambda_b"]
    assert dict(QUALITY) == low["piQ"]
    assert dict(ENVIRONMENT) == low["piE"]
    ours = [*transistor_fet_low_frequency.APPLICATION.values(), *transistor_fet_low_frequency.POWER.values()]
    assert ours == list(low["piA"].values())
    assert dict(transistor_fet_high_frequency.KIND) == high["lambda_b"]
    assert dict(RF_QUALITY) == high["piQ"] == gallium["piQ"]
    assert dict(RF_ENVIRONMENT) == high["piE"]
    assert dict(transistor_gaas_fet.ENVIRONMENT) == gallium["piE"]
    assert dict(transistor_gaas_fet.APPLICATION) == {
        "low_power_or_pulsed": gallium["piA"]["low_power_or_pulsed"],
        "cw": gallium["piA"]["cw"],
    }
    assert dict(transistor_gaas_fet.MATCHING) == gallium["piM"]
    for part, inputs, row in ((fet, PLAIN, low), (gaas, GAAS, gallium), (high_frequency, PLAIN_HIGH, high)):
        found = part.factors(inputs, temperature=100.0)["πT"]
        assert found == pytest.approx(math.exp(-row["B"] * (1 / 373 - 1 / 298)), rel=1e-14)
