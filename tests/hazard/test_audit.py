"""Every fault that an audit found in the 2020 tool, and that ours does not have it.

The name of a test is the fault. What is expected is the handbook's formula written out here; what the fault makes of it
stands beside it, and must be another number.
"""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from tests.cases import each_case

from robophm.blocks.diagram import Parallel
from robophm.blocks.reliability import Structure
from robophm.core.errors import ModelError
from robophm.hazard.acceleration import acceleration_model
from robophm.hazard.environments import ENVIRONMENTS
from robophm.hazard.handbooks import handbook_model

from .handbooks.adapter import plausible

MILLION = 1e6
MIL, NSWC = "mil_hdbk_217f", "nswc_11"


def semiconductor(constant, celsius):
    """B(T, b) of the handbook."""
    return math.exp(-constant * (1 / (celsius + 273) - 1 / 298))


def motor_lives(celsius):
    """α of bearings and of windings [h], §12.1."""
    kelvin = celsius + 273
    bearing = 1 / (10 ** (2.534 - 2357 / kelvin) + 1 / (10 ** (20 - 4500 / kelvin) + 300))
    return bearing, 10 ** (2357 / kelvin - 1.83)


def wahl(index, last):
    return ((4 * index - 1) / (4 * index + last) + 0.616 / index) / 1.219


DIODE = {"temperature": "100 degC", "power": "0 W"}
BEARING = {"load": "1 kN", "dynamic_rating": "10 kN", "speed": "1000 rpm"}
BEARING_ALONE = ("C_R", "C_ν", "C_CW", "C_t", "C_SF", "C_C")
SERVO_BEARING, SERVO_WINDING = motor_lives(50)  # LC/α is above 1, and 0.30 or less
PISTONS = {"bore": "2.02 inch", "piston_diameter": "2 inch", "particle_hardness": 200, "cylinder_hardness": 200}
ELASTIC = {
    "cylinder_modulus": "30e6 psi", "cylinder_poisson": 0.3, "piston_modulus": "10e6 psi", "piston_poisson": 0.3,
}  # fmt: skip
STIFF, SOFT = 0.91 / 30e6, 0.91 / 10e6
POUNDS = {"load": "1000 lbf", "wear": "adhesive_prone", "yield_strength": "50000 psi"}


def axial(k):
    """10⁶/N_O of an actuator under 1000 lbf."""
    stress = (1000 * (0.02 / (2.02 * 2)) ** 2 / k**2) ** (1 / 3)
    return MILLION / 17.7e3 * (stress / (0.2 * 50e3)) ** 9


