"""Microcircuits, connections and meters of MIL-HDBK-217F Notice 2 against generic rates printed in its Appendix A."""

import pytest
from tests.cases import each_case

from .appendix_a import Printed, rate

FILE = "appendix_a_others.json"
PRINTED = Printed(FILE)
JUNCTION, ROWS = PRINTED.junction, PRINTED.rows


def ours(row, environment):
    """Failures/10⁶ h at the appendix's defaults; without dissipation the case is as hot as the junction."""
    hot = {row["junction_as"]: f"{JUNCTION[environment]} degC"} if "junction_as" in row else {}
    return rate(row["model"], {**row["inputs"], **hot, "environment": environment})


def test_the_rates_are_all_there():
    assert PRINTED.counts == (41, 504, 63)


@each_case(("name", "environment"), PRINTED.rates)
def test_generic_rates(name, environment, answer):
    row = ROWS[name]
    answer(row["model"], FILE)
    assert ours(row, environment) == pytest.approx(row["rates"][environment], **PRINTED.tolerance)
