"""A scalar put in place of another in the text: nothing else changes by a letter, and it means what it should."""

from __future__ import annotations

import pytest

from robophm.core.yaml_values import values
from robophm.design.scalar_edit import with_scalar, with_value

TEXT = """\
# A courier.
schema_version: 1
name:   courier   # its own, at its own place
description: 'fast, and: light'
modules:
  drive:
    components: {motor: {quantity: 2, rate: 8 FPMH}, encoder: {rate: "2 FPMH"}}   # braces; rate: 1 FPMH
  see:
    components:
        lidar:     # indented by itself
            rate:  30 FPMH    # by its maker: 30
            description: wide, far
diagram: [drive, see]
"""


@pytest.mark.parametrize(
    ("place", "written", "line"),
    [
        (
            ("modules", "see", "components", "lidar", "rate"),
            "31 FIT",
            "            rate:  31 FIT    # by its maker: 30",
        ),
        (("modules", "see", "components", "lidar", "description"), "near", None),
        (("name",), "express", "name:   express   # its own, at its own place"),
        (("description",), "slow", "description: slow"),
        (("schema_version",), "2", "schema_version: 2"),
    ],
)
def test_only_its_line_changes(place, written, line):
    document, lines = values(TEXT, "text")
    found = with_scalar(TEXT, lines, place, written)
    before, after = TEXT.splitlines(), found.splitlines()
    (changed,) = [n for n, (old, new) in enumerate(zip(before, after, strict=True)) if old != new]
    assert changed == lines[place] - 1
    # a text with a comma, which in braces would end there, is cut: its document says so, and the caller refuses it
    wanted = with_value(document, place, int(written) if written.isdigit() else written)
    assert (values(found, "text")[0] == wanted) is (line is not None)
    assert line is None or after[changed] == line


def test_what_is_not_plain_on_its_line_is_left_to_others():
    lines = values(TEXT, "text")[1]
    two_of_them = ("modules", "drive", "components", "motor", "rate")
    assert with_scalar(TEXT, lines, two_of_them, "9 FPMH") is None
    assert with_scalar(TEXT, lines, ("name",), "|\n  two\n  lines") is None
    assert with_scalar(TEXT, lines, ("no", "such"), "1") is None
    anchored = "a: &one 8\nb: *one\nc: |\n  text\nd: >-\n  text\n"
    for key in "abcd":
        assert with_scalar(anchored, values(anchored, "text")[1], (key,), "9") is None
    one = "motor: {quantity: 2, rate: 8 FPMH}  # left\r\n"
    found = with_scalar(one, values(one, "text")[1], ("motor", "rate"), "9 FPMH")
    assert found == "motor: {quantity: 2, rate: 9 FPMH}  # left\r\n"


def test_a_document_with_another_value_shares_the_rest():
    document = {"a": {"b": [1, {"c": 2}]}, "d": {}}
    found = with_value(document, ("a", "b", "1", "c"), 3)
    assert found == {"a": {"b": [1, {"c": 3}]}, "d": {}}
    assert document == {"a": {"b": [1, {"c": 2}]}, "d": {}}
    assert found["d"] is document["d"]
    with pytest.raises(LookupError):
        with_value(document, ("a", "x", "y"), 3)
