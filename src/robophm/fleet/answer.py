"""The answer by which a fleet says what it has committed, whatever carries it."""

from __future__ import annotations

from typing import Any

from robophm.core.errors import DataError
from robophm.stores.outbox import Batch


def check(answer: Any, batch: Batch) -> None:
    """Raise DataError unless the answer says that all of the batch is committed."""
    said = answer.get("committed") if isinstance(answer, dict) else None
    one = batch.reports[-1] if batch.reports else None
    expected = {"epoch": one.epoch, "seq": one.seq} if one else said
    if not isinstance(said, dict) or said != expected:
        raise DataError(f"answers {answer!r:.100}; expected a fleet's service, which says what it has committed")
