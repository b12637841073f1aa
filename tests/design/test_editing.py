"""Edits of a design's document: names are kept in step everywhere, comments stay, the result is the robot meant."""

import io
import math

import numpy as np
import pytest

from robophm.design import editing
from robophm.design.file import parse, round_trip
from robophm.design.located_error import LocatedError
from robophm.design.problems import check

DESIGN = """\
schema_version: 1
name: R   # the robot
diagram:
  series: [power, {parallel: [left, right]}, {k_of_n: {k: 2, of: [a, b, c]}}]   # as drawn
functions:
  drive: {series: [power, left]}
  see: lidar
components:
  a: {rate: 1 FPMH}
  b: {rate: 1 FPMH}   # the second
  c: {rate: 1 FPMH}
  left: {rate: 2 FPMH, depends_on: power/pack}
  right: {rate: 2 FPMH, depends_on: [power/pack, lidar]}
  lidar: {rate: 3 FPMH}
modules:
  power:
    diagram: {parallel: ['pack[1]', 'pack[2]', /lidar]}
    components:
      pack: {quantity: 2, rate: 5 FPMH}
common_causes:
  twins: {of: [left, right], beta: 0.1}
"""


def edited(change, text=DESIGN):
    document = round_trip().load(text)
    change(document)
    stream = io.StringIO()
    round_trip().dump(document, stream)
    return stream.getvalue()


def document_of(text):
    checked = check(text)
    assert checked.robot is not None, checked.problems
    return checked.document


def test_a_part_that_gets_another_name_has_it_wherever_it_is_named():
    text = edited(lambda d: editing.rename(d, ["components", "lidar"], "scanner"))
    found = document_of(text)
    assert "lidar" not in text
    assert found["functions"]["see"] == "scanner"
    assert found["components"]["right"]["depends_on"] == ["power/pack", "scanner"]
    assert found["modules"]["power"]["diagram"]["parallel"] == ["pack[1]", "pack[2]", "/scanner"]
    assert list(found["components"]) == ["a", "b", "c", "left", "right", "scanner"]
    assert "# the second" in text
    assert "# the robot" in text


def test_what_is_in_a_module_that_gets_another_name_is_still_found():
    found = document_of(edited(lambda d: editing.rename(d, ["modules", "power"], "supply")))
    assert found["components"]["left"]["depends_on"] == "supply/pack"
    assert found["diagram"]["series"][0] == "supply"
    assert found["modules"]["supply"]["diagram"]["parallel"] == ["pack[1]", "pack[2]", "/lidar"]


def test_equal_parts_that_are_told_apart_keep_their_numbers():
    found = document_of(edited(lambda d: editing.rename(d, ["modules", "power", "components", "pack"], "cell")))
    assert found["modules"]["power"]["diagram"]["parallel"] == ["cell[1]", "cell[2]", "/lidar"]
    assert found["components"]["left"]["depends_on"] == "power/cell"


def test_a_part_that_is_deleted_is_drawn_nowhere():
    found = document_of(edited(lambda d: editing.delete(d, ["components", "right"])))
    assert found["diagram"]["series"][1] == "left"  # of two in parallel one is left
    assert "common_causes" not in found  # of which one alone is none
    found = document_of(edited(lambda d: editing.delete(d, ["components", "lidar"])))
    assert "see" not in found["functions"]
    assert found["components"]["right"]["depends_on"] == ["power/pack"]


def test_k_is_never_more_than_there_are():
    def two_of_three_less_two(document):
        editing.delete(document, ["components", "a"])
        editing.delete(document, ["components", "b"])

    assert document_of(edited(two_of_three_less_two))["diagram"]["series"][2] == "c"


def test_a_module_takes_what_is_in_it_along():
    found = document_of(edited(lambda d: editing.delete(d, ["modules", "power"])))
    assert "depends_on" not in found["components"]["left"]
    assert found["functions"]["drive"] == "left"  # of two in series one is left


def test_a_new_part_is_drawn_in_series_where_a_level_draws():
    found = document_of(edited(lambda d: editing.put(d, ["components", "horn"], {"rate": "1 FPMH"})))
    assert found["diagram"]["series"][-1] == "horn"
    path = ["modules", "power", "components", "fuse"]
    found = document_of(edited(lambda d: editing.put(d, path, {"rate": "1 FPMH"})))
    assert found["modules"]["power"]["diagram"]["series"][-1] == "fuse"


PLAIN = "schema_version: 1\nname: R\ncomponents:\n" + "".join(f"  {name}: {{rate: 1 FPMH}}\n" for name in "abcd")


def at_1000_hours(text):
    """R of parts of 1 FPMH, by the engine of the diagrams: 1e-3 is what one of them has gathered by then."""
    from robophm.health.outlooks import as_designed
    from robophm.health.plant import Plant

    robot = parse(text)
    return float(as_designed(Plant(robot)).reliability_curve(robot.diagram, np.array([1000.0]))[0][0])


