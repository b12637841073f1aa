"""The design under edit: every state that it was ever in, kept beside its file, so that undo has no limit.

The YAML file stays the truth: it is read when the service starts, and written when somebody saves, atomically and with
a backup. What is not saved yet, and all that can be undone, lies in ``<design>.edits``.
"""

from __future__ import annotations

import difflib
import hashlib
import itertools
import os
import secrets
import sqlite3
import threading
import time
import weakref
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robophm.core.errors import DesignError, StoreError
from robophm.core.yaml_values import MAX_BYTES
from robophm.design.carried_edits import carry
from robophm.design.editing import put, value_at
from robophm.design.entry_edit import same, with_entries
from robophm.design.file import read, write_text
from robophm.design.located_error import LocatedError
from robophm.design.naming import design_name, quoted
from robophm.design.problems import check
from robophm.design.scalar_edit import is_scalar, with_scalar, with_value
from robophm.web.checked import CheckedTexts
from robophm.web.documents import dump, load

VERSION = 1
"""Version of the tables; kept in the file's user_version."""

_SETTLED = 2_000_000_000  # nanoseconds: the coarsest stamps of files are of two seconds
_TABLES = """
CREATE TABLE state (id INTEGER PRIMARY KEY, parent INTEGER, text BLOB NOT NULL, what TEXT NOT NULL) STRICT;
CREATE TABLE here (only INTEGER PRIMARY KEY CHECK (only = 1), state INTEGER NOT NULL, revision INTEGER NOT NULL,
    saved INTEGER) STRICT;
"""


class StaleError(DesignError):
    """Somebody else has changed the design since the revision that a write was made of."""


class OutsideError(DesignError):
    """The file is no longer as it was when it was last read or saved: somebody has edited it by hand."""

    def __init__(self, message: str, digest: str, changes: tuple[str, ...]) -> None:
        super().__init__(message)
        self.digest = digest
        """Digest of what the file holds now: who has seen that may write over it."""
        self.changes = changes
        """Lines of a unified diff of what was changed in it meanwhile, at most MOST_LINES."""


MOST_LINES = 400


def changed_lines(before: str, now: str) -> tuple[str, ...]:
    """Return the lines of a unified diff of a text, without its heading; at most MOST_LINES."""
    lines = difflib.unified_diff(before.splitlines(), now.splitlines(), n=2, lineterm="")
    return tuple(itertools.islice(lines, 2, MOST_LINES + 2))


@dataclass(frozen=True)
class Draft:
    """The design in one state on the way of its edits."""

    revision: int
    """Revision, a number that goes up with every change, an undo among them."""
    state: int
    """Number of the state among all; going back comes to the same one again."""
    text: str
    saved: bool
    """Whether the file holds this text."""
    what: str
    """Edit that made it of the state before; "" where there is none."""
    redo: str | None
    """Edit that would be done again; None where nothing is."""
    undo: bool


