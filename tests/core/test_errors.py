"""The text of every error is one line, whatever the names in it hold."""

import inspect

import pytest

from robophm.core import errors
from robophm.core.errors import RobophmError, nearest

KINDS = [kind for name, kind in inspect.getmembers(errors, inspect.isclass) if name.endswith("Error")]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("text", ["a\nb", "a\r\nb", "a\x1b\x00b", "a\u2028b", "a\x9b\x85b"])
def test_one_line_without_terminal_codes(kind, text):
    assert str(kind(text)) == "a b"


def test_a_megabyte_is_not_repeated_but_both_ends_are_kept():
    text = str(RobophmError("file: " + "x" * 1_000_000 + " expected y"))
    assert len(text) < 1100
    assert text.startswith("file: x")
    assert text.endswith(" expected y")


def test_the_tree_in_the_docstring_is_the_tree():
    assert all(issubclass(kind, RobophmError) and kind.__name__ in errors.__doc__ for kind in KINDS)


def test_nearest():
    assert nearest("tresholds", ["thresholds", "task"]) == "; did you mean 'thresholds'?"
    assert nearest("GMM", ["gm", "GB"]) == "; did you mean 'gm'?"
    assert nearest("x", ["b", "a"]) == "; known: a, b"
    assert nearest("x", []) == ""
    assert nearest("qq", map(str, range(13))) == ""
