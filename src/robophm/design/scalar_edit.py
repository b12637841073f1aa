"""One scalar of a design put in place of another, in its text: all else stays letter for letter."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from robophm.core.yaml_values import Lines

_VALUE = re.compile(r"""(?:"[^"\\]*"|'[^']*'|[^\s,{}\[\]#&*!|>"'][^,{}\[\]#]*?)(?=\s*(?:$|\s\#|[,}]))""")
"""A scalar on one line, up to a remark, or to what follows it in braces."""


def is_scalar(value: object) -> bool:
    """Whether a value is a text or a number, no mapping and no list."""
    return isinstance(value, str | int | float)


def with_scalar(text: str, lines: Lines, place: Sequence[str], written: str) -> str | None:
    """Return the text with another scalar, as it is ``written``, at a place; None where its line is not a plain one.

    Only the line is looked at: whether the text means what it should is for the caller to see.
    """
    number = lines.get(tuple(place))
    if number is None or "\n" in written:
        return None
    all_lines = text.splitlines(keepends=True)
    line = all_lines[number - 1].rstrip("\r\n")
    keys = [*re.finditer(rf"(?:^|(?<=[\s{{,])){re.escape(place[-1])}:\s+", line)]
    value = _VALUE.match(line, keys[0].end()) if len(keys) == 1 else None
    if value is None:
        return None
    end = all_lines[number - 1][len(line) :]
    all_lines[number - 1] = f"{line[: value.start()]}{written}{line[value.end() :]}{end}"
    return "".join(all_lines)


def with_value(document: Any, place: Sequence[str], value: object) -> Any:
    """Return a document with a value in place of another one; what is not on the way there is shared.

    Raises LookupError, TypeError or ValueError where there is nothing at this place.
    """
    if not place:
        return value
    copy, key = document.copy(), int(place[0]) if isinstance(document, list) else place[0]
    copy[key] = with_value(document[key], place[1:], value)
    return copy
