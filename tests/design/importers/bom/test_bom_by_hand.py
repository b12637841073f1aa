"""Real parts lists against a careful reading of every row: kind, value and number of parts.

Kinds were read twice, the second time without the first at hand, and of the one row in which they
differed in substance the second was right; values and quantities were read twice, first from the column of values, then
from descriptions and part numbers, and agreed. The lists themselves are their authors' and stand beside the project.
"""

import csv
import math
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

from robophm.core.units import quantity
from robophm.design.importers.bom.kinds import NO_PARTS, is_guess
from robophm.design.importers.bom.reading import read_parts

DATA = Path(__file__).parents[3] / "data" / "bom" / "rows_by_hand.csv"
ROWS = defaultdict(dict)
"""By list and row: the kinds that a person would accept, the value or none, and how many are on the board."""
with DATA.open(encoding="utf-8", newline="") as stream:
    for line in csv.DictReader(stream):
        ROWS[line["list"]][int(line["row"])] = (line["kind"].split("|"), line["value"], int(line["quantity"]))

FACTS = {
    "capacitor": ("capacitance", "F"),
    "inductor": ("inductance", "H"),
    "crystal": ("frequency", "Hz"),
    "resistor": ("resistance", "ohm"),
    "resistor network": ("resistance", "ohm"),
    "thermistor": ("resistance", "ohm"),
}
MARKED_AS_GUESSES = {
    ("rover_kicad.csv", 41): "a board; its footprint is called after it, and so it is said that it may be one",
    ("rover_kicad.csv", 42): "likewise",
    ("rover_kicad.csv", 43): "likewise",
}
"""All rows that are taken for something else, each of them said to be a guess. What is mended goes."""


@cache
def answers(path):
    """By row what is wrong with it, "" where nothing is, and whether the importer says that it is not sure."""
    found, rows = read_parts(path), ROWS[path.name]
    assert not found.errors
    parts, out = {part.row: part for part in found.parts}, {note.row for note in found.left_out}
    assert parts.keys() | out == rows.keys()
    said = {}
    for row, (kinds, value, number) in rows.items():
        if row in out:
            said[row] = "" if {*kinds} & {*NO_PARTS, "not fitted"} else "left out", True
            continue
        part = parts[row]
        kind, facts = part.recognised.kind, part.recognised.facts
        doubt = is_guess(part.recognised.concluded.get("kind", "")) or not kind or bool(part.recognised.contradictions)
        if kind not in kinds:
            said[row] = f"{kind or 'nothing'}, not {kinds}", doubt
        elif value and kind in FACTS and not alike(facts.get(FACTS[kind][0]), value, FACTS[kind][1]):
            said[row] = f"{facts.get(FACTS[kind][0])}, not {value}", doubt
        else:
            said[row] = "" if part.quantity == number else f"{part.quantity} parts, not {number}", doubt
    return said


def alike(said, value, unit):
    return said is not None and math.isclose(quantity(said, unit), quantity(value, unit), rel_tol=1e-6)


@pytest.mark.parametrize("name", ROWS)
def test_every_row_but_some_guesses_is_right(name, shared):
    said = answers(shared / "boms" / name)
    assert {row for row, (fault, _) in said.items() if fault} == {row for at, row in MARKED_AS_GUESSES if at == name}


def test_more_than_97_percent_of_all_rows_are_right_and_none_is_silently_wrong(shared):
    """Kind, value and number; what is wrong is marked as a guess, has no kind, or is told as a contradiction."""
    said = [one for name in ROWS for one in answers(shared / "boms" / name).values()]
    assert len(said) == 531
    assert sum(not fault for fault, _ in said) >= 0.97 * len(said)
    assert not [fault for fault, doubt in said if fault and not doubt]


def test_a_value_that_words_and_number_contradict_is_told(shared):
    """5.6K stands where description and part number say 56 k."""
    found = read_parts(shared / "boms" / "pixhawk_psmv3.xlsx")
    assert [str(note) for note in found.notes if note.row == 27] == [
        "row 27: R802, R805, R808: by its words 56 kohm, by its value 5.6 kohm; 56 kohm is taken"
    ]


def test_a_quantity_of_a_group_is_counted_once(shared):
    """112 parts are on the board; the column has what was ordered of each group of rows, 212 with them."""
    found = read_parts(shared / "boms" / "hackrf_jellybean.ods")
    assert sum(part.quantity for part in found.parts) == 112
    assert {len(part.references) for part in found.parts} == {1}
    assert any("the quantity 10 is of this row and those of the same part below" in str(note) for note in found.notes)


def test_an_old_workbook_is_refused_with_the_way_out(shared):
    with pytest.raises(Exception, match=r"opencr.xls: is an old Excel workbook; expected .xlsx, .ods or .csv: save it"):
        read_parts(shared / "boms" / "opencr.xls")
