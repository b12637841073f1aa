"""How tables of lives say that a part failed, still worked, or had failed already: our words and those of others.

lifelines and R say that something was seen to fail (``event``, ``E``, ``observed``, 1); reliability and SurPyval that
it was censored (``c``, of which SurPyval's -1 is left and 2 within an interval). What could mean either is refused:
1 of a ``C`` or ``cens`` is a failure in some of lifelines' tables, and a survivor in SurPyval's, whose times are ``x``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

from robophm.core.errors import DataError
from robophm.learning.table import YES, Row

Fate = Literal["failed", "worked", "left", "within"]

FATE_COLUMNS: Mapping[str, Sequence[str]] = {
    "censored": ("suspended", "working", "suspension"),
    "event": ("e", "observed", "event observed", "event_observed", "failed", "death", "dead", "died"),
    "status": ("state",),
    "c": ("cens", "censor", "censoring", "censor code", "censoring code", "delta"),
}
"""Columns by which a table may state whether parts failed, with other headings of each; a table has at most one."""

_WORDS: Mapping[str, Sequence[str]] = {
    "failed": ("f", "failure", "fail", "dead", "died", "event", "observed"),
    "worked": ("c", "s", "censored", "right", "working", "alive", "suspended", "suspension", "none"),
    "left": (),
}
_EVENT = {"failed": (*_WORDS["failed"], *YES["yes"], "yes", "1.0"),
          "worked": (*_WORDS["worked"], *YES["no"], "no", "0.0"), "left": ()}  # fmt: skip
_SURPYVAL = {"failed": (*_WORDS["failed"], "0", "0.0"), "worked": (*_WORDS["worked"], "1", "1.0"),
             "left": ("-1", "-1.0"), "within": ("2", "2.0", "interval")}  # fmt: skip
_CENSORED = {"failed": (*YES["no"], "no"), "worked": (*YES["yes"], "yes", "right"), "left": ()}


def fate_column(path: str, rows: Sequence[Row]) -> str:
    """The column of ``FATE_COLUMNS`` that a table has; "censored" where it has none.

    Raises DataError where it has two, or numbers that mean a failure by one convention and a survivor by another.
    """
    said = [name for name in FATE_COLUMNS if any(name in row.cells for row in rows)]
    if said == ["event", "c"] and rows[0].headings["event"].casefold() == "e":
        raise DataError(f"{path}: column 'e' beside 'c' is in which way a part failed, as SurPyval has it; expected it"
                        " headed 'mode'")  # fmt: skip
    if len(said) > 1:
        raise DataError(f"{path}: columns '{said[0]}' and '{said[1]}' both say what failed; expected one of them")
    if said == ["status"]:
        for row in rows:
            if row.text("status") in ("2", "2.0"):
                raise row.error("2 is a failure to some (R) and an interval to others; expected 0 and 1, or words,"
                                " or a column 'censored'", "status")  # fmt: skip
        if {row.text("status") for row in rows} <= {"1", "1.0", ""}:
            raise rows[0].error("1 alone: failed, or censored? expected 0 among them, words, or a column 'censored'",
                                "status")  # fmt: skip
    if said == ["c"] and not _of_surpyval(rows):
        for row in rows:
            if row.text("c") in ("0", "0.0", "1", "1.0"):
                raise row.error(f"{row.text('c')}: failed, or censored? 1 is the one to some and the other to others; "
                                "expected words, or a column 'event' (1: it failed) or 'censored' (1: it still worked)",
                                row.headings["c"])  # fmt: skip
    return said[0] if said else "censored"


def _of_surpyval(rows: Sequence[Row]) -> bool:
    """Whether a table is as SurPyval has it: its times are x, or xl and xr, or it has one of its other numbers."""
    headings = {heading.casefold() for heading in rows[0].headings.values()}
    return bool(headings & {"x", "xl", "xr"}) or any(row.text("c") in ("-1", "-1.0", "2", "2.0") for row in rows)


def fate(row: Row, column: str) -> Fate:
    """Whether the part of a row failed, still worked, had failed before, or failed within an interval.

    Raises DataError, with the line, where the column is empty or has an unknown word.
    """
    spellings = {"censored": _CENSORED, "c": _SURPYVAL}.get(column, _EVENT)
    try:
        found: str = row.choice(column, spellings, "failed" if column == "censored" else "")
    except DataError as error:
        raise DataError(f"{error}; in which way a part failed is a column 'mode'") from None
    if not found:
        raise row.error("is empty; expected whether it failed", column)
    return found  # type: ignore[return-value]
