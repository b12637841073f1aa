"""Parts lists as tools export them become designs; what is not known is said and never invented."""

import math
import random
from pathlib import Path

import pytest
from scipy.stats import norm

from robophm.core.errors import DesignError, RobophmError
from robophm.design.file import load, parse
from robophm.design.importers.bom import assumed_inputs, by_kind, import_bom, read_parts, total_rate
from robophm.design.importers.bom.assumptions import Assumptions
from robophm.design.importers.bom.columns import ColumnMapping

DATA = Path(__file__).parents[3] / "data" / "bom"


def ceramic_chip(microfarads, stress=0.5, temperature=40.0, environment=20.0, quality=10):
    """MIL-HDBK-217F(2) §10.1 by hand: CDR, commercial quality, GM. [1/h]"""
    pi_t = math.exp(-0.35 / 8.617e-5 * (1 / (temperature + 273) - 1 / 298))
    return 0.0020 * pi_t * microfarads**0.09 * ((stress / 0.6) ** 3 + 1) * quality * environment * 1e-6


UNSAID = math.exp(((math.log(10) / norm.ppf(0.95)) ** 2) / 2)
"""The mean of what πQ may be where nobody has said it: 10 as commercial, 95 %, and 0.1 of known pedigree, 5 %."""


def imported(name, tmp_path, **how):
    return import_bom(DATA / name, tmp_path / "robot.yaml", **how)


def by_name(found):
    return {one.outcome.name: one for one in found.parts}


@pytest.mark.parametrize("name", ["kicad.csv", "messy.csv", "european.csv"])
def test_kinds_share_out_the_total(name, tmp_path):
    found = imported(name, tmp_path)
    kinds = by_kind(found.parts)
    assert list(kinds) == sorted(kinds)
    assert sorted(one.outcome.name for of in kinds.values() for one in of) == sorted(by_name(found))
    rated = [(one.part.quantity, one.hazard_rate) for one in found.parts if one.hazard_rate is not None]
    assert total_rate(found.parts) == pytest.approx(sum(n * rate for n, rate in rated), rel=1e-12)
    assert total_rate(found.parts) == pytest.approx(sum(map(total_rate, kinds.values())), rel=1e-12)
    assert len(found.of_state("added")) + len(found.of_state("needs a rate")) == len(found.parts)
    assert all(one.hazard_rate is None for one in found.of_state("needs a rate"))


def test_what_is_assumed_is_counted_by_its_value(tmp_path):
    styles = assumed_inputs(by_kind(imported("kicad.csv", tmp_path).parts)["capacitor"])["style"]
    assert styles == {"CDR": 1, "CE": 1, "CWR": 1}


def all_rated(text):
    """What somebody makes of the parts that need a rate."""
    return text.replace("rate: unknown", "rate: 5 FIT")


def test_kicad(tmp_path):
    found = imported("kicad.csv", tmp_path)
    parts = by_name(found)
    chip = parts["C1-C4, C7"]
    assert chip.part.references == ("C1", "C2", "C3", "C4", "C7")
    assert (chip.part.quantity, chip.rating.model) == (5, "mil_hdbk_217f.capacitor")
    assert chip.rating.inputs == {
        "style": "CDR",
        "capacitance": "100 nF",
        "dc_voltage": "0.5 V",
        "rated_voltage": "1 V",
        "temperature": "40 degC",
    }
    assert chip.hazard_rate == pytest.approx(ceramic_chip(0.1, quality=UNSAID), rel=1e-12)
    assert chip.rating.assumed.keys() == {"style", "dc_voltage", "rated_voltage", "temperature"}
    assert "stand-in" in chip.rating.assumed["rated_voltage"]
    assert parts["C5"].rating.inputs["style"] == "CE"
    assert parts["C6"].rating.inputs["style"] == "CWR"
    assert [str(note) for note in found.parts_list.left_out] == [
        "row 5: C8,C9 is not fitted (DNP)",
        "row 7: H1,H2 is no electrical part",
    ]
    kinds = {name: one.part.recognised.kind for name, one in parts.items()}
    assert kinds["D1"] == "led"
    assert (kinds["J1"], parts["J1"].part.recognised.facts["pins"]) == ("connector", "10")
    assert (kinds["Y1"], parts["Y1"].part.recognised.facts["frequency"]) == ("crystal", "8 MHz")
    assert (kinds["U1"], parts["U1"].part.recognised.facts["pins"]) == ("microcontroller", "64")
    component = next(part for part in found.robot.all_components() if part.path == "C1-C4, C7")
    assert (component.quantity, component.modes[0].rate) == (5, pytest.approx(chip.hazard_rate, rel=1e-12))
    assert component.modes[0].source.startswith("kicad.csv, row 2: C1-C4, C7; assumed ")


