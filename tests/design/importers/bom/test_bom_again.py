"""A list imported again brings a design up to it: what people wrote in the design stays, letter for letter."""

import re

import pytest

from robophm.core.errors import DesignError
from robophm.design.file import load
from robophm.design.importers.bom import import_bom

LIST = """Reference,Value,Footprint,Description,Qty
C1-C4,100nF,C_0603,X7R 50V,4
C5,1uF,C_0805,X7R 25V,1
C6,10uF,C_1206,X5R 16V,1
AE1,2.4 GHz,,chip antenna,1
"""
ROBOT = """# my robot
schema_version: 1
name: courier  # of the ground floor
environment: GM

modules:
  Power:  # everything with volts
    # wires
    components:
      cable: {rate: 3 FIT}   # guessed

      # the big one
      battery:
        rate: 2 FPMH

    # how it hangs together
    diagram: {series: [cable, battery]}
components:
  lidar: {rate: 300 FIT}
"""


@pytest.fixture
def source(tmp_path):
    path = tmp_path / "board.csv"
    path.write_text(LIST)
    return path


@pytest.fixture
def design(tmp_path, source):
    path = tmp_path / "robot.yaml"
    path.write_text(import_bom(source, path).text)
    return path


def states(found):
    return {one.outcome.name: one.outcome.state for one in found.parts} | {one.name: one.state for one in found.removed}


def test_the_same_list_changes_nothing(source, design):
    found = import_bom(source, design)
    assert found.text == design.read_text()
    assert states(found) == {"C1-C4": "unchanged", "C5": "unchanged", "C6": "unchanged", "AE1": "needs a rate"}


def test_added_changed_removed(source, design):
    source.write_text(
        LIST.replace("100nF", "220nF")
        .replace("C1-C4", "C1-C3")
        .replace(",4\n", ",3\n")
        .replace("C5,1uF,C_0805,X7R 25V,1\n", "")
        + "C7,1nF,C_0603,C0G 50V,1\n"
    )
    found = import_bom(source, design)
    assert states(found) == {
        "C1-C4": "changed",
        "C6": "unchanged",
        "AE1": "needs a rate",
        "C7": "added",
        "C5": "removed",
    }
    told = {one.outcome.name: one.outcome.text for one in found.parts}["C1-C4"]
    assert all(words in told for words in ("quantity was 4", "100 nF", "references were C1-C4"))
    parts = {part.path: part for part in found.robot.all_components()}
    assert parts.keys() == {"C1-C4", "C6", "C7", "AE1"}
    assert [part.path for part in parts.values() if part.unknown] == ["AE1"]
    assert parts["C1-C4"].quantity == 3
    assert parts["C1-C4"].modes[0].stresses[0].design["capacitance"] == pytest.approx(0.22)


def test_a_row_that_only_moved_is_unchanged(source, design):
    source.write_text(LIST.replace("C1-C4", "C9,1nF,C_0603,X7R 16V,1\nC1-C4"))
    found = import_bom(source, design)
    assert states(found)["C1-C4"] == "unchanged"
    assert "board.csv, row 3: C1-C4;" in found.text
    assert "board.csv, row 2: C1-C4;" not in found.text


def test_a_part_edited_by_hand_is_not_overwritten(source, design):
    design.write_text(design.read_text().replace("dc_voltage: 25 V", "dc_voltage: 3.3 V"))
    source.write_text(LIST.replace("C1-C4,100nF", "C1-C5,220nF").replace(",4\n", ",5\n").replace("C5,1uF", "C9,1uF"))
    found = import_bom(source, design)
    told = next(one.outcome for one in found.parts if one.outcome.name == "C1-C4")
    assert told.state == "kept"
    assert told.text.startswith("edited by hand, stays as it is; quantity 4, the list says 5; hazard ")
    part = next(part for part in found.robot.all_components() if part.path == "C1-C4")
    assert (part.quantity, part.modes[0].stresses[0].design["dc_voltage"]) == (4, 3.3)


