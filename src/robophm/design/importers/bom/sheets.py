"""What every sheet of a parts list keeps to, whatever file it is in."""

from __future__ import annotations

MAX_ROWS = 100_000

MAX_COLUMNS = 1_000


class SheetError(ValueError):
    """What is wrong with a file, before its name is known."""
