"""How the paper came to its rates: its own figures out of the handbooks' formulas and tables, with what went wrong.

Table 17 prints three digits; the 2020 tool's file of the robot has the same rates to all digits. Those were multiplied
from the factors that MIL-HDBK-217F prints, which are its equations at the rows of its tables, rounded to two digits. A
product of such factors gives away its rows, because few of them share a prime. The rounded equations were compared with
the printed tables: they agree but for πV of mica at S = 1 (166) and πC of electrolytes below 100 pF (0.04, 0.07).
"""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from robophm.core.table import Table
from robophm.design.file import load
from robophm.hazard.handbooks import handbook_model
from robophm.hazard.model import Choice

OTA = Path(__file__).parents[2] / "examples" / "ota"

# The 2020 tool's own file of the robot (release 1.0.3, phm_start/params/last_configurations.yaml), 1/h, of all pieces.
BOARD, DRIVER = "Power/Battery Control Board/", "Power/Low Level Control Unit DSK-MD/"
TOOL = {
    BOARD: {
        "Capacitor": 2.620970352e-4, "Thermistor": 6.597e-5, "Diode": 1.00060260699e-5, "LED": 4.5e-5,
        "Resistor": 3.4476e-6, "Trimpot": 7.26e-6, "Step Down Switching Regulator": 2.772e-6,
        "Terminal Block or Connector": 1.9872e-5, "Connector or Socket": 1.1781e-7, "Inductor": 4.0565e-7,
        "Current Sensor": 5e-7, "Female Header": 1.9e-6,
    },
    DRIVER: {
        "XT60 Socket": 3.01056e-7, "Zener Diode": 2.50150651746e-6, "Ultrafast Diode": 2.117664e-6,
        "Aluminum Capacitor": 5.58404e-7, "Micro USB Connector": 6.072e-7, "16MHz Cryst. Osc.": 7.37924964446e-8,
        "32.768kHz Cryst. Osc.": 1.77671632204e-8, "Resistors": 3.2438016e-5, "STM32F407VGT6": 1e-8,
        "Resettable Fuse": 4.6e-6,
    },
    "Sensing/IPS/": {
        "Antenna": 5.8e-7, "Micro USB Connector": 6.072e-7, "DW1000 Chip": 8.6e-8, "Resistor": 2.22768e-6,
        "Capacitor": 4.6803042e-6,
    },
    "Communication/DSK-M/": {
        "Resistor": 4.0777344e-6, "Capacitor": 1.493442522e-6, "25MHz Crystal Oscillator": 2.7e-7,
        "16MHz Crystal Oscillator": 2.45974988149e-8, "STM32F407VGT6": 2.3e-7, "SN65HVD230DR": 1.7e-7, "Fuse": 3.2e-7,
        "LAN8720A-CP": 5.9e-7, "Micro USB Connector": 2.4288e-6,
    },
    "Mobility/": {
        "Encoder": 1.16e-5, "Driver wheel": 3.6e-7, "Caster wheel": 2.72e-5, "DC Motor": 1.6082006e-5,
        "Bearing": 1.44504e-10,
    },
}  # fmt: skip
SUB_MODULE = {
    BOARD: "Power/Battery Control Board", DRIVER: "Power/DSK-MD", "Sensing/IPS/": "Sensing/IPS",
    "Communication/DSK-M/": "Communication/DSK-M",
}  # fmt: skip


@pytest.fixture(scope="module")
def table_17():
    """The paper's rate of one piece, and how many there are."""
    return {part.path: (part.modes[0].rate, part.quantity) for part in load(OTA / "robot.yaml").all_components()}


@pytest.fixture(scope="module")
def tool(table_17):
    """The same by the tool's file, to all digits."""
    totals = {place + name: total for place, parts in TOOL.items() for name, total in parts.items()}
    return {path: total / table_17[path][1] for path, total in totals.items()}


