"""Entries of a design edited in its text: what ruamel.yaml would write anew, and all else letter for letter."""

from __future__ import annotations

import io
import random
import re
from collections import Counter

import pytest

from robophm.core.yaml_values import values
from robophm.design import editing
from robophm.design.entry_edit import same, with_entries
from robophm.design.file import round_trip
from robophm.design.located_error import LocatedError

TEXT = """\
# A courier.
schema_version: 1
name: courier   # its own
modules:
  # what drives
  drive:
    diagram: {series: [motor, encoder]}
    components:
      # two of them
      motor: {quantity: 2, rate: 8 FPMH}   # left and right
      encoder:
        rate: 2 FPMH
        # as of the maker
        description: |
          A disc,
          and a lamp.

  see:
    components:
      lidar: {rate: 30 FPMH}
      camera: {rate: 90 FPMH}   # wide

# beside
components:
  horn: {rate: 1 FPMH}
  lamp: {rate: 1 FPMH, depends_on: see/lidar}
# the end
"""


def dump(document):
    stream = io.StringIO()
    round_trip().dump(document, stream)
    return stream.getvalue()


def edited(text, change):
    """The text by entries, and what all of it would be, written anew."""
    document = round_trip().load(text)
    change(document)
    before, lines = values(text, "text")
    return with_entries(text, lines, before, document, dump), dump(document)


COMPONENTS = ("modules", "see", "components")


@pytest.mark.parametrize(
    "change",
    [
        lambda d: editing.put(d, [*COMPONENTS, "new"], {"rate": "5 FIT"}),
        lambda d: editing.put(d, ["modules", "drive", "components", "encoder", "monitored"], True),
        lambda d: editing.put(d, ["modules", "drive", "components", "motor"], {"rate": "9 FIT"}),
        lambda d: editing.put(d, ["task"], {"distance": "3 m", "speed": "1 m/s"}),
        lambda d: editing.delete(d, [*COMPONENTS, "camera"]),
        lambda d: editing.delete(d, ["components", "lamp"]),
        lambda d: editing.rename(d, [*COMPONENTS, "lidar"], "scanner"),
        lambda d: editing.rename(d, ["modules", "drive"], "walk"),
        lambda d: editing.group(d, ["modules", "drive"], ["motor", "encoder"], "parallel"),
        lambda d: editing.move(d, ["components", "horn"], ["modules", "see"]),
    ],
)
def test_what_would_be_written_anew_is_written_and_nothing_else(change):
    assert dump(round_trip().load(TEXT)) == TEXT
    assert len([*{*edited(TEXT, change)}]) == 1
    wide = TEXT.replace("schema_version: 1", "schema_version:   1")  # as nobody but its author would write it
    found, anew = edited(wide, change)
    assert found == anew.replace("schema_version: 1", "schema_version:   1")


def test_random_edits_are_those_of_the_document_written_anew():
    """A hundred, one after the other, each in the text that the one before has left; few written anew."""
    chance = random.Random(7)
    text, left = TEXT, 0
    for number in range(100):
        document = values(text, "text")[0]
        places = [
            (*level, part)
            for level in (("components",), COMPONENTS, ("modules", "drive", "components"))
            for part in (document if len(level) == 1 else document["modules"].get(level[1], {})).get("components", {})
        ]
        place = chance.choice(places)
        changes = [
            lambda d, n=number, at=place: editing.put(d, [*at[:-1], f"part {n}"], {"rate": f"{n} FIT"}),
            lambda d, n=number, at=place: editing.put(d, [*at, "quantity"], n % 3 + 1),
            lambda d, n=number, at=place: editing.rename(d, at, f"other {n}"),
            lambda d, n=number, at=place: editing.put(d, [*at, "description"], f"of {n}"),
            *([lambda d, at=place: editing.delete(d, at)] if len(places) > 4 else []),
        ]
        try:
            found, anew = edited(text, chance.choice(changes))
        except LocatedError:
            continue
        if found is None:
            left += 1
            found = anew
        assert same(values(found, "text")[0], values(anew, "text")[0])
        told, least, most = (Counter(re.findall("#.*", one)) for one in (found, anew, text))
        assert least <= told <= most  # what stands behind an entry that goes, the whole loses at times
        text = found
    assert left < 10


def test_what_takes_more_than_entries_is_left_to_others():
    for text in (
        "{a: 1, b: 2}\n",  # braces around all
        "a: &one 8\nb: *one\n",
        "a: 1\r\nb: 2\r\n",
        "a: 1\nb: 2",
    ):
        assert edited(text, lambda d: d["a"].update(new=1) if isinstance(d["a"], dict) else d.update(a=3))[0] is None
    swapped = {"b": 2, "a": 1}
    found, _ = edited("a: 1\nb: 2\nc: 3\n", lambda d: [d.pop(key) for key in ("a", "b")] and d.update(swapped))
    assert found is None


def test_values_are_the_same_where_they_are_of_one_kind_and_order():
    assert same({"a": [1, {"b": "x"}], "c": None}, {"a": [1, {"b": "x"}], "c": None})
    for one, other in ((1, True), (1, 1.0), ({"a": 1, "b": 2}, {"b": 2, "a": 1}), ([1], [1, 2]), ("1", 1), ({}, [])):
        assert not same(one, other)
        assert not same(other, one)
