"""What the 2020 tool answered for relays, connectors, sockets, crystals and fuses: the same where it is right."""

import json

import pytest

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model

RELAY, CONNECTOR, SOCKET, CRYSTAL, FUSE = (
    handbook_model(f"mil_hdbk_217f.{name}") for name in ("relay", "connector", "connector_socket", "crystal", "fuse")
)
SWITCHED = {
    "construction": "general-armature-long", "rated_temperature": "125 degC", "temperature": "25 degC",
    "load": "resistive", "load_current": "0 A", "rated_current": "1 A", "contact_form": "SPST",
    "cycling": "1 cycle/h", "environment": "GB",
}  # fmt: skip
WIRED = {"style": "circular", "current": "0 A", "wire_gauge": "22", "matings": "0 /10^3 h", "environment": "GB"}


@pytest.fixture(scope="module")
def original(shared):
    cases = json.loads((shared / "cases" / "handbook_original_tool.json").read_text())["cases"]
    return {case["name"]: case for case in cases}


@pytest.mark.parametrize(
    ("name", "model", "symbol", "inputs"),
    [
        ("phm_xtal_5MHz", CRYSTAL, "λb", {"frequency": "5 MHz", "environment": "GB"}),
        ("phm_sock_piP_5", SOCKET, "πP", {"style": "IC", "contacts": 5, "environment": "GB"}),
        ("phm_conn_piT_35", CONNECTOR, "πT", {**WIRED, "temperature": "35 degC"}),
        ("phm_relay_lb_85_35", RELAY, "λb", {**SWITCHED, "rated_temperature": "85", "temperature": "35 degC"}),
        ("phm_relay_lb_125_35", RELAY, "λb", {**SWITCHED, "temperature": "35 degC"}),
        ("phm_relay_piCYC_mil_10", RELAY, "πCYC", {**SWITCHED, "quality": "M", "cycling": "10 cycle/h"}),
        ("phm_relay_piCYC_mil_.1", RELAY, "πCYC", {**SWITCHED, "quality": "M", "cycling": "0.1 cycle/h"}),
        ("phm_relay_piCYC_com_1500", RELAY, "πCYC", {**SWITCHED, "cycling": "1500 cycle/h"}),
        ("phm_relay_piCYC_com_150", RELAY, "πCYC", {**SWITCHED, "cycling": "150 cycle/h"}),
        ("phm_relay_piCYC_com_5", RELAY, "πCYC", {**SWITCHED, "cycling": "5 cycle/h"}),
    ],
)
def test_where_it_is_right(name, model, symbol, inputs, original, factors):
    case = original[name]
    assert case["verdict"] == "agrees with handbook"
    expected = pytest.approx(case["expected"]["value"], abs=case["tolerance"]["abs"])
    assert factors(model, model.settle(inputs))[symbol] == expected


def test_a_relay_of_ten_times_its_rated_current_has_no_answer(original):
    """It gave πL = (S/d)² + 1 = 157 for S = 10."""
    assert original["phm_relay_piL_S10"]["verdict"].startswith("CONFLICT")
    with pytest.raises(ModelError, match="πL is outside the handbook's range"):
        RELAY.settle({**SWITCHED, "load_current": "10 A"})


@pytest.mark.parametrize(
    ("name", "frequency", "environment"),
    [
        ("paper_t17_xtal_32.768kHz", "32.768 kHz", "GF"), ("paper_t17_xtal_16MHz_GF", "16 MHz", "GF"),
        ("paper_t17_xtal_16MHz_GB", "16 MHz", "GB"), ("paper_t17_xtal_25MHz_GM", "25 MHz", "GM"),
    ],
)  # fmt: skip
def test_crystals_are_not_entered_in_hertz(name, frequency, environment, original):
    case = original[name]
    inputs = CRYSTAL.settle({"frequency": frequency, "quality": "MIL-SPEC", "environment": environment})
    assert case["expected"]["value"] / CRYSTAL.evaluate(inputs).value == pytest.approx(10 ** (6 * 0.23), rel=0.01)


@pytest.mark.parametrize("name", ["paper_t17_fuse", "paper_t17_resettable_fuse"])
def test_fuses(name, original):
    case = original[name]
    assert FUSE.evaluate(FUSE.settle(case["inputs"])).value == pytest.approx(case["expected"]["value"], rel=1e-3)
