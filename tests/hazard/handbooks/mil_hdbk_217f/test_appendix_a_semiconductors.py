"""Semiconductors of MIL-HDBK-217F Notice 2 §6 against generic rates printed in its Appendix A, all environments."""

import pytest
from tests.cases import each_case

from robophm.hazard.environments import ENVIRONMENTS
from robophm.hazard.handbooks.mil_hdbk_217f._semiconductor import OPTICAL_ENVIRONMENT, RF_ENVIRONMENT

from .appendix_a import Printed, rate

FILE = "appendix_a_semiconductors.json"
PRINTED = Printed(FILE)
JUNCTION, ROWS = PRINTED.junction, PRINTED.rows


def ours(row, environment):
    """Failures/10⁶ h at the appendix's defaults; lasers at no more than the 75 °C of their section."""
    junction = JUNCTION[environment]
    if row["model"].endswith("laser_diode"):
        junction = min(junction, 75)
    return rate(row["model"], {**row["inputs"], "temperature": f"{junction} degC", "environment": environment})


def test_the_rates_are_all_there():
    assert all(list(row["rates"]) == list(ENVIRONMENTS) for row in ROWS.values())
    assert PRINTED.counts == (17, 185, 53)


@each_case(("name", "environment"), PRINTED.rates)
def test_generic_rates(name, environment, answer):
    row = ROWS[name]
    answer(row["model"], FILE)
    assert ours(row, environment) == pytest.approx(row["rates"][environment], **PRINTED.tolerance)


@each_case("name", [name for name in ROWS if name.startswith(("opto", "display", "laser"))])
def test_the_appendix_takes_another_environment_factor_for_light(name):
    """Where §6.11 to §6.13 and Appendix A differ, the appendix has πE of high frequency; all else agrees."""
    row = ROWS[name]
    for environment in set(row["rates"]) - ({"MF"} if name == "opto_led" else set()):
        ratio = RF_ENVIRONMENT[environment] / OPTICAL_ENVIRONMENT[environment]
        assert ours(row, environment) * ratio == pytest.approx(row["rates"][environment], **PRINTED.tolerance)


def test_a_laser_is_twice_as_sensitive_to_heat_as_a_led():
    """Appendix A decides between the two readings of B: 4635 gives its rates, 2790 does not by 10 to 20 %."""
    row = ROWS["laser_GaAs_AlGaAs"]["rates"]
    for hotter, factor in (("GF", 2), ("AIC", 4)):
        printed = row[hotter] / row["GB"] / factor
        by = {b: 2.718281828 ** (b * (1 / 323 - 1 / (JUNCTION[hotter] + 273))) for b in (4635, 2790)}
        assert printed == pytest.approx(by[4635], rel=0.04)
        assert printed != pytest.approx(by[2790], rel=0.15)


@each_case(
    ("given", "junction"),
    [
        ({"power": "0 W"}, 40),
        ({"power": "0.5 W"}, 40 + 35),
        ({"power": "0.5 W", "package": "TO-92"}, 40 + 35),
        ({"power": "2 W", "package": "to220"}, 40 + 10),
        ({"power": "2 W", "package": "TO 3"}, 40 + 20),
        ({"power": "1 W", "package": "TO-89"}, 40 + 22),
        ({"power": "1 W", "package": "TO-92", "thermal_resistance": "30 °C/W"}, 40 + 30),
    ],
)
def test_the_junction_is_warmer_by_what_is_dissipated(given, junction):
    name = "mil_hdbk_217f.transistor_unijunction"
    warm = rate(name, {"environment": "GM", **given, "temperature": "40 degC"})
    cold = rate(name, {"environment": "GM", "power": "0 W", "temperature": f"{junction} degC"})
    assert warm == pytest.approx(cold, rel=1e-14)


@each_case("name", ["gaas_low", "gaas_power"])
def test_the_appendix_needs_another_factor_for_gallium_arsenide_in_missiles(name):
    """The doubt that the model's source states: 9 and not 7.5."""
    assert ours(ROWS[name], "MF") * 9 / 7.5 == pytest.approx(ROWS[name]["rates"]["MF"], **PRINTED.tolerance)