NUMBERS = {
    "capacitor: piV of column 5 by 0.6 instead of 0.5": (
        f"{MIL}.capacitor", {"style": "CV", "dc_voltage": "4 V", "rated_voltage": "10 V"}, "πV",
        (0.4 / 0.5) ** 3 + 1, (0.4 / 0.6) ** 3 + 1,
    ),
    "capacitor: piE of AUC 15 instead of 25": (f"{MIL}.capacitor", {"environment": "AUC"}, "πE", 25, 15),
    "diode: 1925 for the general kinds": (
        f"{MIL}.diode_low_frequency", {**DIODE, "kind": "switching"}, "πT",
        semiconductor(3091, 100), semiconductor(1925, 100),
    ),
    "diode: 3091 for regulators and references": (
        f"{MIL}.diode_low_frequency", {**DIODE, "kind": "voltage_reference"}, "πT",
        semiconductor(1925, 100), semiconductor(3091, 100),
    ),
    "diode: a stack of ten junctions as one": (
        f"{MIL}.diode_low_frequency", {"kind": "high_voltage_stack", "junctions": 10}, "λb", 0.0050 * 10, 0.0050,
    ),
    "diode: none of high frequency": (f"{MIL}.diode_high_frequency", {"kind": "pin"}, "λb", 0.0081, None),
    "inductor: no transformer": (f"{MIL}.transformer", {"kind": "audio"}, "λb", 0.014, None),
    "inductor: the hot spot is the user's to compute": (
        f"{MIL}.coil", {"temperature": "40 degC", "temperature_rise": "20 K"}, "πT",
        math.exp(0.11 / 8.617e-5 * (1 / 298 - 1 / (40 + 1.1 * 20 + 273))),
        math.exp(0.11 / 8.617e-5 * (1 / 298 - 1 / 313)),
    ),
    "transistor: a MOSFET of high frequency at 0.6 instead of 0.060": (
        f"{MIL}.transistor_fet_high_frequency", {"kind": "MOSFET"}, "λb", 0.060, 0.6
    ),
    "transistor: no bipolar ones": (f"{MIL}.transistor_bipolar_low_frequency", {}, "λb", 0.00074, None),
    "transistor: no MOSFETs but of high frequency": (
        f"{MIL}.transistor_fet_low_frequency", {"kind": "MOSFET"}, "λb", 0.012, 0.060
    ),
    "motor: a millionth of the rate, and B for A, and lambda1 and lambda2 by choice": (
        f"{MIL}.motor", {"kind": "servo", "temperature": "50 degC", "design_life": "87600 h"}, "rate",
        MILLION * (1.0 / (2.4 * SERVO_BEARING) + 0.23 / (1.7 * SERVO_WINDING)),
        1.0 / (2.4 * SERVO_BEARING) + 0.23 / (2.4 * SERVO_WINDING),
    ),
    "relay: piL as (S/d)^2 + 1": (
        f"{MIL}.relay", {"load": "lamp", "load_current": "0.4 A", "rated_current": "1 A"}, "πL", math.exp(4), 5
    ),
    "connector: inserts no warmer than the air": (
        f"{MIL}.connector", {"temperature": "40 degC", "current": "2 A", "wire_gauge": "22"}, "πT",
        math.exp(0.14 / 8.617e-5 * (1 / 298 - 1 / (40 + 0.989 * 2**1.85 + 273))),
        math.exp(0.14 / 8.617e-5 * (1 / 298 - 1 / 313)),
    ),
    "crystal: a frequency in Hz for MHz": (
        f"{MIL}.crystal", {"frequency": "16e6 Hz"}, "λb", 0.013 * 16**0.23, 0.013 * 16e6**0.23
    ),
    "spring: 4r + 1 in Wahl's factor": (
        f"{NSWC}.helical_spring", {"coil_diameter": "10 mm", "wire_diameter": "2 mm"}, "C_K",
        wahl(5, -4) ** 3, wahl(5, 1) ** 3,
    ),
    **{
        f"spring: materials shifted by a row: {material}": (
            f"{NSWC}.helical_spring", {"material": material, "shear_modulus": None}, "C_G",
            (modulus / 11.5) ** 3, instead,
        )
        for material, modulus, instead in (
            ("phosphor_bronze", 6.0, None), ("beryllium_copper", 7.0, None), ("inconel", 10.5, 1.0),
            ("monel", 9.5, 1.0),
        )
    },
    "gear: 0.5 added to C_GP": (
        f"{NSWC}.gear", {"load": "5 N*m", "design_load": "10 N*m"}, "C_GP", 1.0, 1.5
    ),
    "gear: 1 added to C_GL": (
        f"{NSWC}.gear", {"specified_viscosity": "80 cSt", "lubricant_viscosity": "20 cSt"}, "C_GL", 4**0.54, 1 + 4**0.54
    ),
    "gear: a millionth of the rate": (
        f"{NSWC}.gear", {"speed": "100 rpm", "design_life": "1e8 revolution"}, "λG,B", 60 * 100 / 1e8 * MILLION, 6e-5
    ),
    "bearing: a millionth of the rate": (
        f"{NSWC}.bearing", BEARING, "10⁶/L10h", MILLION / (MILLION / (60 * 1000) * 10**3), 6e-5
    ),
    "bearing: the load twice, by C_Y too, and one more divisor": (
        f"{NSWC}.bearing", BEARING, ("rate", BEARING_ALONE), 60.0, 60.0 * (1 / 10) ** 3
    ),
    "actuator: the difference of the elastic terms": (
        f"{NSWC}.actuator_axial_load", {**POUNDS, **PISTONS, **ELASTIC}, "10⁶/N_O",
        axial(STIFF + SOFT), axial(SOFT - STIFF),
    ),
    "actuator: degrees Celsius for kelvins in C_T": (
        f"{NSWC}.actuator_axial_load", {"temperature": "50 degC"}, "C_T",
        math.exp(1200 / 298.2 * (1 - 298.2 / 323)), math.exp(1200 / 25.2 * (1 - 25.2 / 50)),
    ),
    "actuator: none under side load": (
        f"{NSWC}.actuator_side_load", {**POUNDS, **PISTONS, **ELASTIC, "contact_length": "3 inch"}, "10⁶/N_O",
        MILLION / 15.4e3 * (math.sqrt(1000 / 3 * (0.02 / (2.02 * 2)) / (STIFF + SOFT)) / (0.2 * 50e3)) ** 9, None,
    ),
    "shaft: 4*d for d^4 in the second moment": (
        f"{NSWC}.shaft",
        {
            "force": "100 lbf", "elastic_modulus": "30e6 psi", "allowable_bending": "0.01 inch", "diameter": "0.5 inch",
            "length": "10 inch", "step_diameter": None, "step_length": None, "fillet_radius": None,
        },
        "C_DY",
        0.0043 * 100 / (30e6 * 0.01) * 1000 / (math.pi * 0.5**4 / 64),
        0.0043 * 100 / (30e6 * 0.01) * 1000 / (math.pi * 0.5 * 4 / 64),
    ),
    "shaft: the rate divided by 10^6 twice": (
        f"{NSWC}.shaft", {"cycles_to_failure": "1e8 cycle"}, "10⁶/N", MILLION / 1e8, 1e-8
    ),
    "electric motor: a term divided by 10^6 twice": (
        f"{NSWC}.electric_motor", {"bearing_rate": "3 FPMH"}, "λ_BE", 3.0, 3e-6
    ),
    "electric motor: one brush always": (
        f"{NSWC}.electric_motor", {"kind": "bldc", "brushes": None}, "λ_BS", 0.0, 3.2
    ),
    "electric motor: its own rate dropped at a uniform load": (
        f"{NSWC}.electric_motor", {"kind": "dc", "service": "uniform", "brushes": None}, "rate",
        2.17 + 40 + 2 * 3.2 + 0.001, 40 + 2 * 3.2 + 0.001,
    ),
    "coupling: gears divided by 10^6 twice": (
        f"{NSWC}.coupling", {"gear_rate": "2e-6 1/cycle"}, "λ_GR", 2.0, 2e-6
    ),
    "coupling: no seals": (f"{NSWC}.coupling", {"seal_rate": "2e-6 1/cycle"}, "λ_SE", 2.0, 0.0),
    "battery: primary cells for Li-ion": ("general.battery", {"chemistry": "Li-ion"}, "λ0", 150, 20),
}  # fmt: skip
"""The kind, inputs but for plausible ones, a factor, a rate per 10⁶, or one without some factors; right, and wrong."""


