"""How tables of lives say that a part failed, still worked, or had failed already: our words and those of others.

lifelines and R say that something was seen to fail (``event``, ``E``, ``observed``, 1); reliability and SurPyval that
it was censored (``c``, of which SurPyval's -1 is left and 2 within an interval). What could mean either is refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

from robophm.core.errors import DataError
from robophm.learning.table import YES, Row

Fate = Literal["failed", "worked", "left", "within"]

FATE_COLUMNS: Mapping[str, Sequence[str]] = {
    "censored": ("suspended", "working", "suspension"),
    "event": ("e", "observed", "event observed", "event_observed", "failed"),
    "status": ("state",),
    "c": (),
}
"""What a table may say it by, and how else that is headed; one of them."""

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
    """By which of FATE_COLUMNS a table says it; "censored" where by none.

    Raises DataError where by two, or by numbers that mean one thing to some and the other to others.
    """
    said = [name for name in FATE_COLUMNS if any(name in row.cells for row in rows)]
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
    return said[0] if said else "censored"


def fate(row: Row, column: str) -> Fate:
    """What became of a part, by its row. Raises DataError for another word."""
    spellings = {"censored": _CENSORED, "c": _SURPYVAL}.get(column, _EVENT)
    found: str = row.choice(column, spellings, "failed" if column == "censored" else "")
    if not found:
        raise row.error("is empty; expected whether it failed", column)
    return found  # type: ignore[return-value]
