"""The bounds of a sheet of a parts list, whatever kind of file it is in."""

from __future__ import annotations

MAX_ROWS = 100_000

MAX_COLUMNS = 1_000


class SheetError(ValueError):
    """A mistake in a file, before the file's name is known."""