@each_case("fault", NUMBERS)
def test_fault(fault):
    kind, changed, what, right, wrong = NUMBERS[fault]
    model = handbook_model(kind)
    given = {key: value for key, value in {**plausible(kind), **changed}.items() if value is not None}
    explained = model.explain(model.settle(given))
    leaves = {leaf.symbol: float(np.asarray(leaf.value)) for leaf in explained.leaves()}
    whole = float(np.asarray(explained.value)) * MILLION
    if isinstance(what, tuple):
        found = whole / math.prod(leaves[symbol] for symbol in what[1])
    else:
        found = whole if what == "rate" else leaves[what]
    assert found == pytest.approx(right, rel=1e-9)
    assert wrong is None or found != pytest.approx(wrong, rel=0.01)


CLOCKS = {
    "actuator: cycles for hours": f"{NSWC}.actuator_axial_load",
    "actuator: cycles for hours, side load": f"{NSWC}.actuator_side_load",
    "shaft: cycles for hours": f"{NSWC}.shaft",
    "coupling: cycles for hours": f"{NSWC}.coupling",
}


@each_case("fault", CLOCKS)
def test_clock(fault):
    assert handbook_model(CLOCKS[fault]).unit == "1/cycle"


REFUSED = {
    "diode: piS undefined above S = 1": (
        f"{MIL}.diode_low_frequency", {"voltage": "12 V", "rated_voltage": "10 V"},
        "the reverse voltage 12 V is more than the rated voltage 10 V: outside"
    ),
    "all: no range is checked": (f"{MIL}.capacitor", {"temperature": "900 degC"}, "temperature 900 degC is outside"),
    "all: a choice that is not known counts 1.0": (f"{MIL}.capacitor", {"style": "0"}, "style '0' is not one of its"),
    "all: a factor typed by the user": (f"{MIL}.capacitor", {"quality": "7.5"}, "quality '7.5' is not one of its"),
    "motor: lambda1 and lambda2 by choice": (f"{MIL}.motor", {"design_life": None}, "needs the input 'design_life'"),
    "crystal: 16 million MHz": (f"{MIL}.crystal", {"frequency": "16e6 MHz"}, "frequency 16000000 MHz is outside"),
    "actuator: a piston as wide as its bore": (
        f"{NSWC}.actuator_axial_load", {"bore": "50 mm", "piston_diameter": "50 mm"},
        "the piston's diameter is not smaller than the cylinder's bore"
    ),
}  # fmt: skip