def prints(rate, printed):
    """Whether a rate, rounded to three digits, is the one that is printed; 5.795e-8 may be 5.79e-8 or 5.80e-8."""
    return abs(rate - printed) <= 0.50001 * 10 ** (math.floor(math.log10(printed)) - 2)


def test_the_guides_sub_modules_are_the_sums_of_these(tool, table_17):
    """Which counts the crystal of 25 MHz twice, as the tool's file does."""
    guide = {part.path: part.modes[0].rate for part in load(OTA / "guide.yaml").all_components()}
    for place, sub_module in SUB_MODULE.items():
        total = math.fsum(TOOL[place].values()) + TOOL[place].get("25MHz Crystal Oscillator", 0.0)
        assert total == pytest.approx(guide[sub_module], rel=1e-12)


def test_table_17_prints_them_but_for_crystals_and_zener_diodes(tool, table_17):
    other = {path for path, rate in tool.items() if not prints(rate, table_17[path][0])}
    assert {path.rpartition("/")[2] for path in other} == {
        "16MHz Cryst. Osc.", "32.768kHz Cryst. Osc.", "25MHz Crystal Oscillator", "16MHz Crystal Oscillator",
        "Zener Diode",
    }  # fmt: skip
    assert tool[DRIVER + "Zener Diode"] == pytest.approx(tool[BOARD + "Diode"], rel=1e-11)


def test_why_table_17_is_not_the_guide(tool, table_17):
    """The differences that examples/ota/README.md states."""

    def excess(place, *names):
        return math.fsum((table_17[place + name][0] - tool[place + name]) * table_17[place + name][1] for name in names)

    page = (OTA / "README.md").read_text(encoding="utf-8")
    of_driver = excess(DRIVER, "16MHz Cryst. Osc.", "32.768kHz Cryst. Osc."), -excess(DRIVER, "Zener Diode")
    assert (
        "crystals in Hz (+{:.2f}e-6) and other Zener diodes (−{:.2f}e-6)".format(*(1e6 * x for x in of_driver)) in page
    )
    crystals = excess("Communication/DSK-M/", "16MHz Crystal Oscillator", "25MHz Crystal Oscillator")
    twice = tool["Communication/DSK-M/25MHz Crystal Oscillator"]
    assert f"crystals in Hz (+{1e6 * crystals:.2f}e-6)" in page
    assert f"counts that of 25 MHz twice ({1e6 * twice:.2f}e-6)" in page


# Figures that come out of a formula.


@pytest.mark.parametrize(
    ("crystal", "megahertz", "environment"),
    [
        (DRIVER + "16MHz Cryst. Osc.", 16, "GF"), (DRIVER + "32.768kHz Cryst. Osc.", 0.032768, "GF"),
        ("Communication/DSK-M/16MHz Crystal Oscillator", 16, "GB"),
        ("Communication/DSK-M/25MHz Crystal Oscillator", 25, "GM"),
    ],
)  # fmt: skip
def test_table_17_has_hertz_where_megahertz_belong(table_17, tool, crystal, megahertz, environment):
    """λb = 0.013 f^0.23: a million times the frequency, 10^(6 · 0.23) = 24 times the rate. The tool's file has MHz."""
    inputs = {"frequency": megahertz, "quality": "MIL-SPEC", "environment": environment}
    right = handbook_model("mil_hdbk_217f.crystal").evaluate(inputs).value
    assert prints(right * 10 ** (6 * 0.23), table_17[crystal][0])
    assert tool[crystal] == pytest.approx(right, rel=0.01 if megahertz == 25 else 1e-11)  # 25 MHz: λb as printed, 0.027


@pytest.mark.parametrize(
    ("fuse", "environment"), [("Communication/DSK-M/Fuse", "GM"), (DRIVER + "Resettable Fuse", "CL")]
)
def test_a_fuse_of_a_vehicle_and_one_of_a_cannon(tool, fuse, environment):
    rate = handbook_model("mil_hdbk_217f.fuse").evaluate({"environment": environment}).value
    assert tool[fuse] == pytest.approx(rate, rel=1e-12)


