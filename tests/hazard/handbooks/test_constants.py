"""Constants of ours that are in no table, against the second transcription of the handbooks."""

import math

import pytest
from tests.cases import each_case

from robophm.hazard.handbooks.mil_hdbk_217f import (
    capacitor,
    connector,
    elapsed_time_meter,
    lamp,
    relay,
    resistor,
    synchro,
)

from .adapter import Adapter, plausible
from .transcription import LIGHT, MECHANICS, OTHERS, SEALS, TRANSISTORS, at, numbers


def bands(rows):
    """Limits and values of rows, the last without a limit."""
    return (*(limit for limit, _ in rows[:-1]), math.inf), tuple(value for _, value in rows)


def bands_above(rows):
    """The same where a row is said to hold above its limit."""
    rows = sorted(rows)
    return (*(above for above, _ in rows[1:]), math.inf), tuple(value for _, value in rows)


CONSTANTS = {
    "capacitor Ea": (capacitor.ACTIVATION_ENERGY, "mil217_capacitors", lambda t: t["piT"]["Ea_eV"]),
    "capacitor πC": (capacitor.CAPACITANCE_EXPONENT, "mil217_capacitors", lambda t: t["piC"]["x"]),
    "capacitor πV": (
        capacitor.VOLTAGE_STRESS, "mil217_capacitors", lambda t: {c: tuple(row) for c, row in t["piV"]["s0_n"].items()}
    ),
    "capacitor πSR": (
        capacitor.SERIES_RESISTANCE, "mil217_capacitors", lambda t: bands_above(t["piSR"]["CR_ohm_per_volt_bands_gt"])
    ),
    "resistor Ea": (resistor.ACTIVATION_ENERGY, "mil217_resistors", lambda t: {0: 0.0, **t["piT"]["Ea_eV"]}),
    "resistor πS": (
        resistor.POWER_STRESS, "mil217_resistors",
        lambda t: {0: (1.0, 0.0)} | {c: tuple(numbers(said, "^", "exp.")) for c, said in t["piS"]["form"].items()},
    ),
    "relay λb": (
        relay.RATED_TEMPERATURE, "mil217_relays",
        lambda t: {f"{c} degC": (float(c), *numbers(t["lambda_b"][f"{c}C"], r"exp\(-")) for c in (85, 125)},
    ),
    "lamp πU": (lamp.UTILISATION, OTHERS, lambda t: tuple(value for _, value in t["lamp"]["piU"])),
    "synchro πN": (
        synchro.BRUSHES, "mil217_rotating", lambda t: bands(list(t["synchro_resolver"]["piN"].items())),
    ),
    "elapsed-time meter πT": (
        elapsed_time_meter.TEMPERATURE, "mil217_rotating", lambda t: bands(t["elapsed_time_meter"]["piT_T_over_Tmax"]),
    ),
    "RF connector": (
        connector.RADIO_FREQUENCY_RISE, "mil217_connectors",
        lambda t: dict(zip(
            ("rf-coaxial", "rf-coaxial-power"), numbers(t["insert_dT"]["rf_coax"], "dT=", "RF dT="), strict=True
        )),
    ),
}  # fmt: skip
"""Constants that are in no table."""


@each_case("name", CONSTANTS)
def test_constants(name, second):
    ours, file, theirs = CONSTANTS[name]
    assert ours == theirs(second(file))


