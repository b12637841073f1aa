"""The store of a fleet in one SQLite file: each robot's reports once, its newest ledger, and what was refused."""

from __future__ import annotations

import hashlib
import json
import math
import os
import secrets
import sqlite3
import struct
import threading
import time
import zlib
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple, Self

from robophm.core.errors import RobophmError, StoreError, nearest
from robophm.core.signal import SECOND
from robophm.fleet.payload import Payload, PresentState, Report
from robophm.fleet.tables import prepare
from robophm.stores.outbox import CHANCES, COLUMNS

LONGEST_NAME = 100
"""Letters of a robot's name, at most."""

LONGEST_WAIT = 10.0
"""The most seconds to wait for others who write to the same file."""

TWO_MACHINES = "reports of an epoch that had ended: two machines write as this robot"
"""The reason for which what came is counted, where a robot's token is used by two at once."""


class Committed(NamedTuple):
    """The part of a payload that is in the fleet's store now."""

    epoch: str
    seq: int
    """Number of the last report that was in it; 0 where there was none."""
    new: int
    """Reports that had not been there before."""
    repeated: int


class FleetStore:
    """The reports of all robots of a fleet; for any number of threads."""

    def __init__(self, path: Path, *, make: bool = False) -> None:
        """Open a file, made where there is none if that is asked for. Raises StoreError."""
        if not make and not path.is_file():
            raise StoreError(
                f"{path}: no such file; expected a fleet's store, as robophm fleet serve and token make it"
            )
        self.path = path
        self._turn = threading.RLock()
        self._refused: Counter[tuple[str, str]] = Counter()
        """Numbers of what was refused, by robot and reason, that are not in the file yet."""
        with self._errors():
            if make:  # for its owner alone
                with suppress(FileExistsError):
                    os.close(os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600))
            self._base = sqlite3.connect(path, timeout=LONGEST_WAIT, isolation_level=None, check_same_thread=False)
        try:
            with self._errors():
                prepare(self._base, path)
        except BaseException:
            self._base.close()
            raise

    def add_token(self, robot: str) -> str:
        """Return a new token of a robot, known or new, which is kept nowhere; an earlier one ends. Raises RobophmError.

        It has 256 random bits, so the digest that is kept needs no salt.
        """
        if not robot or len(robot) > LONGEST_NAME or not robot.isprintable() or "/" in robot or robot != robot.strip():
            raise RobophmError(
                f"robot {robot!r:.120}: expected a name of 1 to {LONGEST_NAME} letters that can be printed, without '/'"
            )
        token = f"robophm_{secrets.token_urlsafe(32)}"
        with self._writing():
            self._base.execute(
                "INSERT INTO robot (name, token) VALUES (?, ?) ON CONFLICT (name) DO UPDATE SET token = excluded.token",
                (robot, _digest(token)),
            )
        return token

    def robot_of(self, token: str) -> str | None:
        """Return whose token it is, or None. Raises StoreError."""
        rows = self.rows("SELECT name FROM robot WHERE token = ?", (_digest(token),))
        return rows[0][0] if rows else None

    def knows(self, robot: str) -> bool:
        """Return whether there is a robot of that name. Raises StoreError."""
        return bool(self.rows("SELECT 1 FROM robot WHERE name = ?", (robot,)))

    def rows(self, query: str, values: Sequence[Any] = ()) -> list[tuple[Any, ...]]:
        """Return the rows of a query. Raises StoreError."""
        with self._errors(), self._turn:
            return self._base.execute(query, values).fetchall()

    def number_of(self, robot: str) -> int:
        """Return the number of a robot in the tables. Raises RobophmError where there is none of that name."""
        rows = self.rows("SELECT number FROM robot WHERE name = ?", (robot,))
        if not rows:
            known = [name for (name,) in self.rows("SELECT name FROM robot ORDER BY name")]
            raise RobophmError(f"{self.path}: no robot '{robot:.100}'{nearest(robot, known)}")
        number: int = rows[0][0]
        return number

    def refuse(self, robot: str, why: str) -> None:
        """Count what was refused; robot "" where it is not known whose it was. It is kept by ``keep_counts``."""
        with self._turn:
            self._refused[robot, why] += 1

    def keep_counts(self) -> None:
        """Keep the numbers of what was refused since. Raises StoreError."""
        with self._turn:
            if self._refused:
                with self._writing():
                    pass

    def commit(self, payload: Payload) -> Committed:
        """Keep all of a payload that is not there yet, durably, or nothing of it. Raises StoreError.

        A report is told by robot, epoch and number: one that comes again changes nothing. A present state is kept where
        it is newer.
        """
        now = time.time_ns()
        with self._writing():
            robot = self.number_of(payload.robot)
            number, is_latest = self._epoch(robot, payload.epoch)
            new = [one for one in payload.reports if self._insert(robot, number, one, now)]
            if new:
                self._follow(robot, number, new, now)
                if not is_latest:
                    self._refused[payload.robot, TWO_MACHINES] += len(new)
            if payload.present:
                self._keep_present(robot, number, payload.present)
            if is_latest:
                ahead = (payload.sent - now) / SECOND
                self._base.execute("UPDATE robot SET heard = ?, clock_ahead = ?, waiting = ? WHERE number = ?",
                                   (now, ahead, payload.waiting, robot))  # fmt: skip
        last = payload.reports[-1].seq if payload.reports else 0
        return Committed(payload.epoch, last, len(new), len(payload.reports) - len(new))

    def _epoch(self, robot: int, name: str) -> tuple[int, bool]:
        """The number of an epoch, and whether none began later."""
        (count,) = self._base.execute("SELECT ifnull(max(number), 0) FROM epoch WHERE robot = ?", (robot,)).fetchone()
        found = self._base.execute("SELECT number FROM epoch WHERE robot = ? AND name = ?", (robot, name)).fetchone()
        if found:
            return found[0], found[0] == count
        self._base.execute("INSERT INTO epoch VALUES (?, ?, ?, 0, 0, 0, 0)", (robot, count + 1, name))
        return count + 1, True

    def _insert(self, robot: int, epoch: int, report: Report, now: int) -> bool:
        key = robot, epoch, report.seq
        row = (*key, report.time, now, report.thinned, figures_as_bytes(key, report.time, report.figures))
        return self._base.execute("INSERT OR IGNORE INTO report VALUES (?, ?, ?, ?, ?, ?, ?)", row).rowcount > 0

    def _follow(self, robot: int, epoch: int, new: Sequence[Report], now: int) -> None:
        """Count the new reports of an epoch, and keep the newest where it is the robot's."""
        query = "SELECT last, reports, thinned, missing FROM epoch WHERE robot = ? AND number = ?"
        last, reports, thinned, missing = self._base.execute(query, (robot, epoch)).fetchone()
        for one in new:
            between = one.seq - last - 1
            if between < 0:  # it fills a gap: those are counted anew
                last, reports, thinned, missing = self._counted(robot, epoch)
                break
            left_out = min(one.thinned, between)
            last, reports, thinned, missing = one.seq, reports + 1, thinned + left_out, missing + between - left_out
        self._base.execute("UPDATE epoch SET last = ?, reports = ?, thinned = ?, missing = ? WHERE robot = ? AND "
                           "number = ?", (last, reports, thinned, missing, robot, epoch))  # fmt: skip
        one = new[-1]
        key = robot, epoch, one.seq
        chances = [_real(one.figures[COLUMNS.index(name)]) for name in CHANCES]
        self._base.execute(
            "INSERT INTO newest VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (robot) DO UPDATE SET "
            "epoch = excluded.epoch, seq = excluded.seq, time = excluded.time, received = excluded.received, "
            "figures = excluded.figures, chance_0 = excluded.chance_0, chance_1 = excluded.chance_1, "
            "chance_2 = excluded.chance_2 WHERE (excluded.epoch, excluded.seq) > (newest.epoch, newest.seq)",
            (*key, one.time, now, figures_as_bytes(key, one.time, one.figures), *chances),
        )

    def _counted(self, robot: int, epoch: int) -> tuple[int, int, int, int]:
        """The last number of an epoch, and how many reports it has, let go of and misses."""
        last = reports = let_go = missing = 0
        query = "SELECT seq, thinned FROM report WHERE robot = ? AND epoch = ? ORDER BY seq"
        for seq, thinned in self._base.execute(query, (robot, epoch)):
            left_out = min(thinned, seq - last - 1)
            let_go, missing, reports, last = let_go + left_out, missing + seq - last - 1 - left_out, reports + 1, seq
        return last, reports, let_go, missing

    def _keep_present(self, robot: int, epoch: int, present: PresentState) -> None:
        report = present.report or {}
        ahead = json.dumps([one._asdict() for one in present.ahead])
        bodies = zlib.compress(present.ledger.encode()), zlib.compress(json.dumps(present.report).encode())
        values = (robot, epoch, present.revision, report.get("robot"), report.get("design_hash"), report.get("time"),
                  ahead, *bodies, present_sum(*bodies))  # fmt: skip
        self._base.execute(
            "INSERT INTO present VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT (robot) DO UPDATE SET "
            "epoch = excluded.epoch, revision = excluded.revision, design = excluded.design, "
            "design_hash = excluded.design_hash, time = excluded.time, ahead = excluded.ahead, "
            "ledger = excluded.ledger, report = excluded.report, sum = excluded.sum "
            "WHERE (excluded.epoch, excluded.revision) > (present.epoch, present.revision)", values,
        )  # fmt: skip

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """All that is written meanwhile is kept, or nothing; with it the numbers of what was refused."""
        with self._errors(), self._turn:
            self._base.execute("BEGIN IMMEDIATE")
            try:
                yield
                now, counts = time.time_ns(), [*self._refused.items()]
                self._base.executemany(
                    "INSERT INTO refused VALUES (?, ?, ?, ?) ON CONFLICT (robot, why) DO UPDATE SET number = number + "
                    "excluded.number, last = excluded.last", [(*key, count, now) for key, count in counts],
                )  # fmt: skip
                self._base.execute("COMMIT")
            except BaseException:
                if self._base.in_transaction:
                    self._base.execute("ROLLBACK")
                raise
            self._refused.clear()

    @contextmanager
    def _errors(self) -> Iterator[None]:
        try:
            yield
        except (sqlite3.Error, OSError) as error:
            raise StoreError(f"{self.path}: {error}; expected a fleet's store that can be read and written") from None

    def close(self) -> None:
        """Keep what was counted, and close the file."""
        self.keep_counts()
        self._base.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def figures_as_bytes(key: tuple[int, int, int], time: int, figures: Sequence[float]) -> bytes:
    """Return figures as they are kept, in single precision; a checksum of them, key and time is at their end."""
    body = struct.pack(f"<{len(figures)}f", *(math.copysign(math.inf, one) if abs(one) > _SINGLE else one
                                              for one in figures))  # fmt: skip
    return body + struct.pack("<I", _sum(key, time, body))


def figures_of_bytes(key: tuple[int, int, int], time: int, kept: bytes) -> tuple[float, ...]:
    """Return figures that were kept. Raises StoreError where they are not those."""
    body, told = kept[:-4], kept[-4:]
    if len(told) != 4 or len(body) % 4 or struct.unpack("<I", told)[0] != _sum(key, time, body):
        raise StoreError(f"report {key[2]} of epoch {key[1]} of robot {key[0]} is damaged: its checksum is another")
    return struct.unpack(f"<{len(body) // 4}f", body)


def present_sum(ledger: bytes, report: bytes) -> int:
    """Return the checksum of a present state, of its ledger and report as they are kept."""
    return zlib.crc32(report, zlib.crc32(ledger))


_SINGLE = 3.4028234e38
"""The largest number in single precision."""


def _sum(key: tuple[int, int, int], time: int, body: bytes) -> int:
    return zlib.crc32(body, zlib.crc32(struct.pack("<4q", *key, time)))


def _real(value: float) -> float | None:
    return None if math.isnan(value) else value


def _digest(token: str) -> bytes:
    return hashlib.sha256(token.encode("utf-8", "replace")).digest()