def test_the_battery_is_of_primary_cells(table_17):
    assert table_17["Power/Battery"][0] == pytest.approx(
        handbook_model("general.battery").evaluate({"chemistry": "primary"}).value, rel=1e-12
    )


def test_the_bearing_lacks_a_million(tool):
    """One turn a minute at the rated load, with the numerator of C_R = 0.223/(ln 100/R)^⅔ alone for the factor."""
    model = handbook_model("nswc_11.bearing")
    given = {
        "kind": "ball", "speed": "1 rpm", "load": "10 kN", "dynamic_rating": "10 kN", "service": "light_shock",
        "cleanliness": "normal", "bore": "17 mm", "specified_viscosity": "100 mm^2/s",
        "lubricant_viscosity": "100 mm^2/s", "water": "0 percent", "temperature": "25 degC",
    }  # fmt: skip
    rate = model.evaluate(model.settle(given)).value * math.log(100 / 50) ** (2 / 3)
    assert rate == pytest.approx(60e-6 * 0.223 * 1.5 * 1.8, rel=1e-12)
    assert tool["Mobility/Bearing"] == pytest.approx(rate / 1e6, rel=1e-9)


def test_the_motor_has_no_windings_and_one_brush(tool):
    """Windings count 1 instead of 10⁶/25,000 h, a brush is missing; shaft, bearing and gear are a millionth each."""
    model = handbook_model("nswc_11.electric_motor")
    given = {"kind": "dc", "service": "medium_impact", "temperature": "30 degC", "brushes": 1, "winding_life": "1e6 h"}
    slips = 3 * 1e-6 * 1e-6
    assert tool["Mobility/DC Motor"] == pytest.approx(model.evaluate(model.settle(given)).value + slips, rel=1e-12)


# Figures that were multiplied from printed factors: all the ways in which their digits come about.

TEMPERATURES = np.arange(20.0, 160, 10)
STRESSES = np.arange(1, 11) / 10
MICROFARADS = np.array([
    1e-6, 1e-5, 1e-4, 1e-3, 0.01, 0.05, 0.1, 0.5, 1, 3, 8, 18, 40, 200, 1000, 3000, 10000, 30000, 60000, 120000,
])  # fmt: skip
WATTS = np.array([0.001, 0.01, 0.125, 0.25, 0.5, 0.75, 1, 2, 3, 4, 5, 10, 25, 50, 100, 150])
CONTACTS = np.array([*range(1, 21), *range(25, 181, 5)], dtype=float)
OHMS_PER_VOLT = np.array([0.05, 0.15, 0.3, 0.5, 0.7, 0.9])  # one of each band, as the matings
ROWS = {
    "capacitor": {"temperature": TEMPERATURES, "capacitance": MICROFARADS, "dc_voltage": STRESSES,
                  "series_resistance": OHMS_PER_VOLT},
    "resistor": {"temperature": TEMPERATURES, "power": WATTS, "stress": STRESSES[:9]},
    "diode_low_frequency": {"temperature": np.arange(25.0, 180, 5), "voltage": STRESSES[2:]},
    "optoelectronic": {"temperature": np.arange(25.0, 120, 5)},
    "connector": {"temperature": np.array([25.0, *range(20, 260, 10)]), "matings": np.array([0.05, 0.5, 5, 50, 100])},
    "connector_socket": {"contacts": CONTACTS},
    "coil": {"temperature": np.array([25.0, *range(20, 200, 10)])},
}  # fmt: skip
FIXED = {
    "capacitor": {"ac_voltage": 0.0, "rated_voltage": 1.0},
    "diode_low_frequency": {"power": 0.0, "package": "unknown", "rated_voltage": 1.0, "junctions": 1.0},
    "optoelectronic": {"power": 0.0, "package": "unknown"},
    "connector": {"current": 0.0, "wire_gauge": "20", "half": "mated pair"},
    "coil": {"rise_from": "stated", "temperature_rise": 0.0},
}


