"""Messages of a topic side by side: their times and fields, joined and put in order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robophm.transports.recordings.columns.field_extraction import Ints
from robophm.transports.signals.source import STAMP_LIMIT, SignalColumns


@dataclass(frozen=True)
class TopicColumns:
    """Messages of one topic as columns, in order of receipt: a row is a message."""

    received: Ints
    """Time when each message was recorded [ns]."""
    stamps: Ints | None
    """Header stamp of each message [ns]; None where the type has no header."""
    values: Mapping[str, NDArray[np.float64]]
    """Values of each field, NaN where the message has no such element."""
    absent: Mapping[str, NDArray[np.bool_]]
    """Flags of the messages that have no such element, for each field with such messages."""

    def __len__(self) -> int:
        return len(self.received)

    @cached_property
    def times(self) -> Ints:
        """Return the time of each sample [ns]: the header stamp, or receipt where that is zero or more than 10 s
        off."""
        if self.stamps is None:
            return self.received
        return np.where(believed_stamps(self.stamps, self.received), self.stamps, self.received)

    def heard(self, field: str) -> SignalColumns:
        """Return the samples of one field, without the messages that do not have it."""
        one = SignalColumns(self.received, self.times, self.values[field])
        return one.rows(~self.absent[field]) if field in self.absent else one


Block = dict[str, TopicColumns]
"""Messages of a stretch of time, by topic."""


def by_signal(block: Block) -> dict[str, SignalColumns]:
    """Return the samples of every field in a block."""
    return {f"{topic}.{field}": part.heard(field) for topic, part in block.items() for field in part.values}


def believed_stamps(stamps: Ints, received: Ints) -> NDArray[np.bool_]:
    """Return which header stamps are taken: those not zero and at most 10 s off receipt."""
    believed: NDArray[np.bool_] = (np.abs(stamps - received) <= STAMP_LIMIT) & (stamps != 0)
    return believed


def time_order(times: Ints) -> Any:
    """Return the index that puts times in ascending order; equal ones stay as they came."""
    return slice(None) if (times[1:] >= times[:-1]).all() else np.argsort(times, kind="stable")


def joined_columns(parts: Sequence[TopicColumns]) -> TopicColumns:
    """Return parts of one topic as one, in order of receipt."""
    if len(parts) == 1:
        return parts[0]
    received = np.concatenate([part.received for part in parts])
    some = [part.stamps if part.stamps is not None else np.zeros(len(part), np.int64) for part in parts]
    stamped = any(part.stamps is not None for part in parts)
    joined = TopicColumns(
        received,
        np.concatenate(some) if stamped else None,
        {field: np.concatenate([part.values[field] for part in parts]) for field in parts[0].values},
        {
            field: np.concatenate([part.absent.get(field, np.zeros(len(part), np.bool_)) for part in parts])
            for field in parts[0].values
            if any(field in part.absent for part in parts)
        },
    )
    order = time_order(received)
    return joined if isinstance(order, slice) else rows_of(joined, order)


def rows_of(columns: TopicColumns, rows: Any) -> TopicColumns:
    """Return the columns of some of the messages, given by ``rows``."""
    return TopicColumns(
        columns.received[rows],
        None if columns.stamps is None else columns.stamps[rows],
        {field: values[rows] for field, values in columns.values.items()},
        {field: absent[rows] for field, absent in columns.absent.items() if absent[rows].any()},
    )
