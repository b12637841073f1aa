"""References, quantities and kinds, by what they mean to a reader of schematics."""

import random

import pytest

from robophm.design.importers.bom import read_parts
from robophm.design.importers.bom.parts import Described, recognise
from robophm.design.importers.bom.quantities import with_points
from robophm.design.importers.bom.references import MOST_REFERENCES, ReferencesError, compressed, expand


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("C1-C4", "C1 C2 C3 C4"),
        ("R1,R2,R5-R7", "R1 R2 R5 R6 R7"),
        ("C1 C2", "C1 C2"),
        ("C1;C2\nC3", "C1 C2 C3"),
        ("C1 – C3, U2", "C1 C2 C3 U2"),
        ("C1..C3", "C1 C2 C3"),
        ("R08-R11", "R08 R09 R10 R11"),
        ("R1-C4", "R1-C4"),
        ("J1-A, J1-B", "J1-A J1-B"),
        ("J2/J3, R1 & R2", "J2 J3 R1 R2"),
        ("C1 und C2, C3 + C4", "C1 C2 C3 C4"),
        ("U1/A", "U1/A"),
        ("U1A", "U1A"),
        ("", ""),
    ],
)
def test_references(text, found):
    assert list(expand(text)) == found.split()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("R1-R999999999", "at most 10,000 references, not the 999,999,999"),
        ("C9-C2", "a range that ascends"),
        ("R1-R6000, R1-R6000", "at most 10,000"),
        (" ".join(f"R{i}" for i in range(10_001)), "at most 10,000"),
    ],
)
def test_wrong_references(text, expected):
    with pytest.raises(ReferencesError, match=expected):
        expand(text)


def test_compressed_lists_expand_to_the_same():
    draw = random.Random(1)
    for _ in range(200):
        references = tuple(
            f"{draw.choice('RC')}{draw.choice(['', '0'])}{draw.randrange(30)}" for _ in range(draw.randrange(20))
        )
        assert expand(compressed(references)) == references
    assert compressed(("R1", "R2", "R5", "R6", "R7")) == "R1, R2, R5-R7"
    assert len(expand(f"R1-R{MOST_REFERENCES}")) == MOST_REFERENCES


@pytest.mark.parametrize(
    ("cell", "quantity"),
    [
        ("3", 3),
        ("3.0", 3),
        ("3,0", 3),
        ("x3", 3),
        ("3 pcs", 3),
        ("5 Stk.", 5),
        ("", 2),
        ("-3", None),
        ("1e99", None),
        ("ten", None),
        ("2.5", None),
        ("99999999999999999999", None),
        ("100001", None),
        ("²", None),
        ("٣", None),
        ("1" * 5000, None),
    ],
)
def test_quantities(tmp_path, cell, quantity):
    path = tmp_path / "list.csv"
    path.write_text(f"Reference;Value;Qty\nQ1,Q2;x;{cell}\nR1;10k;1\n", encoding="utf-8")
    read = read_parts(path)
    assert read.parts[-1].references == ("R1",)  # a faulty row does not block the rest
    if quantity is None:
        assert [(error.row, error.column, error.value) for error in read.errors] == [(2, "Qty", cell[:80])]
        assert "whole number" in read.errors[0].expected
    else:
        assert (read.parts[0].quantity, read.errors) == (quantity, ())


@pytest.mark.parametrize(
    ("header", "cells", "fitted"),
    [
        ("DNP", "DNP", False),
        ("DNP", "", True),
        ("DNP", "0", True),
        ("DNP", "x", False),
        ("Fitted", "Not Fitted", False),
        ("Fitted", "Fitted", True),
        ("Populate", "0", False),
        ("Populate", "1", True),
        ("Notes", "do not populate", False),
        ("Notes", "DNF on rev A", False),
        ("Notes", "NP0 only", True),
        ("Bestückt", "nein", False),
        ("Notes", "N.B.", False),
    ],
)
def test_what_is_not_fitted_is_left_out_and_said(tmp_path, header, cells, fitted):
    path = tmp_path / "list.csv"
    path.write_text(f"Reference,Value,{header}\nC1,100 NF,{cells}\nC2,1u,\n", encoding="utf-8")
    read = read_parts(path)
    assert [part.references[0] for part in read.parts] == (["C1", "C2"] if fitted else ["C2"])
    assert len(read.left_out) == (0 if fitted else 1)


