"""The tables of a fleet, the same in every engine, their version, and how those of an earlier one become them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from robophm.stores.outbox import CHANCES

VERSION = 4
"""Version of the tables."""


class Table(NamedTuple):
    """A table, and what becomes of a row whose key is there already."""

    name: str
    columns: tuple[str, ...]
    """Name and type of each, as SQLite names types; ``NULL`` behind the type of those that may have no value."""
    key: tuple[str, ...]
    kept: str = "DO NOTHING"
    """The SQL behind ON CONFLICT, of what is done then."""

    @property
    def names(self) -> list[str]:
        """Names of the columns, in their order."""
        return [one.partition(" ")[0] for one in self.columns]

    def made(self, types: Mapping[str, str], end: str) -> str:
        """Return the SQL that makes it, with an engine's own names of types, and what ends its statement."""
        columns = ", ".join(_column(one, types) for one in self.columns)
        return f"CREATE TABLE {self.name} ({columns}, PRIMARY KEY ({', '.join(self.key)})){end}"

    def merged(self, source: str) -> str:
        """Return the SQL that takes in the rows of a source, which is VALUES or a query."""
        names, key = ", ".join(self.names), ", ".join(self.key)
        return f"INSERT INTO {self.name} ({names}) {source} ON CONFLICT ({key}) {self.kept}"


def _column(said: str, types: Mapping[str, str]) -> str:
    name, kind, *null = said.split()
    return f"{name} {types.get(kind, kind)}{'' if null else ' NOT NULL'}"


def _replaced(names: list[str], condition: str = "") -> str:
    return f"DO UPDATE SET {', '.join(f'{name} = excluded.{name}' for name in names)}{condition}"


_CHANCES = [f"chance_{at}" for at in range(len(CHANCES))]
_NEWEST = ["epoch", "seq", "time", "received", "figures", *_CHANCES]
_PRESENT = ["epoch", "revision", "design", "design_hash", "time", "ahead", "ledger", "report", "sum"]

HEARD = Table(
    "heard", ("robot INTEGER", "time INTEGER", "clock_ahead REAL", "waiting INTEGER"), ("robot",),
    _replaced(["time", "clock_ahead", "waiting"]),
)  # fmt: skip
"""When each robot last sent something."""
EPOCH = Table(
    "epoch",
    ("robot INTEGER", "number INTEGER", "name TEXT", "last INTEGER", "reports INTEGER", "thinned INTEGER",
     "missing INTEGER", "moved INTEGER"), ("robot", "number"), _replaced(["last", "reports", "thinned", "missing"]),
)  # fmt: skip
"""Stretches of watching; ``number`` is the order in which a robot's epochs came, which is its own order, as it sends
nothing before what is older is committed. ``missing`` are numbers of reports that neither came nor were let go of.
Reports up to number ``moved`` have left the store for files; that is never set by a merge."""
REPORT = Table(
    "report",
    ("robot INTEGER", "epoch INTEGER", "seq INTEGER", "time INTEGER", "received INTEGER", "thinned INTEGER",
     "figures BLOB"), ("robot", "epoch", "seq"),
)  # fmt: skip
NEWEST = Table(
    "newest",
    ("robot INTEGER", "epoch INTEGER", "seq INTEGER", "time INTEGER", "received INTEGER", "figures BLOB",
     *(f"{name} REAL NULL" for name in _CHANCES)), ("robot",),
    _replaced(_NEWEST, " WHERE (excluded.epoch, excluded.seq) > (newest.epoch, newest.seq)"),
)  # fmt: skip
"""The newest report of each robot."""
DAY = Table(
    "day", ("robot INTEGER", "day INTEGER", "time INTEGER", *(f"{name} REAL NULL" for name in _CHANCES)),
    ("robot", "day"),
)  # fmt: skip
"""The report of each robot that came first of those of a day, by its own clock where that is believed."""
PRESENT = Table(
    "present",
    ("robot INTEGER", "epoch INTEGER", "revision INTEGER", "design TEXT NULL", "design_hash TEXT NULL",
     "time INTEGER NULL", "ahead TEXT", "ledger BLOB", "report BLOB", "sum INTEGER"), ("robot",),
    _replaced(_PRESENT, " WHERE (excluded.epoch, excluded.revision) > (present.epoch, present.revision)"),
)  # fmt: skip
"""Newest ledgers and whole reports, and beside them what is asked of many robots at once: ``ahead`` are the
probabilities of failing with what each is mostly of, as JSON."""
REFUSED = Table(
    "refused", ("robot TEXT", "why TEXT", "number INTEGER", "last INTEGER"), ("robot", "why"),
    "DO UPDATE SET number = refused.number + excluded.number, last = excluded.last",
)  # fmt: skip
PROPOSAL = Table(
    "proposal",
    ("number INTEGER", "time INTEGER", "design TEXT", "cohort TEXT", "text_before TEXT", "text_after TEXT",
     "evidence TEXT"), ("number",),
)  # fmt: skip
"""Designs that were proposed by what the fleet has seen; ``cohort``: of whom, empty of all; ``evidence`` as JSON."""
DECISION = Table(
    "decision", ("proposal INTEGER", "place INTEGER", "time INTEGER", "person TEXT", "decided TEXT"),
    ("proposal", "place"),
)  # fmt: skip
"""Decisions of people on proposals, in their order."""

MERGED = (HEARD, EPOCH, REPORT, NEWEST, DAY, PRESENT, REFUSED, PROPOSAL, DECISION)
"""The tables into which rows are merged; beside them is ``robot``, whose numbers the engine gives."""

INDEXES = (
    *(f"CREATE INDEX newest_{at} ON newest ({name})" for at, name in enumerate(_CHANCES)),
    "CREATE UNIQUE INDEX epoch_name ON epoch (robot, name)",
)


def new_tables(number: str, types: Mapping[str, str], end: str) -> list[str]:
    """Return the statements that make all tables, in an engine's own words; ``number``: a key that it counts up."""
    robot = _column("name TEXT", types), _column("token BLOB", types)
    first = f"CREATE TABLE robot (number {number}, {robot[0]} UNIQUE, {robot[1]} UNIQUE, site TEXT)"
    return [first, *(table.made(types, end) for table in MERGED), *INDEXES]