def test_nothing_is_invented(tmp_path):
    found = imported("kicad.csv", tmp_path)
    components = {part.path: part for part in found.robot.all_components()}
    for one in found.parts:
        component = components[one.outcome.name]
        assert component.unknown == (one.rating is None)
        assert component.quantity == one.part.quantity
        if one.rating is None:
            assert (one.hazard_rate, one.outcome.state) == (None, "needs a rate")
            assert f"    rate: unknown  # needs a rate: {one.outcome.text}\n" in found.text
    assert {one.outcome.name for one in found.parts if one.rating is None} == {"AE1"}


def test_a_part_of_unknown_rate_is_its_authors_once_it_has_one(tmp_path):
    """State a rate in place of the word: the design loads, and the next import leaves the part alone."""
    design = tmp_path / "robot.yaml"
    text = imported("kicad.csv", tmp_path).text
    assert text.count("rate: unknown") == 1
    design.write_text(text.replace("rate: unknown", "rate: 30 FIT"))
    assert {part.path: part.modes[0].rate for part in load(design).all_components()}["AE1"] == 30e-9
    again = by_name(imported("kicad.csv", tmp_path))["AE1"].outcome
    assert (again.state, again.text) == ("kept", "edited by hand, stays as it is")


@pytest.mark.parametrize(
    ("name", "sheet", "header", "decimal", "columns"),
    [
        (
            "kicad.csv",
            "comma",
            1,
            ".",
            {"reference": "Reference", "value": "Value", "quantity": "Qty", "unfitted": "DNP"},
        ),
        (
            "kicad_pcb.csv",
            "semicolon",
            1,
            ".",
            {"reference": "Designator", "value": "Designation", "quantity": "Quantity"},
        ),
        ("kicad_grouped.csv", "comma", 6, ".", {"reference": "Reference(s)", "library": "LibPart", "quantity": "Qty"}),
        (
            "altium.csv",
            "comma",
            1,
            ".",
            {"value": "Comment", "part_number": "Manufacturer Part Number", "library": "LibRef"},
        ),
        ("european.csv", "semicolon", 1, ",", {"reference": "Bezeichner", "quantity": "Menge", "footprint": "Bauform"}),
        ("messy.csv", "comma", 4, ".", {"reference": "Ref Des", "quantity": "Quantity (per board)", "note": "Remarks"}),
    ],
)
def test_headers_are_understood(name, sheet, header, decimal, columns):
    table = read_parts(DATA / name).table
    assert (table.sheet, table.header_row, table.decimal) == (sheet, header, decimal)
    said = {column.field: column.header for column in table.columns}
    assert {field: said.get(field) for field in columns} == columns
    assert all(0 < column.confidence <= 1 for column in table.columns)


def test_a_similar_header_is_less_sure():
    sure = {column.field: column.confidence for column in read_parts(DATA / "messy.csv").columns}
    assert sure["value"] > 0.9 > sure["reference"] > sure["footprint"] > 0.3  # "Capacitors" is no reference


def test_a_european_list(tmp_path):
    found = imported("european.csv", tmp_path)
    parts = by_name(found)
    rating = {name: one.rating.inputs for name, one in parts.items() if one.rating}
    assert (rating["C1-C4"]["capacitance"], rating["C1-C4"]["rated_voltage"]) == ("0.1 uF", "50 V")
    assert (rating["C5, C6"]["capacitance"], rating["C5, C6"]["dc_voltage"]) == ("4.7 uF", "3.15 V")
    assert (rating["C7"]["style"], rating["C7"]["capacitance"]) == ("CE", "1000 uF")
    assert "C8 is not fitted (nein)" in str(found.parts_list.left_out[0])
    facts = parts["R1-R3"].part.recognised.facts
    assert (facts["resistance"], facts["rated_power"], facts["type"]) == ("2.2 kohm", "0.125 W", "thick film")
    assert (facts["tolerance"], parts["L1"].part.recognised.facts["inductance"]) == ("1 %", "4.7 uH")
    assert parts["T1"].part.recognised.kind == "bipolar transistor"
    assert "Keramikkondensator X7R 50 V ±10 %" in found.text


def test_altium(tmp_path):
    found = imported("altium.csv", tmp_path)
    parts = by_name(found)
    assert parts["C1-C3"].hazard_rate == pytest.approx(ceramic_chip(0.1, quality=UNSAID), rel=1e-12)
    assert (parts["C10, C11"].rating.inputs["rated_voltage"], parts["C10, C11"].rating.inputs["style"]) == (
        "50 V",
        "CDR",
    )
    assert parts["Q1"].part.recognised.kind == "fet"
    assert parts["R1, R2"].part.recognised.facts["rated_power"] == "0.0625 W"
    assert "'=Value' is a formula" in str(found.parts_list.notes[0])


