"""Units at the edges: what people write is converted, what they cannot mean is refused in one line, at once."""

import math
import subprocess
import sys
import time

import pytest
from tests.cases import each_case

from robophm.core.errors import UnitError
from robophm.core.units import _USUAL, _of_pint, conversion, quantity, told


@each_case(
    ("written", "inside", "expected"),
    [
        ("12 FIT", "1/h", 12e-9),
        ("12FIT", "1/h", 12e-9),
        ("0.3 FPMH", "1/h", 0.3e-6),
        ("5.8e-6 /h", "1/h", 5.8e-6),
        ("5.8e-6 1/h", "1/h", 5.8e-6),
        ("5.8e-6 per h", "1/h", 5.8e-6),
        ("0.3 /10^6 h", "1/h", 3e-7),
        ("0.3 per 10^6 h", "1/h", 3e-7),
        ("876.6 /year", "1/h", 0.1),
        ("2e-5 /km", "1/km", 2e-5),
        ("1 /m", "1/km", 1000.0),
        ("1e-7 /cycle", "1/cycle", 1e-7),
        ("20 min", "h", 1 / 3),
        ("1 day", "h", 24.0),
        ("1.5 kh", "h", 1500.0),
        ("77 degF", "degC", 25.0),
        ("300 K", "degC", 26.85),
        ("-40 °C", "degC", -40.0),
        ("15 K", "delta_degC", 15.0),
        ("9 delta_degF", "delta_degC", 5.0),
        ("3.6 km/h", "m/s", 1.0),
        ("1.2 km/h", "km/h", 1.2),
        ("250 m", "m", 250.0),
        ("40 cycle/h", "cycle/h", 40.0),
        ("40 cycles/h", "cycle/h", 40.0),
        ("0.1 start/h", "start/h", 0.1),
        ("0.1 µF", "uF", 0.1),
        ("100 nF", "uF", 0.1),
        ("2 kΩ/V", "ohm/V", 2000.0),
        ("50 %", "", 0.5),
        ("2", "", 2.0),
        (2, "", 2.0),
    ],
)
def test_conversion(written, inside, expected):
    assert quantity(written, inside) == pytest.approx(expected, rel=1e-14, abs=1e-12)


@each_case("number", [3, 7, 12, 433, 804])
def test_powers_of_ten_round_once(number):
    assert quantity(f"{number} FIT", "1/h") == float(f"{number}e-9")
    assert quantity(f"{number} FPMH", "1/h") == float(f"{number}e-6")


@each_case(("written", "inside"), _USUAL)
def test_usual_units_are_what_pint_makes_of_them(written, inside):
    assert _USUAL[written, inside] == _of_pint(written, inside)


def test_a_signal_is_converted_by_scale_and_offset():
    scale, offset = conversion("degF", "degC")
    assert (scale, offset) == pytest.approx((5 / 9, -160 / 9), rel=1e-12)
    assert conversion("K", "degC") == pytest.approx((1.0, -273.15), rel=1e-12)


@each_case(
    ("written", "inside", "says"),
    [
        ("3 h", "1/h", "does not measure what '1/h' does"),
        ("3 /km", "1/h", "does not measure"),
        ("3 cycle", "start", "does not measure"),
        ("3 cycle", "", "does not measure"),
        ("3 h", "", "does not measure what 'none' does"),
        ("15 degC", "delta_degC", "a difference of temperatures is in 'K'"),
        ("15", "delta_degC", "expected e.g. '15 K'"),
        ("12", "1/h", "has no unit; expected e.g. '12 1/h'"),
        (12, "1/h", "has no unit; expected e.g. '12 1/h'"),
        ("3 FITT", "1/h", "unknown unit 'FITT'; did you mean 'FIT'"),
        ("3 degcc", "degC", "did you mean 'degC'"),
        ("", "h", "is not a number"),
        ("h", "h", "is not a number"),
        ("1,5 h", "h", "is not a unit"),
        ("1_000 h", "h", "unknown unit"),
        ("0x10 h", "h", "unknown unit"),
        (True, "", "is not a quantity"),
        (None, "h", "is not a quantity"),
        ([1], "h", "is not a quantity"),
        (b"1 h", "h", "is not a quantity"),
    ],
)
def test_wrong_units(written, inside, says):
    with pytest.raises(UnitError, match=says):
        quantity(written, inside)