@pytest.mark.parametrize(
    ("reference", "cells", "kind", "facts"),
    [
        (
            "C1",
            {"value": "100nF", "footprint": "0603", "description": "X7R 50V"},
            "capacitor",
            {"capacitance": "100 nF", "dielectric": "X7R", "type": "ceramic", "rated_voltage": "50 V", "size": "0603"},
        ),
        ("C1", {"value": "4u7"}, "capacitor", {"capacitance": "4.7 uF"}),
        ("C1", {"value": "4n7F 1kV"}, "capacitor", {"capacitance": "4.7 nF", "rated_voltage": "1 kV"}),
        (
            "C1",
            {"value": "10 µ/6V3 Tantal"},
            "capacitor",
            {"capacitance": "10 uF", "rated_voltage": "6.3 V", "type": "tantalum"},
        ),
        ("C1", {"value": "100n", "footprint": "Capacitor_SMD:C_0201_0603Metric"}, "capacitor", {"size": "0201"}),
        ("C1", {"value": "100", "footprint": "C_0603"}, "capacitor", {"capacitance": None}),
        ("C1", {"value": "1F", "description": "Supercap 5.5V"}, "supercapacitor", {"capacitance": "1 F"}),
        (
            "R1",
            {"value": "10k", "footprint": "0603", "description": "1%"},
            "resistor",
            {"resistance": "10 kohm", "tolerance": "1 %", "rated_power": "0.1 W"},
        ),
        ("R1", {"value": "4R7"}, "resistor", {"resistance": "4.7 ohm"}),
        ("R1", {"value": "0R"}, "resistor", {"resistance": "0 ohm"}),
        ("R1", {"value": "100"}, "resistor", {"resistance": "100 ohm"}),
        (
            "R1",
            {"value": "1M 1/4W wirewound"},
            "resistor",
            {"resistance": "1 Mohm", "rated_power": "0.25 W", "type": "wirewound"},
        ),
        ("R1", {"value": "10k", "description": "Resistor for the LED driver"}, "resistor", {}),
        ("R5", {"value": "10k", "description": "NTC thermistor"}, "thermistor", {}),
        ("RV1", {"value": "10k", "footprint": "Potentiometer_THT:Bourns"}, "potentiometer", {}),
        ("RV1", {"value": "S14K275"}, "", {}),
        # What real lists of others had wrong, in words of our own.
        ("IC2", {"value": "FT999", "description": "USB to serial bridge"}, "microcircuit", {}),
        ("J2", {"value": "MB-7", "description": "USB micro B"}, "connector", {}),
        ("", {"description": "I2S amplifier add-on"}, "whole device", {}),
        ("F1", {"value": "2A", "footprint": "lands:r_1206", "part_number": "MF-NSMF110-2"}, "resettable fuse", {}),
        ("F2", {"value": "1A", "footprint": "smd_resistors:r_1206"}, "fuse", {}),
        ("D7", {"value": "0.4V", "part_number": "MBRS140"}, "schottky diode", {"rated_voltage": None}),
        ("D8", {"value": "40V", "part_number": "MBRS140"}, "schottky diode", {"rated_voltage": "40 V"}),
        ("C9", {"value": "10U", "description": "electrolytic, 12 V decoupling"}, "capacitor", {"rated_voltage": None}),
        (
            "C9",
            {"value": "10U", "description": "25 V rail", "part_number": "EEU-FR1E100"},
            "capacitor",
            {"rated_voltage": "25 V"},
        ),
        (
            "R3",
            {"value": "0.05 ohm", "footprint": "2512", "note": "0.03 W at 0.75 A"},
            "resistor",
            {"rated_power": "1 W"},
        ),
        ("R3", {"value": "1k", "note": "0.25 W at 70 degC"}, "resistor", {"rated_power": "0.25 W"}),
        ("L5", {"value": "3u3", "library": "Device:L_Ferrite"}, "inductor", {"inductance": "3.3 uH"}),
        ("L6", {"value": "600R", "library": "Device:FerriteBead"}, "ferrite bead", {}),
        ("U5", {"value": "FDC5614P", "footprint": "sot23-6"}, "fet", {}),
        ("P3", {"value": "TST", "footprint": "Measurement_Points:Round"}, "no part", {}),
        ("", {"library": "M5x12mm-socket-head"}, "hardware", {}),
        ("", {"library": "drive-motor-cover"}, "mechanical part", {}),
        ("D1", {"value": "1N4148"}, "diode", {}),
        ("D1", {"value": "RED", "footprint": "LED_SMD:LED_0603"}, "led", {}),
        ("D2", {"value": "BAT54", "description": "Schottky diode"}, "schottky diode", {}),
        ("D3", {"value": "BZX84", "description": "Zener 5V1"}, "zener diode", {"rated_voltage": "5.1 V"}),
        ("Q1", {"value": "BSS138", "description": "N-Channel MOSFET"}, "fet", {}),
        ("Q2", {"value": "BC847", "description": "NPN"}, "bipolar transistor", {}),
        (
            "U1",
            {"value": "DRV8825", "description": "Motor driver", "footprint": "HTSSOP-28"},
            "analog circuit",
            {"pins": "28"},
        ),
        ("", {"value": "DRV8825", "description": "Stepper motor driver"}, "analog circuit", {}),
        ("U2", {"value": "PC817", "description": "Optocoupler"}, "optocoupler", {}),
        ("J1", {"value": "Conn_01x04", "description": "Battery connector"}, "connector", {"pins": "4"}),
        ("Y1", {"value": "16MHz"}, "crystal", {"frequency": "16 MHz"}),
        ("X1", {"value": "16MHz", "footprint": "Crystal:Crystal_SMD_3225"}, "crystal", {}),
        ("X1", {"value": "MKDS", "description": "Schraubklemme 3-polig"}, "connector", {}),
        ("X1", {"value": "X"}, "", {}),
        ("T1", {"value": "BC547"}, "bipolar transistor", {}),
        ("T1", {"value": "type 3"}, "", {}),
        ("F1", {"value": "500mA", "description": "PTC resettable fuse"}, "resettable fuse", {}),
        ("L1", {"value": "10uH 2A"}, "inductor", {"inductance": "10 uH", "rated_current": "2 A"}),
        ("K1", {"value": "G5V", "description": "Solid state relay"}, "solid state relay", {}),
        ("SW1", {"value": "SW_Push"}, "switch", {}),
        ("TP1", {"value": "TestPoint"}, "no part", {}),
        ("FB1", {"value": "600R@100MHz"}, "ferrite bead", {}),
        ("ZZ9", {"value": "thing"}, "", {}),
        ("U1", {"value": "STM32F405", "footprint": "LQFP-64_10x10mm_P0.5mm"}, "microcontroller", {"pins": "64"}),
        ("U1", {"value": "ATmega328P", "description": "8-bit MCU, 32KB Flash"}, "microcontroller", {"bits": "8 bit"}),
        (
            "U3",
            {
                "value": "24LC256",
                "footprint": "Package_SO:SOIC-8_3.9x4.9mm_P1.27mm",
                "description": "EEPROM, DIP-8/SOIC-8",
            },
            "memory",
            {"pins": "8", "bits": "262144 bit", "mounting": "surface"},
        ),
        ("U5", {"value": "W25Q128", "description": "IC FLASH 128MBIT SPI"}, "memory", {"bits": "134217728 bit"}),
        ("U5", {"value": "x", "description": "SRAM 64KB"}, "memory", {"bits": "524288 bit", "type": "SRAM"}),
        ("U4", {"value": "74HC595", "footprint": "TSSOP-16_4.4x5mm_P0.65mm"}, "logic", {"pins": "16"}),
        (
            "U6",
            {"value": "LM7805", "footprint": "TO-220-3"},
            "analog circuit",
            {"pins": "3", "mounting": "through hole"},
        ),
        ("U7", {"value": "XC7A35T"}, "programmable logic", {}),
        ("U8", {"value": "MPU-6050"}, "sensor chip", {}),
        ("U9", {"value": "=Value", "part_number": "STM32F103RCT6"}, "microcontroller", {}),
        ("Q1", {"value": "2N7002", "footprint": "SOT-23"}, "fet", {"rated_power": "0.3 W"}),
        ("Q1", {"value": "IRLZ44N", "footprint": "TO-220"}, "fet", {"rated_power": "100 W", "type": None}),
        (
            "K1",
            {"description": "Relais 24 V, 2 Wechsler, 5 A"},
            "relay",
            {"contact_form": "DPDT", "rated_current": "5 A"},
        ),
        ("K1", {"description": "Reed relay 1 Form A"}, "relay", {"contact_form": "SPST", "type": "reed"}),
        ("SW2", {"value": "SW_DIP_x04", "description": "SPST"}, "switch", {"type": "DIP", "contact_form": "SPST"}),
        ("SW3", {"value": "RotaryEncoder_Switch"}, "encoder", {"type": "with contacts"}),
        ("J1", {"value": "SMA", "description": "CONN SMA JACK"}, "connector", {"type": "radio frequency"}),
        ("J2", {"value": "XT60"}, "connector", {"type": "power"}),
        ("J3", {"value": "Screw_Terminal_01x02"}, "connector", {"pins": "2", "type": None}),
        ("BT1", {"value": "CR2032"}, "battery", {"type": "primary"}),
        ("", {"value": "Li-Ion Akku 48 V"}, "battery", {"type": "lithium ion"}),
        ("M1", {"value": "NEMA17 stepper"}, "motor", {"type": "stepper"}),
        ("", {"value": "standoff M3"}, "hardware", {}),
        ("", {"value": "Screw terminal 2p"}, "connector", {}),
        ("PCB1", {"value": "PCB 4 layers, 320 vias"}, "printed board", {"layers": "4", "holes": "320"}),
        ("R1", {"value": "10k", "footprint": "603"}, "resistor", {"size": "0603", "rated_power": "0.1 W"}),
        ("", {"value": "Gleichstrommotor", "description": "DC motor 24 V"}, "motor", {}),
    ],
)
def test_kinds_and_facts(reference, cells, kind, facts):
    found = recognise((reference,) if reference else (), Described(**cells))
    assert found.kind == kind
    assert {name: found.facts.get(name) for name in facts} == facts