def two_digits(values):
    """Rounded as tables are: 0.4365 is 0.44."""
    step = 10.0 ** (np.floor(np.log10(values)) - 1)
    return np.round(values / step) * step


def distinct(options):
    """Of styles that have the same row the first."""
    if not isinstance(options, Table):
        return list(options)
    return list({row: option for option, row in reversed(options.rows.items())}.values())


def ways(section, rate, tolerance=1e-9, rounded=("πT", "πC", "πV", "πP", "πS"), **rows):
    """Every choice of words and printed rows of a section of MIL-HDBK-217F whose factors multiply to a rate [1/h]."""
    model, fixed = handbook_model(f"mil_hdbk_217f.{section}"), FIXED.get(section, {})
    words = {
        name: distinct(entry.options)
        for name, entry in model.inputs.items()
        if isinstance(entry, Choice) and name not in fixed and name not in ("quality", "environment")
    }
    qualities, environments = model.inputs["quality"].options, model.inputs["environment"].options
    closing = [(quality, environment) for quality in distinct(qualities) for environment in environments]
    last_factors = np.array([qualities[quality] * environments[environment] for quality, environment in closing])
    axes = ROWS[section] | rows
    given = dict(zip(axes, np.meshgrid(*axes.values(), indexing="ij"), strict=True))
    if "stress" in given:
        given["rated_power"] = given["power"] / given.pop("stress")
    found = set()
    for chosen in itertools.product(*words.values()):
        said = dict(zip(words, chosen, strict=True))
        factors = model.explain({**fixed, **said, **given, "quality": closing[0][0], "environment": closing[0][1]})
        product = np.ones(next(iter(given.values())).shape)
        for factor in factors.leaves():
            if factor.symbol not in ("πQ", "πE"):
                product = product * (two_digits(factor.value) if factor.symbol in rounded else factor.value)
        for *place, last in np.argwhere(abs(product[..., None] * last_factors / rate - 1) < tolerance):
            at = {name: float(axis[i]) for (name, axis), i in zip(axes.items(), place, strict=True)}
            if said.get("style") not in ("CSR", "CWR"):
                at.pop("series_resistance", None)  # of tantalum capacitors alone
            found.add((*chosen, *at.values(), *closing[last]))
    return found


def environments_of(found):
    return {way[-1] for way in found}


@pytest.mark.parametrize(
    ("path", "count"),
    [(BOARD + "Capacitor", 6), ("Sensing/IPS/Capacitor", 6), ("Communication/DSK-M/Capacitor", 3)],
)
def test_the_ceramic_capacitors_are_shot_from_a_cannon(tool, path, count):
    found = ways("capacitor", tool[path])
    assert len(found) == count
    assert {way[0] for way in found} == {"CK"}
    assert environments_of(found) == {"CL"}
    assert ("CK", 50.0, 18.0) in {way[:3] for way in found}


def test_the_aluminium_capacitor_is_of_paper(tool):
    """At 30 °C, 10 pF, its full rated voltage, naval sheltered: no other rows give its digits."""
    assert ways("capacitor", tool[DRIVER + "Aluminum Capacitor"]) == {("CP", 30.0, 1e-5, 1.0, "commercial", "NS")}


def test_the_inductor_is_variable_and_in_a_cannon(tool):
    assert ways("coil", tool[BOARD + "Inductor"]) == {("variable", 80.0, "M", "CL")}


def test_the_ultrafast_diode_flies_in_a_fighter(tool):
    found = ways("diode_low_frequency", tool[DRIVER + "Ultrafast Diode"])
    assert environments_of(found) == {"AUF"}
    fast = {way for way in found if way[0] == "fast_recovery_power_rectifier"}
    assert fast == {("fast_recovery_power_rectifier", "spring", 45.0, 0.3, "JAN", "AUF")}