@each_case("fault", REFUSED)
def test_refused(fault):
    kind, changed, message = REFUSED[fault]
    given = {key: value for key, value in {**plausible(kind), **changed}.items() if value is not None}
    with pytest.raises(ModelError, match=message):
        handbook_model(kind).settle(given)


@each_case("kind", ["resistor", "capacitor", "relay", "fuse", "crystal"])
def test_only_three_environments(kind):
    assert len(set(ENVIRONMENTS) & set(handbook_model(f"{MIL}.{kind}").inputs["environment"].options)) >= 13


@each_case("n", [2, 3, 5])
def test_parallel_parts_as_the_sum_of_rates_by_the_harmonic_number(n):
    """Of n equal parts in parallel the mean life is H_n/λ; the tool has n·λ/H_n for its inverse, nλ too many."""
    rate, names = 1e-3, [f"part {i}" for i in range(n)]
    structure = Structure(Parallel(*names))

    def reliability(hours):
        works = math.exp(-rate * hours)
        return float(structure.state(np.full((n, 1), works), np.full((n, 1), 1 - works)).works.item())

    mean_life, _ = quad(reliability, 0, 40 / rate, limit=200, epsrel=1e-8)
    harmonic = sum(1 / k for k in range(1, n + 1))
    assert mean_life == pytest.approx(harmonic / rate, rel=1e-6)
    assert 1 / mean_life != pytest.approx(n * rate / harmonic, rel=0.05)


def test_stress_scaling_of_a_stated_rate():
    """λ = λ0 · (P/P0)³ · 2^((T − T0)/10), which is right where the handbook's model does not answer itself."""
    cubic, q10 = acceleration_model("cubic_load"), acceleration_model("q10")
    load = cubic.evaluate(cubic.settle({"load": 1.2, "reference_load": 0.8})).value
    heat = q10.evaluate(q10.settle({"temperature": "45 degC", "reference_temperature": "25 degC"})).value
    assert load * heat == pytest.approx(1.5**3 * 2**2, rel=1e-12)
