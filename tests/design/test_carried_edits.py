"""An edit carried to another state of a design, beside plain dictionaries of places."""

from __future__ import annotations

import random
from copy import deepcopy

import pytest
from tests.cases import each_case

from robophm.design.carried_edits import carry, changes
from robophm.design.located_error import LocatedError


def places(document, path=()):
    """Every leaf of nested mappings by its place; lists and empty mappings are leaves."""
    if isinstance(document, dict) and document:
        return {place: leaf for key, inner in document.items() for place, leaf in places(inner, (*path, key)).items()}
    return {path: document}


def test_what_differs_is_named_and_lists_are_one_value():
    before = {"a": {"x": 1, "y": 2}, "b": [1, 2], "c": 3}
    after = {"a": {"x": 1, "y": 5}, "b": [1, 2, 3], "d": {"e": 4}}
    assert {one.path for one in changes(before, after)} == {("a", "y"), ("b",), ("c",), ("d",)}
    assert list(changes(before, deepcopy(before))) == []


@each_case("seed", range(60))
def test_edits_of_other_places_stay_whatever_is_taken_back(seed):
    """Two people edit random leaves of their own; taking back one's edits leaves just what the other made."""
    rng = random.Random(seed)
    start = {f"module {m}": {f"part {p}": {"rate": rng.random()} for p in range(4)} for m in range(3)}
    state, edits = deepcopy(start), []
    expected = deepcopy(start)
    for _ in range(12):
        mine = rng.random() < 0.5
        module = rng.choice(list(start))
        part = f"part {rng.choice((0, 1) if mine else (2, 3))}"
        before, value = deepcopy(state), rng.random()
        state[module][part]["rate"] = value
        if mine:
            edits.append((before, deepcopy(state)))
        else:
            expected[module][part]["rate"] = value
    for before, after in reversed(edits):
        carry(state, after, before)
    assert places(state) == places(expected)
    for before, after in edits:
        carry(state, before, after)
    for before, after in reversed(edits):
        carry(state, after, before)
    assert places(state) == places(expected)


@each_case(
    ("now", "before", "after", "place"),
    [
        ({"a": 3}, {"a": 2}, {"a": 1}, ("a",)),  # another value since
        ({}, {"a": 2}, {"a": 1}, ("a",)),  # taken away since
        ({"a": 5}, {}, {"a": 1}, ("a",)),  # put there since
        ({"a": 7}, {"a": {"b": 1}}, {"a": {"b": 2}}, ("a", "b")),  # no mapping any more
    ],
)
def test_where_edits_touch_nothing_is_changed(now, before, after, place):
    kept = deepcopy(now)
    with pytest.raises(LocatedError, match="changed since by another edit") as refused:
        carry(now, before, after)
    assert (refused.value.place, now) == (place, kept)


def test_what_is_put_into_a_document_is_its_own():
    document, after = {}, {"a": {"b": 1}}
    carry(document, {}, after)
    document["a"]["b"] = 2
    assert after == {"a": {"b": 1}}