@pytest.mark.parametrize(
    ("kind", "k", "expected"),
    [
        ("parallel", None, lambda p: p**2 * (1 - (1 - p) ** 2)),
        ("series", None, lambda p: p**4),
    ],
)
def test_groups_are_what_they_are_called(kind, k, expected):

    text = edited(lambda d: editing.group(d, [], ["b", "c"], kind, k), PLAIN)
    assert at_1000_hours(text) == pytest.approx(expected(math.exp(-1e-3)), rel=1e-12)


def test_groups_of_groups_and_back():

    def twice(document):
        editing.group(document, [], ["a", "b"], "series")
        editing.group(document, [], ["a", "b", "c", "d"], "k_of_n", 2)

    text = edited(twice, PLAIN)  # series in series is one row
    p = math.exp(-1e-3)
    assert at_1000_hours(text) == pytest.approx(
        sum(math.comb(4, n) * p**n * (1 - p) ** (4 - n) for n in (2, 3, 4)), rel=1e-12
    )

    def pair(document):
        editing.group(document, [], ["a", "b"], "parallel")
        editing.group(document, [], ["a", "b", "c"], "parallel")

    text = edited(pair, PLAIN)
    assert at_1000_hours(text) == pytest.approx(p * (1 - (1 - p) ** 3), rel=1e-12)
    text = edited(lambda d: editing.ungroup(d, [], ["a", "b", "c"]), text)
    text = edited(lambda d: editing.ungroup(d, [], ["a", "b"]), text) if "parallel" in text else text
    assert at_1000_hours(text) == pytest.approx(p**4, rel=1e-12)


def test_standby_and_load_sharing():
    assert document_of(edited(lambda d: editing.group(d, [], ["a", "b"], "standby", 1), PLAIN))["diagram"]["series"][
        0
    ] == {"standby": {"of": ["a", "b"], "active": 1}}
    found = document_of(edited(lambda d: editing.group(d, [], ["a", "b"], "load_sharing", 1), PLAIN))
    assert found["diagram"]["series"][0]["load_sharing"]["of"] == ["a", "b"]


def test_a_part_that_moves_to_another_level_is_named_there_by_all():
    text = edited(lambda d: editing.move(d, ["components", "left"], ["modules", "power"]))
    found = document_of(text)
    assert found["diagram"]["series"] == ["power", "right", {"k_of_n": {"k": 2, "of": ["a", "b", "c"]}}]
    assert found["modules"]["power"]["diagram"]["series"][1] == "left"
    assert found["modules"]["power"]["components"]["left"]["depends_on"] == "pack"
    assert found["functions"]["drive"]["series"] == ["power", "power/left"]
    assert found["common_causes"]["twins"]["of"] == ["power/left", "right"]
    back = edited(lambda d: editing.move(d, ["modules", "power", "components", "left"], []), text)
    assert document_of(back)["components"]["left"]["depends_on"] == "power/pack"
    assert document_of(back)["functions"] == document_of(DESIGN)["functions"]
    commented = edited(lambda d: editing.move(d, ["components", "b"], ["modules", "power"]))
    assert "      b: {rate: 1 FPMH} # the second" in commented


def test_a_part_that_a_level_draws_from_elsewhere_is_not_drawn_twice_when_it_comes():
    found = document_of(edited(lambda d: editing.move(d, ["components", "lidar"], ["modules", "power"])))
    assert found["modules"]["power"]["diagram"] == {"parallel": ["pack[1]", "pack[2]", "/power/lidar"]}
    assert found["functions"]["see"] == "power/lidar"
    assert found["components"]["right"]["depends_on"] == ["power/pack", "power/lidar"]


def test_a_module_moves_with_all_that_is_in_it():
    def change(document):
        editing.put(document, ["modules", "base"], {"components": {"frame": {"rate": "1 FPMH"}}})
        editing.move(document, ["modules", "power"], ["modules", "base"])

    found = document_of(edited(change))
    assert found["modules"]["base"]["modules"]["power"]["diagram"]["parallel"] == ["pack[1]", "pack[2]", "/lidar"]
    assert found["diagram"]["series"][0] == {"parallel": ["left", "right"]}
    assert found["functions"]["drive"]["series"] == ["base/power", "left"]
    assert found["components"]["left"]["depends_on"] == "base/power/pack"


A_B_C = {"k_of_n": {"k": 2, "of": ["a", "b", "c"]}}
B_C = {"k_of_n": {"k": 2, "of": ["b", "c"]}}
BOTH = {"parallel": ["left", "right"]}


@pytest.mark.parametrize(
    ("members", "beside", "before", "expected"),
    [
        (["a"], ["left"], False, ["power", {"parallel": ["left", "a", "right"]}, B_C]),
        (["a"], ["left", "right"], False, ["power", {"parallel": ["left", "right", "a"]}, B_C]),
        (["left"], ["right"], False, ["power", {"parallel": ["right", "left"]}, A_B_C]),
        (["left"], [], False, ["power", "right", A_B_C, "left"]),
        (["left"], ["power"], True, ["left", "power", "right", A_B_C]),
        (["left", "right"], ["power"], True, [BOTH, "power", A_B_C]),
        (["a", "b"], [], False, ["power", BOTH, "c", "a", "b"]),
        (["left", "right"], ["a"], False, ["power", {"k_of_n": {"k": 2, "of": ["a", BOTH, "b", "c"]}}]),
        (["lidar"], ["power"], False, ["power", "lidar", BOTH, A_B_C]),
    ],
)  # fmt: skip
def test_parts_are_drawn_where_they_are_put(members, beside, before, expected):
    text = edited(lambda d: editing.place(d, [], members, beside, before=before))
    assert document_of(text)["diagram"]["series"] == expected


