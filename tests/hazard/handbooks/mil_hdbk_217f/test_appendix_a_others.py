"""Microcircuits, connections and meters of MIL-HDBK-217F Notice 2 against generic rates printed in its Appendix A."""

import json
from pathlib import Path

import pytest

from robophm.hazard.handbooks import handbook_model

FILE = "appendix_a_others.json"
DATA = json.loads((Path(__file__).parents[3] / "data" / FILE).read_text(encoding="utf-8"))
JUNCTION, ROWS = DATA["junction_temperature"], DATA["rows"]
RATES = [
    (name, environment)
    for name, row in ROWS.items()
    for environment in row["rates"]
    if environment not in row["disputed"]
]


def ours(row, environment):
    """Failures/10⁶ h at the appendix's defaults; without dissipation the case is as hot as the junction."""
    model = handbook_model(row["model"])
    hot = {row["junction_as"]: f"{JUNCTION[environment]} degC"} if "junction_as" in row else {}
    return float(model.evaluate(model.settle({**row["inputs"], **hot, "environment": environment})).value) * 1e6


def test_the_rates_are_all_there():
    assert (len(ROWS), len(RATES), sum(len(row["disputed"]) for row in ROWS.values())) == (41, 504, 63)


@pytest.mark.parametrize(("name", "environment"), RATES)
def test_generic_rates(name, environment, answer):
    row = ROWS[name]
    answer(row["model"], FILE)
    assert ours(row, environment) == pytest.approx(row["rates"][environment], **DATA["tolerance"])
