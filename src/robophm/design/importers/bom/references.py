"""Reference designators of schematics: 'R1, R2, R5-R7' is five parts, and five parts are 'R1, R2, R5-R7'."""

from __future__ import annotations

import re
from collections.abc import Sequence

MOST_REFERENCES = 10_000
"""The most references in one cell."""

_APART = re.compile(r"(?:(?<=\d)\s*[/&+]\s*|\s+(?:and|und|et)\s+)(?=[A-Za-z]{1,10}\d)|[,;\s]+")
_RANGE = re.compile(
    r"([A-Za-z_]{1,10})(\d{1,9})\s*(?:-|–|—|\.\.\.?|…|\bto\b|\bbis\b)\s*([A-Za-z_]{1,10})(\d{1,9})(?![\w.])", re.ASCII
)
_SPACED = re.compile(r"(?<![\w-])([A-Za-z]{1,3}) (\d{1,4})(?=[,;]|$)", re.ASCII)
"""C 2, C 3"""
_ONE = re.compile(r"[A-Za-z_*#]{1,10}\d{1,9}[A-Za-z]?(?:[-_.:][\w.]{1,20})?", re.ASCII)
_NUMBERED = re.compile(r"([A-Za-z_]+)([1-9]\d{0,8}|0)", re.ASCII)


class ReferencesError(ValueError):
    """A cell that holds no list of references; its text is what was expected."""


def expand(text: str) -> tuple[str, ...]:
    """Return the references of a cell, in its order. Raises ReferencesError with what was expected."""
    found: list[str] = []
    text = _SPACED.sub(r"\1\2", text)
    at = 0
    for match in _RANGE.finditer(text):
        begin, low, again, high = match[1], match[2], match[3], match[4]
        if again != begin:
            continue  # R1-C4 is a name, if anything
        found += _split(text[at : match.start()])
        at = match.end()
        count = int(high) - int(low) + 1
        if count < 1:
            raise ReferencesError(f"a range that ascends, not {match[0]}")
        if len(found) + count > MOST_REFERENCES:
            raise ReferencesError(f"at most {MOST_REFERENCES:,} references, not the {count:,} of {match[0]}")
        width = len(low) if low.startswith("0") else 0
        found += [f"{begin}{number:0{width}d}" for number in range(int(low), int(high) + 1)]
    found += _split(text[at:])
    if len(found) > MOST_REFERENCES:
        raise ReferencesError(f"at most {MOST_REFERENCES:,} references, not {len(found):,}")
    return tuple(found)


def _split(text: str) -> list[str]:
    return [item for item in _APART.split(text) if item]


def are_references(text: str) -> bool:
    """Whether a cell looks like references and nothing else."""
    try:
        found = expand(text[:2000])
    except ReferencesError:
        return True  # of a wrong range, but a range
    return bool(found) and all(_ONE.fullmatch(item) for item in found[:20])


def prefix(reference: str) -> str:
    """Return the letters that say what a part is: 'R' for R12."""
    match = re.match(r"[A-Za-z]+", reference)
    return match[0].upper() if match else ""


def compressed(references: Sequence[str]) -> str:
    """Return the references as text, with runs of three and more written as ranges."""
    runs: list[list[str]] = []
    last: tuple[str, int] | None = None
    for reference in references:
        match = _NUMBERED.fullmatch(reference)
        here = (match[1], int(match[2])) if match else None
        if here and last and here == (last[0], last[1] + 1):
            runs[-1].append(reference)
        else:
            runs.append([reference])
        last = here
    words = [[f"{run[0]}-{run[-1]}"] if len(run) > 2 else run for run in runs]
    return ", ".join(word for run in words for word in run)