def test_parts_in_series_are_put_in_order_and_a_group_is_left_whole():
    plain = "schema_version: 1\nname: R\ncomponents: {a: {rate: 1 FIT}, b: {rate: 1 FIT}, c: {rate: 1 FIT}}\n"
    assert document_of(edited(lambda d: editing.place(d, [], ["c"], ["a"]), plain))["diagram"]["series"] == list("acb")
    spare = edited(lambda d: editing.group(d, [], ["a", "b"], "standby"), plain)
    found = document_of(edited(lambda d: editing.place(d, [], ["c"], ["b"]), spare))
    assert found["diagram"]["standby"] == {"of": ["a", "b", "c"], "active": 1}


def test_a_network_is_made_of_parts_beside_each_other():
    plain = "schema_version: 1\nname: R\ncomponents: {a: {rate: 1 FIT}, b: {rate: 1 FIT}, in: {rate: 1 FIT}}\n"
    network = edited(lambda d: editing.group(d, [], ["a", "b"], "network"), plain)
    found = document_of(network)
    assert found["diagram"]["series"][0] == {
        "network": {"from": "in 2", "to": "out", "links": [["in 2", "a", "out"], ["in 2", "b", "out"]]}
    }
    with pytest.raises(LocatedError, match="a: in a network"):
        edited(lambda d: editing.place(d, [], ["in"], ["a"]), network)
    apart = document_of(edited(lambda d: editing.ungroup(d, [], ["a", "b"]), network))
    assert apart["diagram"] == {"series": ["a", "b", "in"]}
    one = math.exp(-1e-6)  # of 1 FIT for 1000 h
    assert at_1000_hours(network) == pytest.approx((1 - (1 - one) ** 2) * one, rel=1e-14)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: editing.delete(d, ["components", "horn"]), "nothing here to delete"),
        (lambda d: editing.rename(d, ["components", "horn"], "x"), "nothing here to rename"),
        (lambda d: editing.rename(d, ["components", "a"], "power"), "'power' is there already"),
        (lambda d: editing.group(d, [], ["a"], "parallel"), "at least two"),
        (lambda d: editing.group(d, [], ["a", "left"], "parallel"), "do not stand side by side"),
        (lambda d: editing.group(d, ["components", "a"], ["a", "b"], "parallel"), "is no level"),
        (lambda d: editing.ungroup(d, [], ["power", "lidar"]), "in no group"),
        (lambda d: editing.put(d, ["name", "x"], 1), "holds a value"),
        (lambda d: editing.put(d, ["diagram", "series", "99"], "a"), "no place in a list of 3"),
        (lambda d: editing.put(d, [], {}), "as text"),
        (lambda d: editing.wire(d, ["modules", "pwoer"], None), "did you mean 'power'"),
        (lambda d: editing.move(d, ["components", "horn"], ["modules", "power"]), "nothing here to move"),
        (lambda d: editing.move(d, ["modules", "power"], ["modules", "power"]), "into itself"),
        (lambda d: editing.move(d, ["components", "a"], ["components", "b"]), "is no level"),
        (lambda d: editing.place(d, [], ["horn"]), "no 'horn'"),
        (lambda d: editing.place(d, [], ["a"], ["a"]), "beside other parts"),
        (lambda d: editing.place(d, [], ["a"], ["lidar"]), "drawn in no group"),
    ],
)
def test_what_cannot_be_done_is_said(change, message):
    with pytest.raises(LocatedError, match=message):
        edited(change)


def test_every_problem_is_told_at_its_place():
    found = check(
        "schema_version: 1\nname: R\ncomponents:\n  a: {rate: 1}\n  b: {rate: 0 FIT, colour: red}\n  c: {quantity: x}\n"
    )
    assert found.robot is None
    assert {(problem.place, problem.line) for problem in found.problems} >= {
        (("components", "b", "colour"), 5), (("components", "c", "quantity"), 6)
    }  # fmt: skip
    found = check(DESIGN.replace("of: [a, b, c]", "of: [a, b]").replace("k: 2", "k: 1"))
    assert [(one.level, one.place, one.message) for one in found.problems] == [
        ("warning", ("components", "c"), "used in no diagram")
    ]
    twice = check(PLAIN + "diagram: {series: [a, b, {parallel: [a, c]}, d]}\n").problems
    assert [(one.place, one.message) for one in twice] == [
        (("components", "a"), "drawn in 2 places; it counts as one part")
    ]
    assert check("name: [").problems[0].message.startswith("is not YAML")
