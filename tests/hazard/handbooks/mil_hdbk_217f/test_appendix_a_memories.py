"""Memories of MIL-HDBK-217F Notice 2 §5.2 against generic rates of its Appendix A; GaAs, where the two differ."""

import json
from pathlib import Path

import pytest

from robophm.hazard.handbooks import handbook_model

FILE = "appendix_a_memories.json"
DATA = json.loads((Path(__file__).parents[3] / "data" / FILE).read_text(encoding="utf-8"))
JUNCTION, ROWS = DATA["junction_temperature"], DATA["rows"]
RATES = [
    (name, environment)
    for name, row in ROWS.items()
    for environment in row["rates"]
    if environment not in row["disputed"]
]
COUNT = handbook_model("mil_hdbk_217f.parts_count")
OTHERS = json.loads((Path(__file__).parents[3] / "data" / "appendix_a_others.json").read_text(encoding="utf-8"))["rows"]


def test_the_rates_are_all_there():
    assert (len(ROWS), len(RATES), sum(len(row["disputed"]) for row in ROWS.values())) == (24, 333, 3)


@pytest.mark.parametrize(("name", "environment"), RATES)
def test_generic_rates(name, environment, answer):
    row = ROWS[name]
    answer(row["model"], FILE)
    model = handbook_model(row["model"])
    hot = f"{JUNCTION[environment]} degC"
    given = {**row["inputs"], "case_temperature": hot, "environment": environment}
    ours = float(model.evaluate(model.settle(given)).value) * 1e6
    assert ours == pytest.approx(row["rates"][environment], **DATA["tolerance"])


@pytest.mark.parametrize(
    "name", [name for name in OTHERS if name.startswith(("logic", "linear", "programmable", "proc"))]
)
def test_the_count_has_the_same_rates_of_microcircuits(name):
    """Two transcriptions of one copy: the file of the sections' tests, and the table of parts count."""
    kind, _, rest = name.partition("_")
    words = rest.replace("TTL", "bipolar").lower().split("_")
    number = "1000" if words[-2] == "2000" else words[-2]  # of MOS arrays the next band is from 501 to 1000
    part = "-".join([{"programmable": "pla"}.get(kind, kind), *words[:-2], number])
    for environment, rate in OTHERS[name]["rates"].items():
        if environment not in OTHERS[name]["disputed"]:
            settled = COUNT.settle({"part": part, "quality_factor": 1, "environment": environment})
            assert float(COUNT.evaluate(settled).value) * 1e6 == pytest.approx(rate, rel=1e-9)


@pytest.mark.parametrize(("part", "application", "elements"), [
    ("gaas-mmic-100", "MMIC", 100), ("gaas-digital-1000", "digital", 1000),
])  # fmt: skip
def test_gallium_arsenide_is_contradicted_by_the_appendix(part, application, elements):
    """Whatever the pins, §5.4 rises far more from ground, benign (50 °C) to airborne, uninhabited (90 °C)."""
    model = handbook_model("mil_hdbk_217f.microcircuit.gaas")

    def own(environment, hot, pins):
        given = {
            "application": application, "elements": elements, "package": "DIP-hermetic", "pins": pins, "power": "0 W",
            "years_in_production": "10 year", "quality": "B", "environment": environment, "case_temperature": hot,
        }  # fmt: skip
        return float(model.evaluate(model.settle(given)).value)

    def counted(environment):
        return float(
            COUNT.evaluate(COUNT.settle({"part": part, "quality_factor": 1, "environment": environment})).value
        )

    printed = counted("AUC") / counted("GB")
    assert all(
        abs(own("AUC", "90 degC", pins) / own("GB", "50 degC", pins) / printed - 1) > 0.05 for pins in (8, 24, 40)
    )