def test_a_whole_board(tmp_path):
    """As KiCad and Altium list it today: every kind is known and rated, what is no part is left out and said."""
    kinds = {
        "battery": "BT1", "capacitor": "C1, C2, C5-C9 / C3, C4 / C10", "led": "D1", "diode": "D2, D3",
        "tvs diode": "D4", "resettable fuse": "F1",
        "ferrite bead": "FB1, FB2", "connector": "J1 / J2 / J3", "relay": "K1",
        "inductor": "L1", "fet": "Q1", "bipolar transistor": "Q2", "resistor": "R1-R4 / R5", "potentiometer": "RV1",
        "switch": "SW1 / SW2", "microcontroller": "U1", "analog circuit": "U2 / U5", "memory": "U3", "logic": "U4",
        "sensor chip": "U6", "oscillator": "X1", "crystal": "Y1",
    }  # fmt: skip
    found = imported("kicad_board.csv", tmp_path)
    assert {one.outcome.name: one.part.recognised.kind for one in found.parts} == {
        name: kind for kind, names in kinds.items() for name in names.split(" / ")
    }
    assert {one.outcome.state for one in found.parts} == {"added"}
    assert [note.row for note in found.parts_list.left_out] == [11, 24]
    assert len(found.robot.components) == len(found.parts) == 29
    for one in found.parts:
        assert all(f"{name}: " in found.text and why in found.text for name, why in one.rating.assumed.items())
    found = imported("altium_board.csv", tmp_path)
    parts = by_name(found)
    assert [name for name, one in parts.items() if one.rating is None] == ["PCB1"]
    assert [str(note) for note in found.parts_list.left_out] == ["row 17: FID1, FID2 is no electrical part"]
    styles = {name: parts[name].rating.inputs["style"] for name in ("J1", "J2", "J3")}
    assert styles == {"J1": "power", "J2": "circular", "J3": "rf-coaxial"}


def test_what_is_assumed_stands_beside_its_input(tmp_path):
    lines = imported("kicad.csv", tmp_path).text.splitlines()
    at = lines.index('  "R1, R2, R5-R7":')
    assert lines[at + 3 : at + 10] == [
        "    hazard:",
        "      model: mil_hdbk_217f.resistor",
        "      inputs:",
        "        style: RM  # assumed: the nearest to a chip",
        "        power: 0.05 W  # assumed: 0.5 of the rated",
        "        rated_power: 0.1 W  # assumed: by its size 0603",
        "        temperature: 40 degC  # assumed: around it",
    ]


def test_a_messy_list(tmp_path):
    """Titles, blank lines, headings, a sum, the header again; a faulty row costs only itself."""
    read = read_parts(DATA / "messy.csv")
    parts = {part.row: part for part in read.parts}
    assert parts[7].references == ("C1", "C2")
    assert parts[8].references == ("C3", "C4", "C5")
    assert parts[13].references == ("C10", "C11")
    assert [(error.row, error.column, error.value) for error in read.errors] == [
        (15, "Quantity (per board)", "ten"),
        (16, "Ref Des", "C20-C19"),
    ]
    assert all(error.expected for error in read.errors)
    notes = {note.row: note.text for note in read.notes}
    assert "2 references, the quantity is 3; 3 are taken" in notes[13]
    assert notes[7].startswith("C1 stands in rows 7, 11")
    assert "formula" in notes[17]
    assert [note.row for note in read.left_out] == [6, 9, 12, 20]
    found = imported("messy.csv", tmp_path)
    names = [one.outcome.name for one in found.parts]
    assert len(set(names)) == len(names) == len(read.parts)
    assert {"C1, C2", "C1", "PCB 4 layers"} <= set(names)
    assert "cmd|" not in found.text
    assert by_name(found)["X1"].outcome.text.startswith("what kind of part it is, is not clear")


def test_every_row_is_accounted_for():
    """No row is lost: a part, an error, or left out and said."""
    for path in sorted(DATA.glob("*.csv")):
        read = read_parts(path)
        accounted = [*(part.row for part in read.parts), *(e.row for e in read.errors), *(n.row for n in read.left_out)]
        assert sorted(accounted) == [row.number for row in read.table.rows], path.name


def test_assumptions_are_stated_and_change_rates(tmp_path):
    how = {"assumptions": Assumptions("70 degC", 0.3, quality="M"), "environment": "GF"}
    found = imported("altium.csv", tmp_path, **how)
    expected = ceramic_chip(0.1, 0.3, 70.0, 10.0) / 10  # M is 1, commercial 10
    assert by_name(found)["C1-C3"].hazard_rate == pytest.approx(expected, rel=1e-12)
    assert "temperature 70 degC" in found.text
    assert "environment: GF" in found.text
    inputs = by_name(found)["C1-C3"].rating.inputs
    assert (inputs["quality"], inputs["dc_voltage"]) == ("M", "15 V")