class Workspace:
    """One design file with the states that edits have brought it through; for any number of threads."""

    def __init__(self, path: Path) -> None:
        """Open a design, or begin one where there is no file. Raises DesignError, StoreError."""
        self.path = path
        self._lock = threading.RLock()
        self.checked = CheckedTexts()
        """The checked texts, such as that of the design now."""
        self._document: tuple[int, Any] | None = None  # of which state, as ruamel keeps it
        self._revision = 0
        self._seen: str | None = None  # in the file at the last call of follow_file
        self._stamp: tuple[tuple[int, ...], bool] | None = None  # of the file when it was last looked at
        self.on_change: Callable[[dict[str, Any], dict[str, Any]], None] | None = None
        """Told the document before and after each change."""
        if not path.parent.is_dir():
            raise DesignError(f"{path}: no such folder")
        self.begun = not path.exists()
        """Whether there was no file at first."""
        text = new_design(path) if self.begun else read(path)
        edits = path.with_name(path.name + ".edits")
        there = edits if edits.exists() else edits.parent
        self.lasting = os.access(there, os.W_OK) and os.access(edits.parent, os.W_OK)
        """Whether its edits outlive it; they do not where the folder cannot be written."""
        try:
            where = edits if self.lasting else ":memory:"
            self._base = sqlite3.connect(where, timeout=10.0, isolation_level=None, check_same_thread=False)
            weakref.finalize(self, self._base.close)  # who does not close, lets go of it with the workspace
            self._open(text)
        except sqlite3.Error as error:
            raise StoreError(f"{edits}: {error}; expected the edits of {path.name}, or no such file") from None

    def _open(self, text: str) -> None:
        version = self._base.execute("PRAGMA user_version").fetchone()[0]
        tables = self._base.execute("SELECT count(*) FROM sqlite_schema").fetchone()[0]
        if version != VERSION and (version or tables):
            raise sqlite3.DatabaseError(f"version {version}, not {VERSION}")
        if not tables:
            self._base.execute("PRAGMA journal_mode = WAL")
            self._base.executescript(f"BEGIN IMMEDIATE; {_TABLES} PRAGMA user_version = {VERSION}; COMMIT;")
            self._base.execute(f"PRAGMA application_id = {secrets.randbelow(2**31)}")
        self.history: int = self._base.execute("PRAGMA application_id").fetchone()[0]
        """Number of these edits among all others of the same file's name, kept with them."""
        self._base.execute("PRAGMA synchronous = NORMAL")
        if self._base.execute("SELECT count(*) FROM here").fetchone()[0] == 0:
            with self._base:
                first = self._add(None, text, "")
                self._base.execute("INSERT INTO here VALUES (1, ?, 1, ?)", (first, None if self.begun else first))
            return
        _, _, saved = self._here()
        if saved is None or self._text(saved) != text:
            if not self.begun:
                self._take_in(text)
            elif saved is not None:
                self._base.execute("UPDATE here SET saved = NULL")

    def _take_in(self, text: str) -> None:
        """Take in what somebody else made of the file: one more state, undone as any."""
        with self._base:
            found = self._add(self._here()[0], text, "changed outside")
            self._base.execute("UPDATE here SET saved = ?", (found,))
            self._go(found)

    @property
    def revision(self) -> int:
        """Return the revision of the design now; never waits for an edit that is under way."""
        return self._revision

    def draft(self) -> Draft:
        """Return the present state of the design."""
        with self._lock:
            state, revision, saved = self._here()
            parent, what = self._origin(state)
            again = self._base.execute(
                "SELECT what FROM state WHERE parent = ? ORDER BY id DESC LIMIT 1", (state,)
            ).fetchone()
            text = self._text(state)
            same = saved is not None and (saved == state or self._text(saved) == text) and not self._touched(saved)
            return Draft(revision, state, text, same, what, again[0] if again else None, parent is not None)

    def text(self, state: int) -> str:
        """Return the text of any state. Raises DesignError where there is none of that number."""
        with self._lock:
            row = self._base.execute("SELECT 1 FROM state WHERE id = ?", (state,)).fetchone()
            if not row:
                raise DesignError(f"the design has no state {state}")
            return self._text(state)

    def states(self, most: int) -> list[tuple[int, str]]:
        """Return the states on the way here, the latest first: number, and what made it."""
        with self._lock:
            found: list[tuple[int, str]] = []
            state: int | None = self._here()[0]
            while state is not None and len(found) < most:
                parent, what = self._origin(state)
                found.append((state, what))
                state = parent
            return found

    def edit(
        self,
        revision: int,
        change: Callable[[Any], None],
        what: str,
        scalar: tuple[Sequence[str], object] | None = None,
    ) -> Draft:
        """Change the document, comments kept. Raises StaleError, and LocatedError where it cannot be done.

        ``scalar``: a place and its new value, where that is all of the change: then, if it can be, the text is edited
        itself, all else letter for letter.
        """
        with self._lock:
            self._current(revision)
            text = self._with_scalar(*scalar) if scalar else None
            return self._move(self.edited(change, keep=True) if text is None else text, what)

    def _with_scalar(self, place: Sequence[str], value: object) -> str | None:
        """The text with a scalar in place of another one; None where that takes an edit of the document."""
        state = self._here()[0]
        text = self._text(state)
        before = self.checked.of(text)
        try:
            if not is_scalar(value) or not is_scalar(value_at(before.document, place)):
                return None
            wanted = with_value(before.document, place, value)
        except (LocatedError, LookupError, TypeError, ValueError):
            return None
        found = with_scalar(text, before.lines, place, dump(value).removesuffix("\n...\n").removesuffix("\n"))
        if found is None or self.checked.of(found).document != wanted:
            return None
        kept, self._document = self._document, None
        if kept and kept[0] == state:
            put(kept[1], place, value)
            self._document = -1, kept[1]
        return found

    def edited(self, change: Callable[[Any], None], *, keep: bool = False) -> str:
        """Return the text that a change would give. Raises LocatedError where it cannot be done."""
        with self._lock:
            state = self._here()[0]
            cached = self._document if self._document and self._document[0] == state else None
            self._document = None
            before = self._text(state)
            document = cached[1] if cached else load(before)
            change(document)
            text = self._with_entries(before, document) or dump(document)
            if len(text.encode()) > MAX_BYTES:
                raise LocatedError((), f"the design would be more than {MAX_BYTES / 1e6:.0f} MB")
            if keep:
                self._document = -1, document  # of the state that is about to be
            return text

    def _with_entries(self, text: str, document: Any) -> str | None:
        """The text with those of its entries that a document has otherwise; None where that takes writing all anew."""
        before = self.checked.of(text)
        found = with_entries(text, before.lines, before.document, document, dump) if before.document else None
        return found if found is not None and same(self.checked.of(found).document, document) else None

    def replace(self, revision: int, text: str, what: str) -> Draft:
        """Put a whole text in place of the design. Raises StaleError; LocatedError where it is not even YAML."""
        with self._lock:
            self._current(revision)
            if not check(text).document:
                raise LocatedError((), check(text).problems[0].message)
            return self._move(text, what)

    def undo(self, revision: int, edit: int | None = None) -> Draft:
        """Take back the latest edit, or the one that made the state ``edit``; where there is none, nothing happens.

        What came after that edit stays. Raises StaleError, and LocatedError where a later edit touches the same place.
        """
        with self._lock:
            self._current(revision)
            state = self._here()[0]
            if edit is None or edit == state:
                return self._go(self._origin(state)[0])
            before, what = self._known(edit)
            return self._carry(edit, before, f"undo: {what}") if before is not None else self.draft()

    def redo(self, revision: int, edit: int | None = None) -> Draft:
        """Do again what was undone last, or the edit that made the state ``edit``; where there is none, do nothing.

        Raises StaleError, and LocatedError where another edit since touches the same place.
        """
        with self._lock:
            self._current(revision)
            query = "SELECT id FROM state WHERE parent = ? ORDER BY id DESC LIMIT 1"
            row = self._base.execute(query, (self._here()[0],)).fetchone()
            if edit is None or (row and row[0] == edit):
                return self._go(row[0] if row else None)
            before, what = self._known(edit)
            return self._carry(before, edit, what) if before is not None else self.draft()

    def _known(self, edit: int) -> tuple[int | None, str]:
        """The state before an edit, and what it was. Raises DesignError where there is no such edit."""
        self.text(edit)
        return self._origin(edit)

    def _carry(self, before: int, after: int, what: str) -> Draft:
        """Change the design now as one state was changed into another."""
        states = load(self._text(before)), load(self._text(after))
        return self._move(self.edited(lambda document: carry(document, *states), keep=True), what)

    def save(self, revision: int, over: str | None = None) -> Draft:
        """Write the file, what was there kept beside it.

        A file that somebody has edited meanwhile is only written ``over`` in the state, by its digest, that was seen.
        Raises StaleError, OutsideError, and DesignError where it is no design.
        """
        with self._lock:
            self._current(revision)
            draft = self.draft()
            self._not_over(draft, over)
            checked = self.checked.of(draft.text)
            if checked.robot is None:
                first = checked.problems[0]
                raise DesignError(f"not saved: {'/'.join(first.place) or 'the design'}: {first.message}")
            write_text(self.path, draft.text)
            with self._base:
                self._base.execute("UPDATE here SET saved = ?", (draft.state,))
            return self.draft()

    def take(self, revision: int) -> Draft:
        """Take what the file holds in place of the design, to be undone as any edit. Raises StaleError, DesignError."""
        with self._lock:
            self._current(revision)
            text = read(self.path)
            if not check(text).document:
                raise LocatedError((), check(text).problems[0].message)
            saved = self._here()[2]
            if saved is None or self._text(saved) != text or self.draft().text != text:
                self._take_in(text)
                self.begun = False
            return self.draft()

    def _not_over(self, draft: Draft, over: str | None) -> None:
        """Raise OutsideError where the file holds neither what was last read or saved, nor what is to be written."""
        content = read(self.path) if self.path.exists() else None
        saved = self._here()[2]
        known = self._text(saved) if saved is not None else None
        if content is None or content in (known, draft.text):
            return
        digest = hashlib.sha256(content.encode()).hexdigest()
        if over == digest:
            return
        name = self.path.name
        said = f"{name} was changed outside since it was read, and is not written over"
        raise OutsideError(said, digest, changed_lines(known or "", content))

    def _touched(self, saved: int) -> bool:
        """Whether the file holds something else than that state; looked at again only where its stamp has changed."""
        try:
            stat = self.path.stat()
            stamp = (saved, stat.st_mtime_ns, stat.st_size, stat.st_ino)
            if self._stamp and self._stamp[0] == stamp:
                return self._stamp[1]
            touched = read(self.path) != self._text(saved)
        except (OSError, DesignError):
            return True
        settled = time.time_ns() - stat.st_mtime_ns > _SETTLED  # else another write may leave the same stamp
        self._stamp = (stamp, touched) if settled else None
        return touched

    def follow_file(self) -> bool:
        """Take in what somebody has made of the file, where nothing here is lost by it; return whether it is left.

        It is left to whoever edits here where there are edits that are not saved, or where the file is no design. A
        file is taken once it is as it was at the call before: to be called again and again.
        """
        with self._lock:
            state, revision, saved = self._here()
            before, self._seen = self._seen, None
            if saved is None or not self._touched(saved):
                return False
            try:
                text = self._seen = read(self.path)
            except DesignError:
                return True
            mine = self._text(state)
            if text == mine:  # the same was made of it here and there
                with self._base:
                    self._base.execute("UPDATE here SET saved = ?, revision = ?", (state, revision + 1))
            elif mine != self._text(saved) or self.checked.of(text).robot is None:
                return True
            elif text == before:
                self._take_in(text)
            self._here()  # which takes note of the revision
            return False

    def close(self) -> None:
        """Let go of the file of edits."""
        with self._lock:
            self._base.close()

    def _here(self) -> tuple[int, int, int | None]:
        row: tuple[int, int, int | None] = self._base.execute("SELECT state, revision, saved FROM here").fetchone()
        self._revision = row[1]
        return row

    def _origin(self, state: int) -> tuple[int | None, str]:
        query = "SELECT parent, what FROM state WHERE id = ?"
        row: tuple[int | None, str] = self._base.execute(query, (state,)).fetchone()
        return row

    def _text(self, state: int) -> str:
        row = self._base.execute("SELECT text FROM state WHERE id = ?", (state,)).fetchone()
        return zlib.decompress(row[0]).decode()

    def _add(self, parent: int | None, text: str, what: str) -> int:
        values = (parent, zlib.compress(text.encode(), 6), what[:200])
        return int(self._base.execute("INSERT INTO state (parent, text, what) VALUES (?, ?, ?)", values).lastrowid or 0)

    def _current(self, revision: int) -> None:
        if revision != (now := self._here()[1]):
            raise StaleError(f"the design has changed since: revision {now}, not {revision}")

    def _move(self, text: str, what: str) -> Draft:
        state = self._here()[0]
        if text != self._text(state):
            with self._base:
                state = self._add(state, text, what)
                self._go(state)
        if self._document and self._document[0] == -1:
            self._document = state, self._document[1]
        return self.draft()

    def _go(self, state: int | None) -> Draft:
        if state is not None:
            before = self._here()[0]
            with self._base:
                self._base.execute("UPDATE here SET state = ?, revision = revision + 1", (state,))
            if self.on_change:
                self.on_change(*(self.checked.of(self._text(one)).document for one in (before, state)))
        return self.draft()  # which takes note of the revision


def new_design(path: Path) -> str:
    """Return the text that a design begins with: its name."""
    return f"schema_version: 1\nname: {quoted(design_name(path.stem))}\n"
