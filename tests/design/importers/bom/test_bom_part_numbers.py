"""Makers' part numbers against what distributors and data sheets print beside them; odd ways of writing values."""

import pytest

from robophm.design.importers.bom.codes import coded, preferred, written
from robophm.design.importers.bom.part_numbers import part_number
from robophm.design.importers.bom.parts import Described, recognise
from robophm.design.importers.bom.reading import read_parts

PRINTED = {  # number: kind, value, size, rated voltage, tolerance, as printed beside it by those who sell it
    "GRM188R71C104KA01D": ("capacitor", "100 nF", "0603", "16 V", "10 %"),
    "GRM1885C1H220JA01D": ("capacitor", "22 pF", "0603", "50 V", "5 %"),
    "GRM21BR61A106KE19L": ("capacitor", "10 uF", "0805", "10 V", "10 %"),
    "GCM21BR72A104KA37L": ("capacitor", "100 nF", "0805", "100 V", "10 %"),
    "CC0402KRX7R7BB103": ("capacitor", "10 nF", "0402", "16 V", "10 %"),
    "CL21A106KAYNNNE": ("capacitor", "10 uF", "0805", "25 V", "10 %"),
    "CL31B226MPHNNNE": ("capacitor", "22 uF", "1206", "10 V", "20 %"),
    "C1005C0G1H080C050BA": ("capacitor", "8 pF", "0402", "50 V", "0.25 %"),
    "C3216X5R1A107M160AC": ("capacitor", "100 uF", "1206", "10 V", "20 %"),
    "CGA9P3X7S2A156M": ("capacitor", "15 uF", "2220", "100 V", "20 %"),
    "06033C103JAT2A": ("capacitor", "10 nF", "0603", "25 V", "5 %"),
    "C0402C562K5RACTU": ("capacitor", "5.6 nF", "0402", "50 V", "10 %"),
    "LMK212BJ475KD-T": ("capacitor", "4.7 uF", "0805", "10 V", "10 %"),
    "581-TPSB107K006R0400": ("capacitor", "100 uF", None, "6.3 V", "10 %"),
    "T495C686M016ATE250": ("capacitor", "68 uF", None, "16 V", "20 %"),
    "293D476X9020D2TE3": ("capacitor", "47 uF", None, "20 V", None),
    "EEEFP1E471AP": ("capacitor", "470 uF", None, "25 V", None),
    "RC0603FR-073K3L": ("resistor", "3.3 kohm", "0603", None, "1 %"),
    "RC0402FR-071ML": ("resistor", "1 Mohm", "0402", None, "1 %"),
    "CRCW060320K0FKEA": ("resistor", "20 kohm", "0603", None, "1 %"),
    "ERJ-3GEYJ101V": ("resistor", "100 ohm", "0603", None, "5 %"),
    "ERJ-3EKF1202V": ("resistor", "12 kohm", "0603", None, "1 %"),
    "ERJ-3GEY0R00V": ("resistor", "0 ohm", "0603", None, None),
    "ERA-2AEB103X": ("resistor", "10 kohm", "0402", None, "0.1 %"),
    "RK73H1JTTD4R70F": ("resistor", "4.7 ohm", "0603", None, "1 %"),
    "RMCF0402FT9K09": ("resistor", "9.09 kohm", "0402", None, "1 %"),
    "0402WGF4752TCE": ("resistor", "47.5 kohm", "0402", None, "1 %"),
    "MCT06030C5109FP500": ("resistor", "51 ohm", "0603", None, "1 %"),
    "WSLP27261L000FEA": ("resistor", "1 mohm", "2726", None, "1 %"),
    "CSR2512C0R0005F": ("resistor", "500 uohm", "2512", None, "1 %"),
    "CF14JT10K0CT-ND": ("resistor", "10 kohm", None, None, "5 %"),
    "EXB-2HV104JV": ("resistor network", "100 kohm", None, None, "5 %"),
    "NCP15XH103F03RC": ("thermistor", "10 kohm", "0402", None, "1 %"),
    "SDR0805-220ML": ("inductor", "22 uH", None, None, None),
    "MLZ2012M470WTD25": ("inductor", "47 uH", None, None, None),
    "NRG4026T4R7M": ("inductor", "4.7 uH", None, None, None),
    "BLM21PG221SN1D": ("ferrite bead", None, "0805", None, None),
}


@pytest.mark.parametrize("number", PRINTED)
def test_a_number_says_what_is_printed_beside_it(number):
    kind, value, size, volts, tolerance = PRINTED[number]
    found = part_number("bought as", number)
    assert found.kind == kind
    values = {found.facts.get(fact) for fact in ("capacitance", "resistance", "inductance")} - {None}
    assert values == ({value} if value else set())
    assert (found.facts.get("size"), found.facts.get("rated_voltage")) == (size, volts)
    assert found.facts.get("tolerance") == tolerance


@pytest.mark.parametrize("number", ["STM32F405RGT6", "LM358P", "1N4148", "NTMFS4937NT1G", "C173752", "10103594-0001LF"])
def test_no_other_number_is_one(number):
    assert part_number(number) is None