@pytest.mark.parametrize(
    ("text", "comma", "point"),
    [
        ("4,7 µF", "4.7 µF", "4.7 µF"),
        ("1.000 pF", "1000 pF", "1.000 pF"),
        ("1,000 pF", "1.000 pF", "1000 pF"),
        ("0603,1%", "0603,1%", "0603,1%"),
        ("4.7k", "4.7k", "4.7k"),
        ("0,125 W", "0.125 W", "0,125 W"),
    ],
)
def test_decimal_commas(text, comma, point):
    assert (with_points(text, ","), with_points(text, ".")) == (comma, point)


BESIDE = {"footprint": "X_0805"}
"""On a board a value is often a label."""


@pytest.mark.parametrize(
    ("reference", "words", "kind"),
    [
        ("B1", "#6-32 x 1/4 Button Head Screw", "hardware"), ("S1", "Button Head Screw M3", "hardware"),
        ("K1", "M3x10 socket head cap screw", "hardware"), ("M1", "M3 nut", "hardware"),
        ("S10", '0.25" Pillow Bearing Block', "mechanical part"), ("S30", "Wheel", "mechanical part"),
        ("C1", "Caster wheel", "mechanical part"), ("L4", "Lidar mount bracket", "mechanical part"),
        ("R1", "Robot chassis", "mechanical part"), ("", "Servo horn", "mechanical part"),
        ("", "Battery holder", "mechanical part"), ("", "Linear bearing LM8UU", "mechanical part"),
        ("L1", "RPLIDAR A1", "whole device"), ("U1", "NVIDIA Jetson Nano Developer Kit", "whole device"),
        ("C3", "USB camera", "whole device"),
        ("U11", "RP2040-based microcontroller board with wireless", "whole device"),
        ("", "Motor Driver", "whole device"), ("E4", "5V Buck Boost Regulator", "whole device"),
        ("", "12V power supply", "whole device"), ("F1", "fan 40 mm", "whole device"), ("", "HDMI cable", "cable"),
        ("L1", "LM7805 linear regulator 5V", "analog circuit"), ("L3", "L78M08CDT-TR", "analog circuit"),
        ("E9", "Op Amp LM 358P", "analog circuit"), ("U802", "MOSFET 2P-CH 20V 2.9A CHIPFET", "fet"),
        ("U2002", "CONN MICRO SD CARD PUSH-PUSH R/A", "connector"), ("X1", "CRYSTAL 24MHZ 8PF SMD", "crystal"),
        ("RN1", "RES ARRAY 100K OHM 8 RES 1506", "resistor network"),
        ("F3", "PTC RESTTBLE 0.35A 16V", "resettable fuse"),
        ("E5", "Gear Motor w Relative Enc. (Drive Motor)", "motor"), ("", "Wheel encoder", "encoder"),
        ("", "Screw terminal 2p", "connector"), ("J21", "expansion header for Raspberry Pi 2 & 3", "connector"),
        ("R7", "RES 10K OHM 1/10W for lidar", "resistor"), ("U4", "Board Mount Pressure Sensors", "sensor chip"),
    ],
)  # fmt: skip
def test_words_are_believed_before_letters(reference, words, kind):
    references = (reference,) if reference else ()
    assert recognise(references, Described(description=words)).kind == kind
    if not words.startswith(("PTC", "RES", "CONN", "MOSFET", "expansion", "Board", "RP2040")):
        assert recognise(references, Described(value=words)).kind == kind


