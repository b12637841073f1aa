"""A value exactly on a printed boundary is of the row that the handbook prints, in whatever unit it is written."""

import math
import re
from pathlib import Path

import pytest
from tests.cases import each_case

from robophm.core.units import quantity
from robophm.hazard import handbooks
from robophm.hazard.handbooks import handbook_model, handbook_models

from .adapter import plausible

EDGES = [
    # inputs at the edge, factor, its printed row there; what is beyond, and the row there
    ("diode_high_frequency: kind=pin, rated_power=10 W", "πR", 0.5, "rated_power=20 W", 0.326 * math.log(20) - 0.25),
    ("diode_high_frequency: kind=pin, rated_power=10000 mW", "πR", 0.5, "rated_power=9.9 W", 0.5),
    ("diode_low_frequency: voltage=1.23 V, rated_voltage=4.1 V", "πS", 0.054, "voltage=1.24 V", (1.24 / 4.1) ** 2.43),
    ("thyristor: voltage=1.53 V, rated_voltage=5.1 V", "πS", 0.1, "voltage=1.54 V", (1.54 / 5.1) ** 1.9),
    ("transistor_bipolar_low_frequency: rated_power=100 mW", "πR", 0.43, "rated_power=101 mW", 0.101**0.37),
    ("transistor_bipolar_low_noise_high_frequency: rated_power=100 mW", "πR", 0.43, "rated_power=0.2 W", 0.2**0.37),
    ("transistor_fet_low_frequency: rated_power=2 W, application=switching", "πA", 2, "rated_power=1.99 W", 0.7),
    ("transistor_fet_low_frequency: rated_power=5000 mW", "πA", 4, "rated_power=4.99 W", 2),
    ("transistor_fet_low_frequency: rated_power=0.05 kW", "πA", 8, "rated_power=49.9 W", 4),
    ("transistor_fet_low_frequency: rated_power=250 W", "πA", 10, "rated_power=249 W", 8),
    ("transistor_gaas_fet: output_power=0.1 W, frequency=4 GHz", "λb", 0.0093 * math.exp(1.7646), "output_power=99 mW",
     0.052),
    ("transistor_bipolar_high_power_high_frequency: metallization=gold, voltage=0.28 V, rated_voltage=0.7 V",
     "πT stress", 0.1, "voltage=0.3 V", 2 * (0.3 / 0.7 - 0.35)),
    ("capacitor: style=CWR, series_resistance=0.1 ohm/V", "πSR", 3.3, "series_resistance=0.11 ohm/V", 2.7),
    ("capacitor: style=CWR, series_resistance=0.2 ohm/V", "πSR", 2.7, "series_resistance=0.21 ohm/V", 2.0),
    ("capacitor: style=CWR, series_resistance=800 mohm/V", "πSR", 1.0, "series_resistance=0.81 ohm/V", 0.66),
    ("connector: matings=0.05 /10^3 h", "πK", 1, "matings=0.051 /10^3 h", 1.5),
    ("connector: matings=0.5 /10^3 h", "πK", 1.5, "matings=0.51 /10^3 h", 2),
    ("connector: matings=50 /10^3 h", "πK", 3, "matings=50.1 /10^3 h", 4),
    ("lamp: utilisation=10 percent", "πU", 0.72, "utilisation=0.0999", 0.1),
    ("lamp: utilisation=0.9", "πU", 0.72, "utilisation=0.9001", 1.0),
    ("relay: quality=commercial, cycling=1000 cycle/h", "πCYC", 100, "cycling=1001 cycle/h", 10.01**2),
    ("relay: quality=commercial, cycling=10 cycle/h", "πCYC", 1, "cycling=10.1 cycle/h", 1.01),
    ("relay: quality=M, cycling=1 cycle/h", "πCYC", 0.1, "cycling=1.1 cycle/h", 0.11),
    ("synchro: kind=synchro, size=8", "πS", 2, "size=10", 1.5),
    ("synchro: kind=resolver, size=16", "πS", 2.25, "size=18", 1.5),
    ("synchro: brushes=3", "πN", 2.5, "brushes=4", 3.2),
    ("elapsed_time_meter: temperature=2.46 degC, rated_temperature=4.1 degC", "πT", 0.6, "temperature=2.5 degC", 0.8),
    ("microcircuit.logic: family=CMOS, gates=1000", "C1", 0.020, "gates=1001", 0.040),
    ("microcircuit.linear: transistors=300", "C1", 0.020, "transistors=301", 0.040),
    ("microcircuit.programmable: family=MOS, gates=500", "C1", 0.00085, "gates=501", 0.0017),
    ("microcircuit.gaas: application=MMIC, elements=100", "C1", 4.5, "elements=101", 7.2),
    ("microcircuit.processor: family=CMOS, bits=8 bit", "C1", 0.14, "bits=9 bit", 0.28),
    ("microcircuit.memory: style=MOS-DRAM, bits=16384 bit", "C1", 0.0013, "bits=16385 bit", 0.0025),
    ("microcircuit.memory: style=MOS-EEPROM-flotox, programming_cycles=100 cycle", "A1", 0.0007,
     "programming_cycles=101 cycle", 0.0014),
    ("microcircuit.logic: years_in_production=0.1 year", "πL", 2, "years_in_production=0.101 year",
     0.01 * math.exp(5.35 - 0.35 * 0.101)),
    ("microcircuit.logic: years_in_production=2 year", "πL", 1, "years_in_production=1.9 year",
     0.01 * math.exp(5.35 - 0.35 * 1.9)),
]  # fmt: skip
"""≤ or < as each section prints it."""