@pytest.mark.parametrize(
    ("code", "tight", "number"),
    [("104", False, 1e5), ("4R7", False, 4.7), ("R47", False, 0.47), ("470", False, 47), ("109", False, 1.0),
     ("1202", True, 12e3), ("5109", True, 51.0), ("330J", True, 33.0), ("20K0", False, 20e3), ("1L000", False, 1e-3),
     ("000", False, 0.0), ("K", False, None), ("12345", False, None)],
)  # fmt: skip
def test_codes(code, tight, number):
    """EIA: two or three digits and a power of ten, 9 and 8 (or J, K) for tenths and hundredths; a letter as point."""
    assert coded(code, tight=tight) == (None if number is None else pytest.approx(number))


def test_preferred_numbers_and_prefixes():
    assert [number for number in (100, 102, 103, 104, 105, 470, 475, 910) if preferred(number)] == [
        100, 102, 105, 470, 475, 910,
    ]  # fmt: skip
    assert [written(value, "F") for value in (1e-7, 4.7e-6, 2.2e-11)] == ["100 nF", "4.7 uF", "22 pF"]


@pytest.mark.parametrize(
    ("reference", "value", "kind", "fact"),
    [
        ("C1", "10UF", "capacitor", "10 uF"),
        ("C1", "100nf", "capacitor", "100 nF"),
        ("C1", ".1uF", "capacitor", "0.1 uF"),
        ("C1", "CAP CER 4.7UF", "capacitor", "4.7 uF"),
        ("C1", "104", "capacitor", "100 nF"),
        ("C1", "u1", "capacitor", "0.1 uF"),
        ("C1", "0,1µF", "capacitor", "0.1 uF"),
        ("C1", "100 n", "capacitor", "100 nF"),
        ("C1", "10uF/16V", "capacitor", "10 uF"),
        ("C1", "100", "capacitor", None),
        ("C1", "0.1", "capacitor", None),  # pF or a code, µF or nothing: not taken
        ("R1", "4k7", "resistor", "4.7 kohm"),
        ("R1", "4K7", "resistor", "4.7 kohm"),
        ("R1", "R005", "resistor", "0.005 ohm"),
        ("R1", "470E", "resistor", "470 ohm"),
        ("R1", "10 kOhm", "resistor", "10 kohm"),
        ("R1", "104", "resistor", "100 kohm"),
        ("R1", "105", "resistor", "105 ohm"),  # of E96, and so no code
        ("L1", "10u", "inductor", "10 uH"),
        ("L1", "600R@100MHz", "ferrite bead", None),
        ("X1", "16MHz", "crystal", "16 MHz"),
        ("CBYP1", "1uF", "capacitor", "1 uF"),
        ("U3", "2.2uF", "capacitor", "2.2 uF"),
    ],
)
def test_values_as_people_write_them(reference, value, kind, fact):
    found = recognise((reference,), Described(value=value))
    names = {"capacitance", "resistance", "inductance", "frequency"}
    assert (found.kind, next((text for name, text in found.facts.items() if name in names), None)) == (kind, fact)


@pytest.mark.parametrize(
    ("reference", "row", "kind", "words"),
    [
        ("R5", {"value": "10uF"}, "capacitor", "its reference is of a resistor; taken for a capacitor"),
        ("C5", {"value": "10k"}, "", "its value is of a resistor, its reference of a capacitor; neither is taken"),
        ("R5", {"value": "10k", "part_number": "GRM188R71C104KA01D"}, "capacitor", "its reference is of a resistor"),
        (
            "R5",
            {"value": "5.6k", "part_number": "RC0603FR-0756KL"},
            "resistor",
            "by its maker's number 56 kohm, by its value",
        ),
        (
            "C5",
            {"value": "1uF", "description": "CAP CER 0.1UF", "part_number": "GRM188R71C104KA01D"},
            "capacitor",
            "by its words 0.1 uF, by its value 1 uF; 0.1 uF is taken",
        ),
    ],
)
def test_cells_that_contradict_each_other_are_told(reference, row, kind, words):
    found = recognise((reference,), Described(**row))
    assert found.kind == kind
    assert words in "; ".join(found.contradictions)


def test_quantities_for_many_boards_are_told_and_one_board_is_taken(tmp_path):
    """As spreadsheets of costs have them, for the number of boards that somebody wants to build."""
    path = tmp_path / "cost.csv"
    path.write_text('Refs,Value,Manf#,Qty\n"R1,R2",10k,RC0603FR-0710KL,200\nC1,100nF,,100\n"U1-U3",LM358,,300\n')
    found = read_parts(path)
    assert [part.quantity for part in found.parts] == [2, 1, 3]
    assert [str(note) for note in found.notes] == ["row 1: all quantities are for 100 boards; one is taken"]
    path.write_text('Refs,Value,Manf#,Qty\n"R1,R2",10k,RC0603FR-0710KL,200\nC1,100nF,,100\n"U1-U3",LM358,,3\n')
    assert [part.quantity for part in read_parts(path).parts] == [200, 100, 3]  # the larger, and each is told
