"""Numbers of JSON messages by path, within bounds; nothing but what a message holds says which fields there are."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from types import SimpleNamespace
from typing import Any

from robophm.core.signal import SECOND, Reduction, Step, named, split_signal, steps_of, wanted_unit
from robophm.transports.live.decoding import Numbers
from robophm.transports.signals.array_reduction import reduced
from robophm.transports.signals.element_names import DEEPEST, NotNamedError, fields_in, namer_of, number

LONGEST = 1 << 20
"""Bytes of a message, beyond which it is not read: a state of VDA 5050 with a hundred nodes has some 30,000."""

MOST_FIELDS = 1000
"""Fields of one topic that are listed."""

LONGEST_PATH = 500
"""Letters of a field's path, beyond which it is not listed."""

LARGEST_NUMBER = (1 << 32) - 1
"""Largest number of a message: VDA 5050 has it in 32 bits, without a sign."""

MOST_ELEMENTS = 50
"""Elements of an array that are looked at for their fields."""

WITHOUT_NAME = "value"
"""The field of a message that is a number or an array, and no object."""


def parsed(raw: bytes) -> SimpleNamespace:
    """Return the object of a message; one that is no object is the field ``value`` of one.

    Raises ValueError or RecursionError where it is no JSON, or out of bounds.
    """
    if len(raw) > LONGEST:
        raise ValueError(f"over {LONGEST} bytes")
    message = json.loads(raw, object_hook=_object)
    return message if isinstance(message, SimpleNamespace) else SimpleNamespace(**{WITHOUT_NAME: message})


def _object(fields: dict[str, Any]) -> SimpleNamespace:
    return SimpleNamespace(**fields)


def numeric_fields(message: SimpleNamespace) -> Iterator[str]:
    """Yield paths of the numbers in a message, in order, each once; ``[]`` stands for the index of an element."""
    found: dict[str, None] = {}

    def look(one: Any, prefix: str, depth: int) -> None:
        if len(found) >= MOST_FIELDS or depth > DEEPEST or len(prefix) > LONGEST_PATH:
            return
        if isinstance(one, SimpleNamespace):
            for name, value in vars(one).items():
                if name.isidentifier() and name.isascii():
                    look(value, f"{prefix}.{name}" if prefix else name, depth + 1)
        elif isinstance(one, list):
            for value in one[:MOST_ELEMENTS]:
                if not isinstance(value, list):  # no path has two indices
                    look(value, f"{prefix}[]", depth + 1)
        elif isinstance(one, int | float):
            found[prefix] = None

    look(message, "", 0)
    yield from found


def kind_of(topic: str, message: SimpleNamespace) -> str:
    """Return the type of a message: ``vda5050/state`` where it has the header of VDA 5050, otherwise ``json``."""
    header = ("headerId", "version", "manufacturer", "serialNumber")
    return f"vda5050/{topic.rpartition('/')[2]}" if all(hasattr(message, name) for name in header) else "json"


def stamp_of(message: SimpleNamespace) -> int:
    """Return the time that a message states [ns]; 0 where there is none.

    ``timestamp`` by ISO 8601 as VDA 5050 has it, in UTC unless it says otherwise, or a ``header.stamp`` as ROS has it.
    """
    with suppress(AttributeError, TypeError, ValueError, OverflowError):
        at = datetime.fromisoformat(message.timestamp)
        since = (at if at.tzinfo else at.replace(tzinfo=UTC)) - datetime(1970, 1, 1, tzinfo=UTC)
        return (since.days * 86400 + since.seconds) * SECOND + since.microseconds * 1000
    with suppress(AttributeError, TypeError, ValueError, OverflowError):
        stamp = message.header.stamp
        nanoseconds = stamp.nanosec if hasattr(stamp, "nanosec") else stamp.nsecs
        return int(stamp.sec if hasattr(stamp, "sec") else stamp.secs) * SECOND + int(nanoseconds)
    return 0


def number_of(message: SimpleNamespace) -> int | None:
    """Return the number of a message among those of its topic; None where there is none.

    ``headerId`` of VDA 5050, which counts the messages of a topic by one. That of a last will is outdated
    (VDA 5050, The connection topic), so that of what tells of a connection is not believed.
    """
    number = getattr(message, "headerId", None)
    if type(number) is not int or not 0 <= number <= LARGEST_NUMBER or hasattr(message, "connectionState"):
        return None
    return number


def broken_state(raw: bytes) -> str:
    """Return the state that a message tells of a connection that is none: OFFLINE; empty for any other message.

    VDA 5050 has it on the topic ``connection``; where a robot is cut off, the broker says it as the robot's last will.
    """
    with suppress(ValueError, RecursionError):
        state = getattr(parsed(raw), "connectionState", None)
        return "" if state == "ONLINE" else str(state)[:50]
    return ""


class JsonDecoder:
    """Reads the wanted numbers of one topic's messages."""

    def __init__(self, topic: str, signals: Collection[str]) -> None:
        self.topic = topic
        self._steps = {signal: steps_of(split_signal(signal)[1]) for signal in sorted(signals)}
        self._told = {signal for signal in signals if named(split_signal(signal)[1])}

    def read(self, raw: bytes, *, whole: bool) -> Numbers:
        """Return the numbers of one message. Raises ValueError or RecursionError as ``parsed``."""
        message = parsed(raw)
        values, absent, found, unnamed, at_index = [], [], [], [], []
        for signal, steps in self._steps.items():
            told = signal in self._told
            try:
                value, name = _walked(message, steps)
                values.append((signal, _number(value, wanted_unit(signal), told=told)))
            except NotNamedError as error:
                unnamed.append((signal, [name for name in error.names if isinstance(name, str)]))
            except (IndexError, AttributeError, TypeError, ValueError, OverflowError):
                absent.append(signal)  # this message has no such number
            else:
                found += [signal] * told
                at_index += [(signal, name)] * bool(name)
        number = number_of(message)
        return Numbers(stamp_of(message), number, values, absent, found, unnamed, at_index, message if whole else None)


def _walked(message: SimpleNamespace, steps: Sequence[Step]) -> tuple[Any, str]:
    """What is at the end of a path, and the names of the elements on it that are told by an index.

    Raises one of many errors where there is nothing.
    """
    chain: list[Any] = [message]
    at_index = []
    for name, element in steps:
        value = getattr(chain[-1], name)
        if isinstance(value, list) is (element is None):
            raise TypeError
        if isinstance(element, Reduction):
            value = reduced(element, value)
        elif element is not None:
            namer = namer_of([fields_in(one) for one in chain], name, fields_in(value[0])) if value else None
            if isinstance(element, int):
                names = namer.names(chain, value) if namer else ()
                at_index += [str(one) for one in names[element : element + 1]]
                value = value[element]
            elif namer is None:
                raise NotNamedError(())
            else:
                value = namer.element(chain, value, element)
        chain.append(value)
    return chain[-1], "/".join(at_index)


def _number(value: Any, unit: str | None, *, told: bool) -> float:
    """A value as a number; of an element that is told by its name a text is read too. Raises TypeError."""
    if isinstance(value, int | float) or (told and isinstance(value, str)):
        return number(value, unit)
    raise TypeError