HOSTILE = {
    "power tower": "9**9**9",
    "unit tower": "1 h**9**9",
    "digits": "9" * 1_000_000,
    "digits and a unit": "9" * 1_000_000 + " h",
    "letters": "1 " + "h" * 1_000_000,
    "units": "1 " + "h " * 500_000,
    "blanks": " " * 1_000_000,
    "huge integer": 10**5000,
    "huge exponent": "1e400 h",
    "overflow by its unit": "1e308 year",
    "nan": "nan h",
    "infinity": "inf h",
    "float nan": float("nan"),
    "float infinity": float("inf"),
    "arabic digits": "٣ h",
    "full width digits": "３ h",
    "superscript": "3 h²",
    "import": "__import__('os').system('exit')",
    "import as unit": "1 __import__('os')",
    "attribute": "1 _build_cache",
    "lines": "1 h\nh\n\x1b[31m",
    "format": "1 {0.__class__}",
}


@each_case("text", HOSTILE.values(), ids=HOSTILE.keys())
@each_case("inside", ["h", "1/h", ""])
def test_hostile_texts_fail_at_once_in_one_line(text, inside):
    quantity("1 h", "h")  # the registry is loaded
    begun = time.process_time()
    with pytest.raises(UnitError) as error:
        quantity(text, inside)
    assert time.process_time() - begun < 1
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 300
    assert "Traceback" not in str(error.value)


def test_hostile_units_of_signals():
    for unit in ("h" * 100_000, "9**9**9", "__import__('os')", "m\n/s", "K; K"):
        with pytest.raises(UnitError):
            conversion(unit, "degC")


def test_a_million_hours_may_be_written_either_way() -> None:
    assert quantity("0.3 /1e6 h", "1/h") == quantity("0.3 /10^6 h", "1/h") == 3e-7


@each_case(
    ("text", "inside", "value"),
    [("5 °C/W", "K/W", 5.0), ("5 degC/W", "K/W", 5.0), ("9 degF/W", "K/W", 5.0), ("5 K/W", "K/W", 5.0)],
)
def test_a_temperature_beside_another_unit_is_a_difference(text, inside, value):
    assert quantity(text, inside) == pytest.approx(value, rel=1e-12)


@each_case(
    ("text", "inside", "meant"),
    [("25 C", "degC", "degC"), ("25 c", "degC", "degC"), ("77 F", "degC", "degF"), ("25 deg C", "degC", "degC"),
     ("15 C", "delta_degC", "K"), ("25 °", "degC", "degC")],
)  # fmt: skip
def test_what_people_write_for_a_temperature_is_told_its_unit(text, inside, meant):
    with pytest.raises(UnitError, match=f"did you mean '{meant}'"):
        quantity(text, inside)


@each_case(("text", "share"), [("8 h/day", 1 / 3), ("8 h per day", 1 / 3), ("30 %", 0.3), (0.3, 0.3)])
def test_a_share_of_the_day(text, share):
    assert quantity(text, "") == pytest.approx(share, rel=1e-15)


def test_threads_that_begin_at_once_share_their_units():
    """In a process of its own: units are made when they are first asked for."""
    code = (
        "from concurrent.futures import ThreadPoolExecutor; from threading import Barrier\n"
        "from robophm.core.units import conversion\n"
        "written, at_once = ['nFIT', 'kFPMH', '1/day', '/10^5 h'] * 2, Barrier(8)\n"
        "def convert(unit): at_once.wait(); return conversion(unit, '1/h').scale\n"
        "print(*ThreadPoolExecutor(8).map(convert, written))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr[-500:]
    assert [float(scale) for scale in done.stdout.split()] == pytest.approx([1e-18, 1e-3, 1 / 24, 1e-5] * 2, rel=1e-12)


@each_case(
    ("text", "inside", "expected"),
    [
        ("23.5", "degC", 23.5),
        ("23.5 C", "degC", 23.5),
        ("23.5°C", "degC", 23.5),
        ("23.5 [degC]", "degC", 23.5),
        ("74.3 F", "degC", 23.5),
        ("296.65 K", "degC", 23.5),
        ("48.1 V", "V", 48.1),
        ("48100 mV", "V", 48.1),
        ("48.1 Volts", "V", 48.1),
        ("3.2 A", "A", 3.2),
        ("-3200mA", "A", -3.2),
        ("12 %", "", 0.12),
        ("12 %", "percent", 12.0),
        ("1500 RPM", "rad/s", 50 * math.pi),
        ("8.0 N m", "N*m", 8.0),
        ("1.2e1 V", "V", 12.0),
    ],
)
def test_what_devices_say_is_read_with_its_unit(text, inside, expected):
    assert told(text, inside) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "inside"),
    [("N/A", "degC"), ("warming up", "degC"), ("", "V"), ("48 V", "degC"), ("23 C", None), ("23 C", "A"),
     ("1 / 0", "V"), ("nan", "V"), ("12 V 3", "V"), ("9**9**9", ""), ("٣ V", "V")],
)  # fmt: skip
def test_what_cannot_be_read_is_no_number(text, inside):
    assert math.isnan(told(text, inside))
