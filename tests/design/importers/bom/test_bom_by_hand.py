"""Real parts lists against a careful reading of every row by hand."""

import json
from pathlib import Path

import pytest

from robophm.design.importers.bom.kinds import NO_PARTS
from robophm.design.importers.bom.reading import read_parts

READ = json.loads((Path(__file__).parents[3] / "data" / "bom" / "read_by_hand.json").read_text(encoding="utf-8"))
"""By list and row what kind of part it is; of some two kinds are right. The lists themselves are their authors'."""

STILL_WRONG = {
    ("hackrf_jellybean.ods", "80"): "an ESD protection that its words call an IC",
    ("pixhawk_fmuv3.xlsx", "41"): "an EMI filter that its words call an IC",
    ("openmower.csv", "16"): "a translating transceiver: logic, rated as an analog circuit",
    ("rover_kicad.csv", "41"): "a board; nothing in its row says so",
    ("rover_kicad.csv", "42"): "a board; nothing in its row says so",
    ("rover_kicad.csv", "43"): "a board; nothing in its row says so",
}
"""Known, and said in the guide; what is mended goes."""


@pytest.mark.parametrize("name", READ)
def test_no_row_is_taken_for_another_kind(name, shared):
    """Every row has the kind that a person reads in it, or none where nothing but a person can tell."""
    found = read_parts(shared / "boms" / name)
    kinds = {str(part.row): part.recognised.kind for part in found.parts}
    kinds |= {str(note.row): "no part" for note in found.left_out}
    assert not found.errors
    assert kinds.keys() == READ[name].keys()
    wrong = {
        (name, row) for row, kind in kinds.items()
        if kind and not {kind, *(["no part"] if kind in NO_PARTS else [])} & set(READ[name][row].split("|"))
    }  # fmt: skip
    assert wrong == {place for place in STILL_WRONG if place[0] == name}


def test_a_quantity_of_a_group_is_counted_once(shared):
    """112 parts are on the board; the column has what was ordered of each group of rows, 212 with them."""
    found = read_parts(shared / "boms" / "hackrf_jellybean.ods")
    assert sum(part.quantity for part in found.parts) == 112
    assert {len(part.references) for part in found.parts} == {1}
    assert any("the quantity 10 is of this row and those of the same part below" in str(note) for note in found.notes)
