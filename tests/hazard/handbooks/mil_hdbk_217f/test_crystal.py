"""MIL-HDBK-217F Notice 2 §19.1 against Appendix A and the printed table of λb."""

import json
from pathlib import Path

import pytest

from robophm.core.errors import ModelError, UnitError
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.handbooks.mil_hdbk_217f.crystal import ENVIRONMENT, QUALITY

CASES = json.loads((Path(__file__).parents[3] / "data" / "crystal.json").read_text())["cases"]
CRYSTAL = handbook_model("mil_hdbk_217f.crystal")
PLAIN = {"frequency": "1 MHz", "quality": "MIL-SPEC", "environment": "GB"}


def given(published):
    """The inputs of a published case as ours; a name that is not known fails."""
    ours = {}
    for name, value in published.items():
        match name:
            case "f_MHz":
                ours["frequency"] = f"{value} MHz"
            case "quality" | "environment":
                ours[name] = value
            case _:
                pytest.fail(f"the published input '{name}' is not known here")
    return ours


@pytest.mark.parametrize("case", CASES, ids=lambda case: case["name"])
def test_published(case, answers):
    inputs = dict(case["inputs"])
    symbol = {None: None, "lambda_b": "λb"}[inputs.pop("factor", None)]
    answers(CRYSTAL, case, {**PLAIN, **given(inputs)}, symbol)


def test_the_cases_are_all_there(as_published):
    assert len(CASES) == 24
    as_published(CASES, "19.1")


def test_tables_agree_row_by_row(second, factors):
    theirs = second("crystals_fuses_lamps_filters_meters")["crystal"]
    assert dict(QUALITY) == theirs["piQ"]
    assert dict(ENVIRONMENT) == theirs["piE"]
    for label, value in theirs["printed_lambda_b"].items():
        frequency = label.removeprefix("f_").replace("_", ".")
        found = factors(CRYSTAL, CRYSTAL.settle({**PLAIN, "frequency": f"{frequency} MHz"}))["λb"]
        assert found == pytest.approx(value, abs=0.00055), label


def test_the_frequency_is_in_megahertz():
    """The paper entered Hz: 24 times too much (10⁶ to the power of 0.23)."""
    rates = [
        CRYSTAL.evaluate(CRYSTAL.settle({**PLAIN, "frequency": f, "environment": "GF"})).value
        for f in ("16 MHz", "16000 kHz", "16000000 Hz")
    ]
    assert rates == pytest.approx([0.013 * 16**0.23 * 3e-6] * 3, rel=1e-14)
    assert 1.77e-6 / rates[0] == pytest.approx(24, rel=0.01)  # what the paper's Table 17 prints
    with pytest.raises(UnitError, match="has no unit"):
        CRYSTAL.settle({**PLAIN, "frequency": 16e6})
    with pytest.raises(ModelError, match="outside"):
        CRYSTAL.settle({**PLAIN, "frequency": "16e6 MHz"})


def test_a_watch_crystal_is_below_the_printed_table():
    inputs = CRYSTAL.settle({"frequency": "32.768 kHz", "environment": "GB"})
    assert CRYSTAL.evaluate(inputs).value == pytest.approx(0.013 * 0.032768**0.23 * 2.1e-6, rel=1e-14)