def said(text):
    return dict(pair.split("=") for pair in text.split(", "))


@each_case(("at", "symbol", "there", "beyond", "then"), EDGES)
def test_a_printed_boundary_is_of_the_printed_row(at, symbol, there, beyond, then, factors):
    kind, _, given = at.partition(": ")
    model = handbook_model(f"mil_hdbk_217f.{kind}")
    design = {**plausible(model.name), **said(given)}
    assert factors(model, model.settle(design))[symbol] == pytest.approx(there, rel=1e-12)
    assert factors(model, model.settle({**design, **said(beyond)}))[symbol] == pytest.approx(then, rel=1e-12)


@each_case(("bore", "expected"), [("99.9 mm", 1.8), ("100 mm", 1.8), ("10 cm", 1.8), ("100.1 mm", 1.4)])
def test_a_bearing_of_exactly_100_mm(bore, expected, factors):
    """Printed for d below and above 100 mm alone: at 100 mm the larger of both counts."""
    model = handbook_model("nswc_11.bearing")
    design = {**plausible(model.name), "cleanliness": "normal", "bore": bore}
    assert factors(model, model.settle(design))["C_C"] == expected


COMPARED = re.compile(r"np\.where\([^,\n]*[<>]|outside=[^,\n]*[<>]|digitize|searchsorted\(np")
GEOMETRY = {"helical_spring.py", "belleville_washer.py", "shaft.py"}
"""Of what cannot be built; there is no printed edge."""


def test_every_printed_edge_is_compared_in_one_way():
    """By above(), below() and band(), which know that numbers round."""
    folder = Path(handbooks.__file__).parent
    found = {file.name for file in folder.rglob("*.py") if COMPARED.search(file.read_text(encoding="utf-8"))}
    assert found == GEOMETRY


OTHER_UNITS = {
    "degC": ("degF", 1.8, 32.0), "K": ("delta_degF", 1.8, 0.0), "h": ("min", 60.0, 0.0), "m": ("ft", 1 / 0.3048, 0.0),
    "mm": ("inch", 1 / 25.4, 0.0), "um": ("inch", 1 / 25.4e3, 0.0), "N": ("lbf", 1 / 4.4482216152605, 0.0),
    "MPa": ("psi", 1 / 6.894757293168361e-3, 0.0), "cm^2": ("inch^2", 1 / 6.4516, 0.0),
    **{unit: (f"m{unit}", 1e3, 0.0) for unit in ("V", "A", "W", "ohm/V")}, "uF": ("nF", 1e3, 0.0),
    "GHz": ("MHz", 1e3, 0.0), "MHz": ("kHz", 1e3, 0.0), "cycle/h": ("cycle/min", 1 / 60, 0.0), "1/h": ("FIT", 1e9, 0.0),
}  # fmt: skip
NUMBERS = [(name, key) for name in handbook_models() for key in handbook_model(name).numbers]


@each_case(("name", "key"), NUMBERS)
def test_a_limit_is_a_limit_in_every_unit(name, key):
    """What conversion rounds off takes no number out of its range: 302 °F are 150 °C, in a design and live."""
    model = handbook_model(name)
    entry, inputs = model.numbers[key], model.settle(plausible(name))
    unit, scale, offset = OTHER_UNITS.get(entry.unit, (entry.unit, 1.0, 0.0))
    for limit in (entry.low, entry.high):
        number = quantity(f"{limit * scale + offset!r} {unit}" if unit else limit * scale + offset, entry.unit)
        assert number == pytest.approx(limit, rel=1e-12, abs=1e-12)
        assert entry.holds(number)
        given = {**plausible(name), key: f"{limit * scale + offset!r} {unit}".strip()}
        if not model.evaluate({**inputs, key: limit}).extrapolated:  # some limits have no answer beside the others
            assert entry.low <= model.settle(given)[key] <= entry.high
        assert bool(model.evaluate({**inputs, key: number}).extrapolated) == bool(
            model.evaluate({**inputs, key: limit}).extrapolated
        )
        for beyond in (entry.low - 1e-9 * max(abs(entry.low), 1e-3), entry.high * (1 + 1e-9)):
            assert not entry.holds(beyond)