def test_so_does_the_other_diode(tool):
    """Its stress factor is not rounded: S^2.43, at 0.75 by hundredths and at no other."""
    hundredths = np.arange(31, 101) / 100
    found = ways("diode_low_frequency", tool[BOARD + "Diode"], rounded=("πT",), voltage=hundredths, tolerance=1e-11)
    assert environments_of(found) == {"AUF"}
    assert {way[3] for way in found} == {0.75}
    assert ("general_purpose_analog", "bonded", 35.0, 0.75, "lower", "AUF") in found


@pytest.mark.parametrize(
    ("path", "styles", "watts"),
    [
        (BOARD + "Resistor", "RB RC RW", {2, 10}), (DRIVER + "Resistors", "RA RB RW", {0.5, 5}),
        ("Sensing/IPS/Resistor", "RB RC RW", {1, 2, 25}),
        ("Communication/DSK-M/Resistor", "RA RB RTH RW", {0.5, 5, 50, 100}),
    ],
)  # fmt: skip
def test_no_resistor_is_a_film_of_milliwatts(tool, path, styles, watts):
    """RC is composition, RA, RB and RW stand for all that have their rows, which are wirewound; films are R[LNMDZ]."""
    found = ways("resistor", tool[path])
    assert {way[0] for way in found} == set(styles.split())
    assert {way[2] for way in found} == watts


def test_the_connectors(tool):
    small = ways("connector", tool["Sensing/IPS/Micro USB Connector"])
    large = ways("connector", tool["Communication/DSK-M/Micro USB Connector"])
    assert {way[:2] for way in small | large} == {("rectangular", 30.0)}
    assert ("rectangular", 30.0, 0.5, "MIL-SPEC", "GM") in small
    assert ("rectangular", 30.0, 50.0, "lower", "GM") in large
    blocks = ways("connector", tool[BOARD + "Terminal Block or Connector"])
    assert len(blocks) == 45
    assert ("rectangular", 50.0, 5.0, "lower", "GM") in blocks


def test_a_plug_of_two_contacts_is_a_socket_of_seventy(tool):
    found = ways("connector_socket", tool[DRIVER + "XT60 Socket"])
    assert found == {("IC", 70.0, "lower", "GM"), ("IC", 70.0, "lower", "MF")}
    assert not ways("connector", tool[DRIVER + "XT60 Socket"])


def test_a_connector_is_a_transistors_socket(tool):
    assert ways("connector_socket", tool[BOARD + "Connector or Socket"]) == {
        ("transistor", 6.0, "lower", "AUC"),
        ("transistor", 40.0, "MIL-SPEC", "GM"),
        ("transistor", 40.0, "MIL-SPEC", "MF"),
    }  # fmt: skip


def test_what_no_row_explains(tool):
    """To the three digits of the paper. A trimmer's three digits have too many ways."""
    assert not {way for way in ways("resistor", tool[BOARD + "Thermistor"], tolerance=7e-4) if way[0] == "RTH"}
    assert not ways("optoelectronic", tool[BOARD + "LED"], tolerance=1e-3)
    assert len(ways("resistor", tool[BOARD + "Trimpot"], tolerance=2e-3)) > 200


def test_the_zener_diode_is_nearly_explained(table_17):
    model = handbook_model("mil_hdbk_217f.diode_low_frequency")
    given = {"kind": "voltage_regulator_zener", "temperature": "35 degC", "power": "0 W", "contact": "bonded"}
    rate = model.evaluate(model.settle({**given, "environment": "GM"})).value
    assert rate == pytest.approx(2e-9 * 8 * 9 * math.exp(1925 * (1 / 298 - 1 / 308)), rel=1e-12)
    assert rate == pytest.approx(table_17[DRIVER + "Zener Diode"][0], rel=0.004)
    assert not prints(rate, table_17[DRIVER + "Zener Diode"][0])
