"""A handbook's table, kept as it is printed, with the page that it comes from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from robophm.core.errors import ModelError, nearest


@dataclass(frozen=True)
class Source:
    """The source of a formula or table: where it is printed, and how sure its transcription is."""

    title: str
    """Title of the source, such as MIL-HDBK-217F Notice 2."""
    section: str
    """Section of the source, such as 10.1."""
    page: str
    """Page; "–" where it is not known."""
    status: str
    """Statement of how the transcription was checked."""

    @property
    def printed(self) -> bool:
        """Whether it is a document with sections; else it is somebody's own figure or equation."""
        return self.section != "–"

    def __str__(self) -> str:
        if not self.printed:
            return self.title
        numbered = any(letter.isdigit() for letter in self.page[:3])  # 10-1 or A-3, not "Table 4"
        page = f", {'p. ' if numbered else ''}{self.page}" if self.page != "–" else ""
        return f"{self.title} §{self.section}{page}"


@dataclass(frozen=True)
class Table(Mapping[str, float]):
    """Named rows of one or more numbers; ``table[key]`` is the first column, ``table.cell(key, column)`` any.

    ``text`` holds one row a line: the key, then one number for each column, then what the row means.
    """

    name: str
    source: Source
    text: str = field(repr=False)
    columns: tuple[str, ...] = ("value",)
    rows: Mapping[str, tuple[float, ...]] = field(init=False, repr=False, compare=False)
    notes: Mapping[str, str] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        rows: dict[str, tuple[float, ...]] = {}
        notes: dict[str, str] = {}
        for line in self.text.strip().splitlines():
            words = line.split(maxsplit=1 + len(self.columns))
            key, numbers = words[0], words[1 : 1 + len(self.columns)]
            if key in rows or len(numbers) != len(self.columns):
                raise ValueError(f"table {self.name}: bad or repeated row {line!r}")
            rows[key] = tuple(float(number) for number in numbers)
            notes[key] = " ".join(words[1 + len(self.columns) :]).lstrip("# ")
        object.__setattr__(self, "rows", rows)
        object.__setattr__(self, "notes", notes)

    def __getitem__(self, key: str) -> float:
        return self.cell(key, self.columns[0])

    def __contains__(self, key: object) -> bool:
        return key in self.rows

    def cell(self, key: str, column: str) -> float:
        """Return one number of a row. Raises ModelError for a row that the table does not have."""
        if key not in self.rows:
            raise ModelError(f"{self.name}: no row '{key}' in {self.source}{nearest(key, self.rows)}")
        return self.rows[key][self.columns.index(column)]

    def __iter__(self) -> Iterator[str]:
        return iter(self.rows)

    def __len__(self) -> int:
        return len(self.rows)

    def __hash__(self) -> int:
        return hash((self.name, self.text))


ROUNDING = 1e-12
"""Relative difference from a limit at which a number still counts as the limit: conversions and ratios round."""


def above(value: npt.ArrayLike, limit: npt.ArrayLike) -> npt.NDArray[np.bool_]:
    """Whether a value is more than a limit, and not the limit itself: 2.1 V of 7 V are 0.3."""
    result: npt.NDArray[np.bool_] = np.asarray(value) > np.asarray(limit) + ROUNDING * np.abs(limit)
    return result


def below(value: npt.ArrayLike, limit: npt.ArrayLike) -> npt.NDArray[np.bool_]:
    """Whether a value is less than a limit, and not the limit itself."""
    result: npt.NDArray[np.bool_] = np.asarray(value) < np.asarray(limit) - ROUNDING * np.abs(limit)
    return result


def band(value: npt.ArrayLike, limits: tuple[float, ...], results: tuple[float, ...]) -> npt.NDArray[np.float64]:
    """The result of the first band whose upper limit is not below the value; shape of ``value``.

    ``limits`` ascend; the last may be infinite. A value above the last limit gives NaN.
    """
    padded, ends = np.array([*results, np.nan]), np.array(limits)
    return padded[np.searchsorted(ends + ROUNDING * np.abs(ends), np.asarray(value, dtype=float), side="left")]