def test_an_environment_of_the_design_holds_unless_another_is_said(tmp_path):
    design = tmp_path / "robot.yaml"
    design.write_text("schema_version: 1\nname: r\nenvironment: GF\ncomponents:\n  a: {rate: 1 FIT}\n")
    own = by_name(imported("altium.csv", tmp_path))["C1-C3"]
    assert own.hazard_rate == pytest.approx(ceramic_chip(0.1, environment=10.0, quality=UNSAID), rel=1e-12)
    assert "environment" not in own.rating.inputs
    other = imported("altium.csv", tmp_path, environment="GB")
    assert by_name(other)["C1-C3"].rating.inputs["environment"] == "GB"
    component = next(part for part in other.robot.all_components() if part.path == "C1-C3")
    assert component.modes[0].rate == pytest.approx(ceramic_chip(0.1, environment=1.0, quality=UNSAID), rel=1e-12)


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({"assumptions": Assumptions(temperature="warm")}, "'warm' is not a number with a unit"),
        ({"assumptions": Assumptions(stress=1.5)}, "stress 1.5; expected a share"),
        ({"environment": "moon"}, "'moon' is no environment of MIL-HDBK-217F Table 3-2"),
        ({"assumptions": Assumptions(quality="comercial")}, "a level of no model; did you mean 'commercial'"),
        ({"mapping": ColumnMapping({"value": "Wert"})}, "has no column 'Wert'"),
    ],
)
def test_wrong_wishes(tmp_path, how, words):
    with pytest.raises(RobophmError, match=words):
        imported("kicad.csv", tmp_path, **how)


def test_a_list_without_a_part_that_can_be_rated(tmp_path):
    source = tmp_path / "list.csv"
    source.write_text("Reference,Value\nC1,\nAE1,antenna\n")
    with pytest.raises(
        DesignError, match=r"no part of list\.csv has a rate, e\.g\. C1: the list does not say its capac"
    ):
        import_bom(source, tmp_path / "robot.yaml")


def test_names_that_a_design_does_not_take(tmp_path):
    source = tmp_path / "list.csv"
    rows = [
        "C1,0.1u/50V [x]",
        "C1,0.1u/50V [x]",
        ",a/b[1]: {c} # d",
        ",a/b[1]: {c} # d",
        ",null",
        ",123",
        ",- x",
        ',"""q"""',
    ]
    source.write_text("Reference,Value,Footprint\n" + "".join(f"{row},C_0603\n" for row in rows))
    found = import_bom(source, tmp_path / "robot.yaml")
    names = [one.outcome.name for one in found.parts]
    assert names[:4] == ["C1", "C1 (row 3)", "a-b(1): {c} # d", "a-b(1): {c} # d (row 5)"]
    assert len(set(names)) == len(names) == 8
    # each line that needs a rate is valid once it has one
    assert {part.path for part in parse(all_rated(found.text)).all_components()} == set(names)


def test_any_text_gives_a_design_or_one_line(tmp_path):
    """Cells drawn at random, quotation marks, braces and all: never a traceback, never a design that does not load."""
    draw, refused = random.Random(7), []
    letters = "ab1C,;\"'[]{}#:&*!|>%@`\\/-?= \tµ\u2028\u00a0é"
    for i in range(60):
        source = tmp_path / f"{i}.csv"
        rows = ["".join(draw.choice(letters) for _ in range(draw.randrange(40))) for _ in range(5)]
        source.write_text("Reference;Value;Description\nC1;100nF;ceramic\n" + "\n".join(rows), encoding="utf-8")
        try:
            found = import_bom(source, tmp_path / "robot.yaml")
        except DesignError as error:  # a quotation mark that never closes
            refused.append(str(error).startswith(str(source)))
        else:
            parse(all_rated(found.text))
    assert all(refused)


def test_a_guess_is_marked_wherever_it_stands(tmp_path):
    """In the design beside the model and in the source, and again unchanged when the list is read once more."""
    source, design = tmp_path / "list.csv", tmp_path / "robot.yaml"
    source.write_text("Reference,Value,Quantity\nU1,NAV,1\nC1,100nf,1\nTotal,,2\nApproved,Designer,\n")
    found = import_bom(source, design)
    assert {one.outcome.name: one.guess for one in found.parts} == {"U1": True, "C1": False}
    assert (
        "model: mil_hdbk_217f.microcircuit.linear  # assumed: microcircuit is a guess, by its letters alone"
        in found.text
    )
    assert "list.csv, row 2: U1; a guess, by its letters alone; assumed " in found.text
    assert [note.row for note in found.parts_list.left_out] == [4, 5]
    design.write_text(found.text)
    assert {one.outcome.state for one in import_bom(source, design).parts} == {"unchanged"}