@pytest.mark.parametrize(
    ("reference", "label", "kind"),
    [
        ("J7", "LIDAR", "connector"), ("P13", "ADC/DAC", "connector"), ("F3", "LIDAR", "fuse"), ("K2", "FAN", "relay"),
        ("SW1", "POWER", "switch"), ("D5", "USB", "diode"), ("U3", "USB", "microcircuit"), ("R5", "LED", "resistor"),
    ],
)  # fmt: skip
def test_a_label_names_no_part_and_letters_alone_are_a_guess(reference, label, kind):
    found = recognise((reference,), Described(value=label, **BESIDE))
    assert (found.kind, found.concluded["kind"]) == (kind, "a guess, by its letters alone")


@pytest.mark.parametrize(
    ("reference", "value", "description", "fact", "said"),
    [
        ("C1", "10UF", "", "capacitance", "10 uF"), ("C1", "100nf", "", "capacitance", "100 nF"),
        ("C1", "", "CAP CER 4.7UF 10V", "capacitance", "4.7 uF"), ("C1", "22PF", "", "capacitance", "22 pF"),
        ("C1", "0U47", "", "capacitance", "0.47 uF"), ("C1", "5N6", "", "capacitance", "5.6 nF"),
        ("C1", "1000P", "", "capacitance", "1000 pF"), ("C1", "100 NF", "", "capacitance", "100 nF"),
        ("C1", "10uf/25v", "", "rated_voltage", "25 V"), ("L1", "47UH", "", "inductance", "47 uH"),
        ("L1", "4U7", "", "inductance", "4.7 uH"), ("L1", "10MH", "", "inductance", "10 mH"),
        ("R1", "4K7", "", "resistance", "4.7 kohm"), ("R1", "1M", "", "resistance", "1 Mohm"),
        ("U1", "LM358P", "", "pins", None), ("U1", "", "74ALVC164245 SOP50P810X120-48N", "pins", "48"),
    ],
)  # fmt: skip
def test_quantities_in_capitals(reference, value, description, fact, said):
    found = recognise((reference,), Described(value=value, description=description))
    assert found.facts.get(fact) == said
    assert "guess" not in found.concluded.get("kind", "") or reference == "U1"