@pytest.mark.parametrize(
    "edit",
    [
        ("quantity: 4", "quantity: 5"),
        ("quantity: 4", "quantity: 4\n    required: 3"),
        ('"100nF, C_0603, X7R 50V"', "decoupling"),
        ("temperature: 40 degC", "quality: M\n        temperature: 40 degC"),
    ],
)
def test_any_edit_makes_a_part_theirs(source, design, edit):
    text = design.read_text().replace(*edit, 1)
    assert text != design.read_text()
    design.write_text(text)
    assert states(import_bom(source, design))["C1-C4"] == "kept"
    source.write_text(LIST.replace("C1-C4,100nF,C_0603,X7R 50V,4\n", ""))
    found = import_bom(source, design)
    assert states(found)["C1-C4"] == "kept"
    assert "it was edited by hand" in found.removed[0].text
    assert "C1-C4" in {part.path for part in found.robot.all_components()}


def test_comments_stay(source, design):
    text = design.read_text()
    text = text.replace("    quantity: 4\n", "    quantity: 4   # was 3\n    # see the errata\n")
    text = text.replace("  C5:\n", "  # the slow one\n  C5:  # here\n").replace('X5R 16V"\n', 'X5R 16V"  # checked\n')
    text = "# mine\n" + text + "# the end\n"
    design.write_text(text)
    source.write_text(LIST.replace("C1-C4,100nF", "C1-C3,220nF").replace(",4\n", ",3\n").replace("C6,10uF", "C6,22uF"))
    found = import_bom(source, design)
    assert states(found)["C1-C4"] == states(found)["C6"] == "changed"
    for comment in ("# mine", "# was 3", "# see the errata", "# the slow one", "# here", "# checked", "# the end"):
        assert comment in found.text
    assert "quantity: 3   # was 3" in found.text


def test_remarks_beside_inputs_stay_and_ours_follow_the_list(source, design):
    text = design.read_text()
    old = "        dc_voltage: 25 V  # assumed: 0.5 of the rated\n        rated_voltage: 50 V\n"
    assert old in text
    design.write_text(text.replace(old, "        dc_voltage: 25 V\n        rated_voltage: 50 V  # Bob knows\n"))
    source.write_text(LIST.replace("X7R 50V", "X7R 16V").replace("C5,1uF,C_0805,X7R 25V", "C5,1uF,C_0805,X7R"))
    found = import_bom(source, design)
    assert states(found)["C1-C4"] == states(found)["C5"] == "changed"
    new = "        dc_voltage: 8 V  # assumed: 0.5 of the rated\n        rated_voltage: 16 V  # Bob knows\n"
    assert new in found.text
    assert "        rated_voltage: 1 V  # assumed: a stand-in: only the ratio to what is applied counts\n" in found.text


@pytest.mark.parametrize("outer", [True, False])
def test_a_hazard_that_somebody_put_in_braces_is_brought_up_to_the_list(source, design, outer):
    text = design.read_text()
    start = text.index("    hazard:\n")
    end = text.index("    source:", start)
    inputs = "{style: CDR, capacitance: 100 nF, dc_voltage: 25 V, rated_voltage: 50 V, temperature: 40 degC}"
    hazard = f"{{model: mil_hdbk_217f.capacitor, inputs: {inputs}}}"
    block = f"\n      model: mil_hdbk_217f.capacitor\n      inputs: {inputs}"
    design.write_text(f"{text[:start]}    hazard: {hazard if outer else block}  # mine\n{text[end:]}")
    assert states(import_bom(source, design))["C1-C4"] == "unchanged"
    source.write_text(LIST.replace("100nF", "220nF"))
    found = import_bom(source, design)
    assert states(found)["C1-C4"] == "changed"
    assert "        capacitance: 220 nF\n" in found.text
    assert "# mine" in found.text


