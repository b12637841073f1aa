"""What a design file may say of standby and load sharing groups, and what it may not: in one line, with its place."""

from __future__ import annotations

import re

import pytest

from robophm.blocks.diagram import LoadSharing, Standby
from robophm.core.errors import DesignError
from robophm.design.file import parse

PARTS = "A: {rate: 1 FPMH}, B: {rate: 1 FPMH}, C: {rate: 1 FPMH}, P: {rate: 1 FPMH, quantity: 3, required: 2}"


def design(diagram: str, parts: str = PARTS, more: str = "") -> str:
    return f"schema_version: 1\nname: rover\n{more}components: {{{parts}}}\ndiagram: {diagram}\n"


def test_what_is_said() -> None:
    group = parse(design("{standby: {of: [A, B, C], active: 2, dormancy: 0.1, switch: 0.99}}"), "robot.yaml").diagram
    assert group == Standby("standby of A, B, C", (("A",), ("B",), ("C",)), 2, 0.1, 0.99)
    group = parse(design("{load_sharing: {of: [A, B, C], k: 2, exponent: 3}}"), "robot.yaml").diagram
    assert group == LoadSharing("load sharing of A, B, C", (("A",), ("B",), ("C",)), 2, (1.0, 1.5**3))


def test_a_module_in_series_is_a_member() -> None:
    more = "modules: {M: {components: {x: {rate: 1 FPMH}, y: {rate: 1 FPMH}}}}\n"
    group = parse(design("{standby: {of: [A, M]}}", more=more), "robot.yaml").diagram
    assert isinstance(group, Standby)
    assert group.members == (("A",), ("M/x", "M/y"))


WRONG = [
    ("{standby: {of: [A]}}", PARTS, "standby of A: 1 part; expected at least two"),
    ("{standby: {of: [A, B], active: 2}}", PARTS, "active = 2 of 2; expected a spare"),
    ("{standby: {of: [A, B], dormancy: 1.5}}", PARTS, "dormancy"),
    ("{standby: {of: [A, B], switching: 0.9}}", PARTS, "unknown key 'switching'; did you mean 'switch'?"),
    ("{standby: {of: [A, X]}}", PARTS, "unknown part 'X'"),
    ("{standby: {of: [A, A]}}", PARTS, "'A' is in it twice"),
    ("{series: [A, {standby: {of: [A, B]}}]}", PARTS, "'A' is drawn outside its group too"),
    ("{series: [{standby: {of: [A, B]}}, {standby: {of: [B, C]}}]}", PARTS, "'B' is a member of two groups"),
    ("{series: [{standby: {of: [A, B]}}, {standby: {of: [A, B], switch: 0.9}}]}", PARTS, "with other numbers"),
    ("{standby: {of: [A, P]}}", PARTS, "'P': 2 of 3; expected a quantity alone"),
    ("{load_sharing: {of: [A, B]}}", PARTS, "expected either exponent, e.g. 3 for bearings, or factors"),
    ("{load_sharing: {of: [A, B], factors: [1]}}", PARTS, "factors [1.0]; expected 2"),
    ("{load_sharing: {of: [A, B], k: 3, exponent: 3}}", PARTS, "k = 3 of n = 2"),
    ("{standby: {of: [A, B]}}", "A: {rate: 1 FPMH, scaling: hazard}, B: {rate: 1 FPMH}", "scaling 'hazard' in a group"),
    (
        "{standby: {of: [A, B]}}",
        "A: {rate: 1 FPMH, uncertainty: {error_factor: 3}}, B: {rate: 1 FPMH}",
        "'uncertainty'",
    ),
]


@pytest.mark.parametrize(("diagram", "parts", "says"), WRONG)
def test_what_is_refused(diagram: str, parts: str, says: str) -> None:
    with pytest.raises(DesignError, match=re.escape(says)) as error:
        parse(design(diagram, parts), "robot.yaml")
    assert "robot.yaml:" in str(error.value)
    assert "\n" not in str(error.value)


def test_a_network_is_no_member() -> None:
    """Though both of its paths are of one part."""
    wired = "diagram: {network: {from: in, to: out, links: [[in, x, out], [in, y, out]]}}"
    more = f"modules: {{M: {{components: {{x: {{rate: 1 FPMH}}, y: {{rate: 1 FPMH}}}}, {wired}}}}}\n"
    with pytest.raises(DesignError, match="'M' is not of parts in series; expected a part, or a module of parts in"):
        parse(design("{standby: {of: [A, M]}}", more=more), "robot.yaml")
