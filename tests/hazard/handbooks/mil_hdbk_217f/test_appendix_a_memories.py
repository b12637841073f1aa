"""Memories of MIL-HDBK-217F Notice 2 §5.2 against generic rates of its Appendix A; GaAs, where the two differ."""

import pytest
from tests.cases import each_case

from .appendix_a import Printed, rate

FILE = "appendix_a_memories.json"
PRINTED = Printed(FILE)
JUNCTION, ROWS = PRINTED.junction, PRINTED.rows
OTHERS = Printed("appendix_a_others.json").rows


def counted(part, environment):
    """The same by the parts count, without a factor of quality."""
    return rate("mil_hdbk_217f.parts_count", {"part": part, "quality_factor": 1, "environment": environment})


def test_the_rates_are_all_there():
    assert PRINTED.counts == (24, 333, 3)


@each_case(("name", "environment"), PRINTED.rates)
def test_generic_rates(name, environment, answer):
    row = ROWS[name]
    answer(row["model"], FILE)
    given = {**row["inputs"], "case_temperature": f"{JUNCTION[environment]} degC", "environment": environment}
    ours = rate(row["model"], given)
    assert ours == pytest.approx(row["rates"][environment], **PRINTED.tolerance)


@each_case("name", [name for name in OTHERS if name.startswith(("logic", "linear", "programmable", "proc"))])
def test_the_count_has_the_same_rates_of_microcircuits(name):
    """Two transcriptions of one copy: the file of the sections' tests, and the table of parts count."""
    kind, _, rest = name.partition("_")
    words = rest.replace("TTL", "bipolar").lower().split("_")
    number = "1000" if words[-2] == "2000" else words[-2]  # of MOS arrays the next band is from 501 to 1000
    part = "-".join([{"programmable": "pla"}.get(kind, kind), *words[:-2], number])
    for environment, printed in OTHERS[name]["rates"].items():
        if environment not in OTHERS[name]["disputed"]:
            assert counted(part, environment) == pytest.approx(printed, rel=1e-9)


@each_case(("part", "application", "elements"), [
    ("gaas-mmic-100", "MMIC", 100), ("gaas-digital-1000", "digital", 1000),
])  # fmt: skip
def test_gallium_arsenide_is_contradicted_by_the_appendix(part, application, elements):
    """Whatever the pins, §5.4 rises far more from ground, benign (50 °C) to airborne, uninhabited (90 °C)."""

    def own(environment, hot, pins):
        given = {
            "application": application, "elements": elements, "package": "DIP-hermetic", "pins": pins, "power": "0 W",
            "years_in_production": "10 year", "quality": "B", "environment": environment, "case_temperature": hot,
        }  # fmt: skip
        return rate("mil_hdbk_217f.microcircuit.gaas", given)

    printed = counted(part, "AUC") / counted(part, "GB")
    assert all(
        abs(own("AUC", "90 degC", pins) / own("GB", "50 degC", pins) / printed - 1) > 0.05 for pins in (8, 24, 40)
    )
