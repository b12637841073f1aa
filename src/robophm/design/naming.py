"""Names and texts from elsewhere as a design file writes them."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Collection

LONGEST_NAME = 180
"""The most characters of a name that is made of a text from elsewhere."""

_PLAIN = re.compile(
    r"[A-Za-z][A-Za-z0-9_.()+-]*( [A-Za-z0-9_.()+-]+)*|\d[\d.e-]* [A-Za-z%][A-Za-z/%]*"  # the latter as 4.7 uF
)
_WORDS = {"true", "false", "null", "yes", "no", "on", "off", "y", "n", "nan", "inf"}


def printable(text: str) -> str:
    """Return the text as one line, without control characters."""
    return "".join(letter if letter.isprintable() else " " for letter in text)


def design_name(text: str, longest: int = LONGEST_NAME) -> str:
    """Return a name as near to a text as a design allows."""
    return printable(text).translate(str.maketrans("/[]", "-()")).strip()[:longest].strip() or "unnamed"


def design_names(texts: Collection[str]) -> dict[str, str]:
    """Return a design name for each of some distinct texts, no two alike; a text that is a valid name keeps it."""
    found: dict[str, str] = {}
    taken = {text for text in texts if design_name(text) == text}
    tried: Counter[str] = Counter()
    for text in texts:
        name = plain = design_name(text)
        while name != text and name in taken:
            tried[plain] += 1
            name = f"{plain} {tried[plain] + 1}"
        taken.add(name)
        found[text] = name
    return found


def quoted(text: str) -> str:
    """Return a text as YAML writes it, in quotes where it might be taken for something else."""
    if _PLAIN.fullmatch(text) and text.lower() not in _WORDS:
        return text
    return json.dumps(printable(text), ensure_ascii=False)