@each_case(
    ("kind", "given", "symbol", "file", "path"),
    [
        ("mil_hdbk_217f.fuse", {}, "λb", OTHERS, ("fuse", "lambda_b")),
        ("mil_hdbk_217f.panel_meter", {}, "λb", OTHERS, ("panel_meter", "lambda_b")),
        ("mil_hdbk_217f.circuit_breaker", {}, "λb", "mil217_switches", ("breaker", "lambda_b")),
        ("mil_hdbk_217f.relay_solid_state", {}, "λb", "mil217_relays", ("ss_relay_13_2", "lambda_b")),
        ("mil_hdbk_217f.transistor_bipolar_low_frequency", {}, "λb", TRANSISTORS, ("6.3_bipolar_lf", "lambda_b")),
        ("mil_hdbk_217f.transistor_unijunction", {}, "λb", TRANSISTORS, ("6.5_unijunction", "lambda_b")),
        (
            "mil_hdbk_217f.transistor_bipolar_low_noise_high_frequency", {}, "λb",
            TRANSISTORS, ("6.6_rf_low_noise_bipolar", "lambda_b"),
        ),
        (
            "mil_hdbk_217f.transistor_bipolar_high_power_high_frequency", {"application": "cw"}, "πA",
            TRANSISTORS, ("6.7_rf_power_bipolar", "piA", "cw"),
        ),
        ("mil_hdbk_217f.thyristor", {}, "λb", TRANSISTORS, ("6.10_thyristor", "lambda_b")),
        ("mil_hdbk_217f.laser_diode", {"application": "cw"}, "πA", LIGHT, ("laser_diode_6_13", "piA", "cw")),
        ("nswc_11.static_seal", {}, "λ_SE,B", SEALS, ("static_seal_fpmh",)),
        ("nswc_11.dynamic_seal", {}, "λ_SE,B", SEALS, ("dynamic_seal_fpmh",)),
        ("nswc_11.solenoid", {}, "λ_SO", SEALS, ("solenoid_per_million_ops",)),
        ("nswc_11.electric_motor", {"brushes": 1}, "λ_BS", MECHANICS, ("motor", "brush_fpmh_each")),
        ("nswc_11.electric_motor", {}, "λ_ST", MECHANICS, ("motor", "stator_housing_fpmh")),
        ("nswc_11.electric_motor", {}, "λ_WI,B", MECHANICS, ("motor", "winding_default_fpmh")),
        ("nswc_11.coupling", {}, "λ_CP,B", MECHANICS, ("coupling", "typical_per_million_cycles")),
        ("nswc_11.coupling", {}, "λ_H", MECHANICS, ("coupling", "housing_per_million_cycles")),
    ],
)  # fmt: skip
def test_base_rates(kind, given, symbol, file, path, second):
    assert leaf(kind, symbol, **given) == at(file, *path)(second)


@each_case(
    ("kind", "file", "path"),
    [
        ("transistor_bipolar_low_frequency", TRANSISTORS, ("6.3_bipolar_lf",)),
        ("transistor_fet_low_frequency", TRANSISTORS, ("6.4_fet_lf",)),
        ("transistor_unijunction", TRANSISTORS, ("6.5_unijunction",)),
        ("transistor_bipolar_low_noise_high_frequency", TRANSISTORS, ("6.6_rf_low_noise_bipolar",)),
        ("transistor_gaas_fet", TRANSISTORS, ("6.8_gaas_fet",)),
        ("transistor_fet_high_frequency", TRANSISTORS, ("6.9_rf_si_fet",)),
        ("thyristor", TRANSISTORS, ("6.10_thyristor",)),
        ("optoelectronic", LIGHT, ()),
        ("display", LIGHT, ()),
        ("laser_diode", LIGHT, ("laser_diode_6_13",)),
    ],
)
def test_temperature_constants(kind, file, path, second):
    """B, from πT of a junction at 70 °C; it is 1 at 25 °C."""
    coefficient = at(file, *path)(second)["B"]
    at_70 = leaf(f"mil_hdbk_217f.{kind}", "πT", temperature="70 degC", power="0 W")
    assert at_70 == pytest.approx(math.exp(-coefficient * (1 / 343 - 1 / 298)), rel=1e-14)


def leaf(kind, symbol, **given):
    """One factor of a model at its plausible inputs, of which some are changed."""
    of = Adapter(kind, {})
    return of.leaves(of.model.settle({**plausible(kind), **given}))[symbol]
