"""MIL-HDBK-217F Notice 2 §5.2, memories: sizes, and the programming of EEPROMs."""

import math

import pytest
from tests.cases import each_case

from robophm.core.errors import ModelError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.microcircuit.memory import CORRECTION, CYCLING, STYLE

MEMORY = handbook_model("mil_hdbk_217f.microcircuit.memory")
PLAIN = {
    "style": "EEPROM", "bits": "16 KiB", "package": "DIP-hermetic", "pins": 28, "power": "0 W",
    "case_temperature": "60 degC", "programming_cycles": "10000 cycle", "years_in_production": "2 year",
    "quality": "B", "environment": "GB",
}  # fmt: skip


@each_case(
    ("bits", "expected"),
    [(1, 0.0013), (16384, 0.0013), (16385, 0.0025), (65536, 0.0025), (262144, 0.005), (1048576, 0.01)],
)
def test_sizes(bits, expected, factors):
    inputs = {key: value for key, value in PLAIN.items() if key != "programming_cycles"}
    inputs = MEMORY.settle({**inputs, "style": "DRAM", "bits": f"{bits} bit"})
    assert factors(MEMORY, inputs)["C1"] == expected
    with pytest.raises(ModelError, match=r"bits 300000000 bit is outside 1 "):
        MEMORY.settle({**PLAIN, "bits": "300 Mbit"})


def test_cycling_agrees_band_by_band(second, factors):
    theirs = second("mil217_microcircuits")["eeprom_lambda_cyc"]
    assert list(CORRECTION.values()) == list(theirs["piECC"].values())
    for cell in ("flotox", "textured"):
        for limit, value in theirs[f"{cell}_A1_cycles_upto" if cell == "flotox" else "textured_A1"]:
            for cycles in (limit, limit - 1):
                inputs = {**PLAIN, "style": f"MOS-EEPROM-{cell}", "programming_cycles": f"{cycles} cycle"}
                assert factors(MEMORY, MEMORY.settle(inputs))["A1"] == value, (cell, cycles)
    previous = 0
    for limit, value in theirs["textured_A2"]:
        for cycles in (limit, previous + 1):
            inputs = {**PLAIN, "style": "MOS-EEPROM-textured", "programming_cycles": f"{cycles} cycle"}
            assert factors(MEMORY, MEMORY.settle(inputs))["A2"] == value, cycles
        previous = limit


def test_the_printed_band_of_flotox_is_near_its_equation():
    """A1 = 6.817e-6 C at the upper limit of most bands, to the printed two digits."""
    for limit in CYCLING:
        if limit not in ("0", "300000"):
            assert CYCLING[limit] == pytest.approx(6.817e-6 * float(limit), rel=0.05)


def test_textured_cells_by_hand(factors):
    """64,000 bits at 30 °C make B1 and B2 1; 450,000 cycles: 0.30 + 2.3 / πQ, with a Hamming code 0.72 of it."""
    inputs = MEMORY.settle({
        **PLAIN, "style": "MOS-EEPROM-textured", "bits": "64000 bit", "case_temperature": "30 degC", "quality": "B-1",
        "programming_cycles": "450000 cycle", "error_correction": "hamming",
    })  # fmt: skip
    pi_t = 0.1 * math.exp(-0.6 / 8.617e-5 * (1 / 303 - 1 / 298))
    expected = (0.0017 * pi_t + 2.8e-4 * 28**1.08 * 0.5 + (0.30 + 2.3 / 2) * 0.72) * 2 * 1e-6
    assert MEMORY.evaluate(inputs).value == pytest.approx(expected, rel=1e-14)


def test_cycling_is_scaled_by_life_and_nothing_without_cycles(factors):
    longer = MEMORY.settle({**PLAIN, "system_life": "20000 h"})
    assert factors(MEMORY, longer)["A1"] == 0.2
    assert factors(MEMORY, MEMORY.settle({**PLAIN, "programming_cycles": "0 cycle"}))["A1"] == 0
    with pytest.raises(ModelError, match="programming_cycles 500001 cycle is outside"):
        MEMORY.settle({**PLAIN, "programming_cycles": "500001 cycle"})


@each_case("style", STYLE)
def test_only_eeproms_ask_for_their_programming(style, factors):
    inputs = {key: value for key, value in PLAIN.items() if key != "programming_cycles"} | {"style": style}
    if "EEPROM" in style:
        with pytest.raises(ModelError, match=f"{style} needs 'programming_cycles'"):
            MEMORY.settle(inputs)
    else:
        assert "A1" not in factors(MEMORY, MEMORY.settle(inputs))