def test_a_part_that_becomes_another_kind(source, design):
    source.write_text(LIST.replace("C6,10uF,C_1206,X5R 16V,1", "C6,10uF,CP_Radial,Elko 16V,1"))
    found = import_bom(source, design)
    assert states(found)["C6"] == "changed"
    part = next(part for part in found.robot.all_components() if part.path == "C6")
    assert part.modes[0].stresses[0].design["style"] == "CE"


def test_the_rest_of_a_design_stays_letter_for_letter(source, tmp_path):
    design = tmp_path / "robot.yaml"
    design.write_text(ROBOT)
    found = import_bom(source, design, module=["Power"])
    kept = re.sub(r"(?m)^ *(# import-bom: .*|quality: unknown .*)\n", "", found.text)
    first, last = kept.index("      C1-C4:"), kept.index("\n    # how it hangs")
    assert kept[:first] + kept[last:] == ROBOT
    assert {"Power/cable", "Power/C1-C4", "lidar"} <= {part.path for part in found.robot.all_components()}


@pytest.mark.parametrize("module", [["Power", "Board"], ["New"], ["New", "Inner", "Most"], []])
def test_levels_that_are_new(source, tmp_path, module):
    design = tmp_path / "robot.yaml"
    for text in (
        ROBOT,
        "schema_version: 1\nname: r\ncomponents: {a: {rate: 1 FIT}}\n" if module else ROBOT,
        "schema_version: 1\nname: r\nmodules:\n  A:\n    components:\n      a: {rate: 1 FIT}\n    # in A\n",
    ):
        design.write_text(text)
        before = {part.path for part in load(design).all_components()}
        found = import_bom(source, design, module=module)
        after = {part.path for part in found.robot.all_components()}
        assert after - before == {"/".join([*module, name]) for name in ("C1-C4", "C5", "C6", "AE1")}
        assert before <= after
        design.write_text(found.text)
        again = import_bom(source, design, module=module)
        assert again.text == found.text
        assert {line for line in text.splitlines() if "#" in line} <= set(found.text.splitlines())


def test_boards_do_not_disturb_each_other(source, design):
    design.write_text(import_bom(source, design, module=["Left"]).text)
    design.write_text(import_bom(source, design, module=["Right"]).text)
    source.write_text(LIST.replace("C5,1uF,C_0805,X7R 25V,1\n", ""))
    found = import_bom(source, design, module=["Left"])
    assert states(found)["C5"] == "removed"
    paths = {part.path for part in found.robot.all_components()}
    assert {"C5", "Right/C5"} <= paths
    assert "Left/C5" not in paths
    assert found.text.count("# needs a rate: ") == 3


def test_a_part_that_is_drawn_stays(source, design):
    design.write_text(design.read_text() + "diagram: {series: [C1-C4, C5, C6]}\n")
    source.write_text(LIST.replace("C5,1uF,C_0805,X7R 25V,1\n", "").replace("C6,10uF", "C6,unknown"))
    found = import_bom(source, design)
    assert (states(found)["C5"], states(found)["C6"]) == ("kept", "kept")
    assert "it stands in a diagram" in found.removed[0].text
    assert {"C5", "C6"} <= {part.path for part in found.robot.all_components()}


def unknown(found):
    return {part.path for part in found.robot.all_components() if part.unknown}


def test_a_part_of_which_too_little_is_known_now_is_of_unknown_rate_until_more_is(source, design):
    before = design.read_text()
    source.write_text(LIST.replace("C6,10uF", "C6,unknown"))
    found = import_bom(source, design)
    assert states(found)["C6"] == "needs a rate"
    assert unknown(found) == {"C6", "AE1"}
    assert "    rate: unknown  # needs a rate: the list does not say its capacitance" in found.text
    design.write_text(found.text)
    again = import_bom(source, design)
    assert again.text == found.text
    source.write_text(LIST)
    back = import_bom(source, design)
    assert states(back)["C6"] == "changed"
    assert unknown(back) == {"AE1"}
    assert back.text == before


