"""Texts of numbers: read as Python reads them, and nothing else is."""

from __future__ import annotations

import ast
import math
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.cases import examples

from robophm.core.errors import SourceError
from robophm.core.literal import LONGEST_LITERAL, MOST_NUMBERS, numbers, rows

finite = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(10**20), 10**20)
lists = st.lists(finite)


@settings(derandomize=True, deadline=None)
@given(lists, st.sampled_from([list, tuple]))
def test_reads_what_python_prints(values: list[float], kind: type) -> None:
    assert numbers(repr(kind(values))) == [float(value) for value in values]


@settings(derandomize=True, deadline=None)
@given(st.lists(lists), st.sampled_from([list, tuple]), st.sampled_from([list, tuple]))
def test_reads_rows_that_python_prints(values: list[list[float]], outer: type, inner: type) -> None:
    assert rows(repr(outer(map(inner, values)))) == [[float(value) for value in row] for row in values]


@settings(derandomize=True, max_examples=examples(2000), deadline=None)
@given(st.text("[](),, 019.eE+-", max_size=12).map(lambda text: f"[{text}]"))
def test_whatever_is_read_python_reads_alike(text: str) -> None:
    for read in (numbers, rows):
        try:
            ours = read(text)
        except SourceError:
            continue
        try:
            theirs = ast.literal_eval(text)
        except SyntaxError as error:
            assert "leading zeros" in str(error)  # noqa: PT017  Python takes 01 for a slip from another language
            continue
        assert ours == ([list(row) for row in theirs] if read is rows else theirs)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", r"character 1: expected a list, '\[' or '\('; found the end"),
        ("  7", r"character 3: expected a list"),
        ("[1, 2", r"character 6: expected ',' or '\]'; found the end"),
        ("[1 2]", r"character 4: expected ',' or '\]'; found '2\]'"),
        ("[1, 2)", r"character 6: expected ',' or '\]'; found '\)'"),
        ("[1], 2", r"character 4: expected the end; found ', 2'"),
        ("[,]", r"character 2: expected a number"),
        ("[1,,2]", r"character 4: expected a number"),
        ("(1)", r"character 1: expected a tuple of one to end in ',\)'"),
        ("[[1]]", r"character 2: expected a number; found '\[1\]\]'"),
        ("[1e999]", r"character 2: expected a number that is not too large"),
        ("[-1e999]", r"character 2: expected a number that is not too large"),
        ("[nan]", r"character 2: expected a number; found 'nan\]'"),
        ("[inf]", r"character 2: expected a number"),
        ("[True]", r"character 2: expected a number"),
        ("[1_000]", r"character 3: expected ',' or '\]'"),
        ("[0x10]", r"character 3: expected ',' or '\]'"),
        ("[1j]", r"character 3: expected ',' or '\]'"),
        ("['1']", r"character 2: expected a number"),
        ("[１]", r"character 2: expected a number"),
        ("[٣]", r"character 2: expected a number"),
        ("[1\u00a0]", r"character 3: expected ',' or '\]'"),
        ("[1]\0", r"character 4: expected the end"),
        ("[9" + "9" * 100 + "]", r"character 2: expected a number"),
        ("__import__('os').system('touch broken')", r"character 1: expected a list"),
        ("[__import__('os').system('touch broken')]", r"character 2: expected a number"),
        ("[1 for _ in iter(int, 1)]", r"character 4: expected ',' or '\]'"),
        ("[1]*10**9", r"character 4: expected the end"),
        ("[9**9**9]", r"character 3: expected ',' or '\]'"),
    ],
)
def test_what_is_no_list_of_numbers(text: str, message: str) -> None:
    with pytest.raises(SourceError, match=message) as error:
        numbers(text)
    assert "\n" not in str(error.value)


def test_rows_are_rows() -> None:
    assert rows(" [ (1, 2),\n\t[3, 4.5e1] , ] ") == [[1.0, 2.0], [3.0, 45.0]]
    for text, place in (("[1, 2]", 2), ("[[1, 2], 3]", 10), ("[[[1]]]", 3)):
        with pytest.raises(SourceError, match=f"character {place}: expected"):
            rows(text)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[" * 100_000 + "]" * 100_000, "character 2: expected a number"),
        ("[" + "(" * 100_000, "character 2: expected a number"),
        ("[" + "1," * 50_000_000 + "]", f"is 100000002 characters long; expected at most {LONGEST_LITERAL}"),
        ("[" + "1," * (MOST_NUMBERS + 1) + "]", f"expected at most {MOST_NUMBERS} numbers"),
        ("[" + "1" * (LONGEST_LITERAL - 2) + "]", "expected a number"),
        (" " * LONGEST_LITERAL, "found the end"),
        ("[" + "-" * (LONGEST_LITERAL - 1), "expected a number"),
    ],
    ids=["nested", "nested tuples", "100 MB", "many numbers", "long number", "blanks", "signs"],
)
def test_hostile_texts_cost_little(text: str, message: str) -> None:
    begun = time.process_time()
    with pytest.raises(SourceError, match=message):
        numbers(text)
    with pytest.raises(SourceError):
        rows(text)
    assert time.process_time() - begun < 2


def test_the_limits_are_reached() -> None:
    assert numbers("[" + "1," * MOST_NUMBERS + "]") == [1.0] * MOST_NUMBERS
    assert numbers("[1]".ljust(LONGEST_LITERAL)) == [1.0]
    assert numbers("[" + "9" * 100 + "]") == [float("9" * 100)]
    assert math.copysign(1, numbers("[-0.0]")[0]) == -1
