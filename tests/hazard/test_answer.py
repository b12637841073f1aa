"""A model asked about one part: the equations by hand, and what was said, meant and assumed."""

from __future__ import annotations

import math

import pytest

from robophm.core.errors import ModelError
from robophm.hazard.answer import answer
from robophm.hazard.formula import formula_model
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.model import Range

MICA_OR_CERAMIC = {
    "style": "mlcc", "capacitance": "1 uF", "temperature": "40 degC", "dc_voltage": "10 V", "rated_voltage": "50 V",
    "environment": "GM",
}  # fmt: skip
SYMBOLS = ("λb", "πT", "πC", "πV", "πSR", "πQ", "πE")


def test_a_rate_with_its_factors() -> None:
    found = answer(handbook_model("general.mtbf"), {"mtbf": "20000 h", "source": "its maker"})
    assert found.value == pytest.approx(5e-5, rel=1e-14)
    assert found.inputs == {"mtbf": 20000.0, "source": "its maker"}
    assert (dict(found.assumed), dict(found.taken)) == ({}, {})


def test_a_product_is_that_of_its_factors_in_failures_per_million_hours() -> None:
    """MIL-HDBK-217F(2) §10.1: λp = λb · πT · πC · πV · πSR · πQ · πE."""
    found = answer(handbook_model("mil_hdbk_217f.capacitor"), MICA_OR_CERAMIC)
    factors = {one.symbol: one.value for one in found.factors}
    assert tuple(name for name in factors if name in SYMBOLS) == SYMBOLS
    assert found.value == pytest.approx(math.prod(factors.values()), rel=1e-12)
    assert found.value == pytest.approx(
        1e-6 * math.prod(factors[name] for name in factors if name[0] in "λπ"), rel=1e-12
    )


def test_what_was_meant_by_a_word_and_what_was_assumed() -> None:
    found = answer(handbook_model("mil_hdbk_217f.capacitor"), MICA_OR_CERAMIC)
    assert dict(found.taken) == {"style": "CDR"}  # a multilayer ceramic chip
    assert found.inputs["style"] == "CDR"
    assert found.assumed["quality"].value == "commercial"
    assert not found.assumed.keys() & MICA_OR_CERAMIC.keys()


def test_what_must_be_given_is_asked_for() -> None:
    model = handbook_model("mil_hdbk_217f.capacitor")
    assert set(model.must_be_given) == set(MICA_OR_CERAMIC)
    for name in model.must_be_given:
        with pytest.raises(ModelError, match=f"needs the input '{name}'"):
            answer(model, {key: text for key, text in MICA_OR_CERAMIC.items() if key != name})


def test_a_formula_that_has_no_number_is_refused() -> None:
    numbers = {name: Range(-math.inf, math.inf, "", default=0.0) for name in "ab"}
    ratio = formula_model("a / b", "1/h", numbers, "own formula")
    assert answer(ratio, {"a": 3.0, "b": 4.0}).value == 0.75
    with pytest.raises(ModelError, match="has no number for these inputs"):
        answer(ratio, {"a": 1.0, "b": 0.0})