def test_what_it_needs_is_brought_up_to_date_and_a_remark_of_ones_own_stays(source, design):
    source.write_text(LIST.replace("C6,10uF", "C6,unknown"))
    design.write_text(import_bom(source, design).text)
    text = design.read_text()
    stale = text.replace("# needs a rate: the list does not say its capacitance", "# needs a rate: long ago")
    assert stale != text
    design.write_text(stale)
    assert import_bom(source, design).text == text
    own = text.replace("# needs a rate: the list does not say its capacitance", "# asked the maker")
    design.write_text(own)
    assert import_bom(source, design).text == own


def test_remarks_of_an_older_import_become_parts(source, design):
    """What stood as a remark, and counted as never failing, is a part of unknown rate."""
    text = design.read_text()
    start = text.index("  AE1:")
    end = text.index("\n", text.index("source:", start)) + 1
    remark = (
        '  # AE1: {rate: "? FIT", description: "x", quantity: 1, source: "board.csv, row 5: AE1"}  # needs a rate: y\n'
    )
    design.write_text(text[:start] + remark + text[end:])
    found = import_bom(source, design)
    assert found.text == text


def test_parts_of_another_list_stay(source, design, tmp_path):
    other = tmp_path / "board-v2.csv"
    other.write_text(LIST.replace("C5,1uF,C_0805,X7R 25V,1\n", ""))
    found = import_bom(other, design)
    assert (states(found)["C1-C4"], states(found)["C5"]) == ("unchanged", "kept")
    assert "of another list, board.csv" in found.removed[0].text
    assert "board-v2.csv, row 2: C1-C4" in found.text


def test_a_part_of_that_name_made_by_hand_is_theirs(source, tmp_path):
    design = tmp_path / "robot.yaml"
    design.write_text("schema_version: 1\nname: r\ncomponents:\n  C5: {rate: 7 FIT}\n")
    found = import_bom(source, design)
    assert states(found)["C5"] == "kept"
    assert {part.path: part.modes[0].rate for part in found.robot.all_components()}["C5"] == 7e-9


def test_windows_line_ends_and_block_texts(source, tmp_path):
    design = tmp_path / "robot.yaml"
    design.write_bytes(
        b"schema_version: 1\r\nname: r\r\ncomponents:\r\n  a:\r\n    rate: 1 FIT\r\n    description: |\r\n      two\r\n"
        b"      lines\r\n\r\n# end\r\n"
    )
    found = import_bom(source, design)
    assert {"a", "C5"} <= {part.path for part in found.robot.all_components()}
    design.write_text(
        "schema_version: 1\nname: \N{PILE OF POO}\u00e9\ncomponents:\n  a: {rate: 1 FIT}  # \N{PILE OF POO}\n"
    )
    assert "a: {rate: 1 FIT}  # \N{PILE OF POO}\n  C1-C4:\n" in import_bom(source, design).text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{schema_version: 1, name: r, components: {a: {rate: 1 FIT}}}", "is written in braces"),
        ("schema_version: 1\nname: r\ncomponents: {a: {rate: 1 FIT}}\n", "'components' is written in braces"),
        ("schema_version: 1\nname: r\nmodules:\n  A: {components: {a: {rate: 1 FIT}}}\n", "'A' is written in braces"),
        (
            "schema_version: 1\nname: r\nmodules:\n  B: &b\n    components: {a: {rate: 1 FIT}}\n  A: *b\n",
            "'A' is an alias",
        ),
        ("schema_version: 1\nname: r\ncomponents:\n  a: {rat: 1 FIT}\n", "unknown key 'rat'"),
        ("a: [", "is not YAML"),
    ],
)
def test_designs_that_cannot_take_parts(source, tmp_path, text, words):
    design = tmp_path / "robot.yaml"
    design.write_text(text)
    with pytest.raises(DesignError, match=re.escape(words)):
        import_bom(source, design, module=["A"] if "modules" in text else [])
