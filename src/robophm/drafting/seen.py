"""Recordings at a glance: their topics with types and rates, and values of the signals that a design could bind.

A robot that runs is seen alike (``heard``).
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from robophm.core.errors import SourceError, UnitError
from robophm.core.signal import SECOND, any_element, bracketed, signal_name, steps_of
from robophm.core.units import quantity
from robophm.design.importers.urdf.drives import words_of
from robophm.measured.overview import Topic, overview, per_second
from robophm.measured.recordings import Recorded, Signal, recordings, signal_of
from robophm.measured.statistics import statistics_of
from robophm.measured.travel import Travel
from robophm.transports.recordings.looking import elements_of
from robophm.transports.signals.message_units import field_unit

MOST_SIGNALS = 300
"""The largest number of signals whose values are read; further ones are left out, and a note says so."""

HELD = 60 * SECOND
"""How long a value holds, for means."""

KINDS = {
    "temperature": frozenset({"temperature", "temp", "temperatures"}),
    "load": frozenset({"effort", "torque"}),
    "voltage": frozenset({"voltage"}),
    "current": frozenset({"current"}),
    "humidity": frozenset({"humidity"}),
}
"""Stresses that parts answer to, by the words that name them in fields and elements."""

_UNITS = {"temperature": "degC", "load": "N*m", "voltage": "V", "current": "A", "humidity": ""}


@dataclass(frozen=True)
class SeenTopic:
    """A topic that recordings have."""

    name: str
    type: str
    """Without ``/msg/``: sensor_msgs/LaserScan."""
    per_second: float | None
    """Messages a second while it is heard, where that can be told."""

    @property
    def words(self) -> frozenset[str]:
        """The words of its name."""
        return frozenset(words_of(self.name))


@dataclass(frozen=True)
class SeenSignal:
    """A signal that a model input could follow, and its values."""

    topic: str
    field: str
    kind: str
    """A stress of ``KINDS``; or position of a joint, of which edges may be counted, or its velocity."""
    unit: str
    lowest: float = math.nan
    highest: float = math.nan
    samples: int = 0
    speed: float = math.nan
    """Mean speed of a joint [rad/s or m/s], by its velocity or by the changes of its position; else NaN."""

    @property
    def name(self) -> str:
        """``/joint_states.effort[elbow]``"""
        return signal_name(self.topic, self.field)

    @cached_property
    def words(self) -> frozenset[str]:
        """The words of topic, field and element."""
        return frozenset(words_of(f"{self.topic} {self.field}"))

    @property
    def element(self) -> str:
        """The name of its element, of an array: elbow."""
        return next((str(step.element) for step in steps_of(self.field) if step.element is not None), "")

    @property
    def values(self) -> str:
        """The range of its values and their number, in words."""
        if not self.samples:
            return "no value seen"
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.lowest:.4g} … {self.highest:.4g}{unit}, {self.samples:,} samples"


@dataclass(frozen=True)
class Seen:
    """Topics and signals of recordings, or of a robot that runs, with notes on what was not looked at."""

    recorded: tuple[Recorded, ...]
    topics: tuple[SeenTopic, ...]
    signals: tuple[SeenSignal, ...]
    notes: tuple[str, ...] = ()

    def of_type(self, *types: str) -> list[SeenTopic]:
        """The topics of these types."""
        return [one for one in self.topics if one.type in types]

    def and_of(self, other: Seen) -> Seen:
        """Return these with the topics and signals of others that are not among them."""
        topics = {one.name: one for one in (*other.topics, *self.topics)}
        signals = {one.name: one for one in (*other.signals, *self.signals)}
        return Seen(
            (*self.recorded, *other.recorded), tuple(topics.values()), tuple(signals.values()),
            (*self.notes, *other.notes),
        )  # fmt: skip


NOTHING = Seen((), (), ())


def look(paths: Sequence[Path]) -> Seen:
    """Look through recordings, or folders of them, without reading more values than the signals need.

    Raises SourceError where one cannot be read.
    """
    if not paths:
        return NOTHING
    found = recordings(paths)
    looks = [overview(one) for one in found]
    topics = {topic.name: topic for one in reversed(looks) for topic in one.topics}
    seen = [
        SeenTopic(name, plain_type(one.type), max(per_second(one) or (), default=None))
        for name, one in sorted(topics.items())
    ]
    sought = [
        signal for one, look in zip(found, looks, strict=True) for signal in bindable(look.topics, _elements(one))
    ]
    sought = list({one.name: one for one in sought}.values())
    notes = [f"{len(sought) - MOST_SIGNALS:,} signals more were not looked at"] if len(sought) > MOST_SIGNALS else []
    return Seen(tuple(found), tuple(seen), tuple(_valued(found, sought[:MOST_SIGNALS])), tuple(notes))


def _elements(one: Recorded) -> Mapping[str, Sequence[str]]:
    """The numbers of messages in arrays, where the recording tells how many there are."""
    return (
        elements_of(one.paths) if any("[]." in field for _, fields in one.topics.values() for field in fields) else {}
    )


def plain_type(type_: str) -> str:
    """A type of messages in the spelling of both generations of ROS: sensor_msgs/LaserScan."""
    return type_.replace("/msg/", "/")


def bindable(topics: Sequence[Topic], elements: Mapping[str, Sequence[str]]) -> Iterator[SeenSignal]:
    """Yield the signals that could be bound, without values: by the words and units of fields and of their elements."""
    for topic in topics:
        fields = [(field, topic.fields[field]) for field in topic.fields if "[]" not in field]
        fields += [(field, topic.fields.get(any_element(field))) for field in elements.get(topic.name, ())]
        inner = " ".join(topic.names)  # what has arrays of its own is no number
        for array, names in topic.names.items():
            for name in names:
                field = f"{array[:-1]}{bracketed(name)}]"
                if f"{field}." not in inner:
                    fields.append((f"{field}.value" if _is_key_value(topic.type, array) else field, None))
        for field, unit in fields:
            if field.startswith("header."):
                continue
            unit = field_unit(topic.type, field) if unit is None else unit
            if kind := _kind(topic.name, topic.type, field, unit):
                yield SeenSignal(topic.name, field, kind, _UNITS.get(kind, "") if unit is None else unit)


def _is_key_value(type_: str, array: str) -> bool:
    return plain_type(type_) == "diagnostic_msgs/DiagnosticArray" and array.endswith(".values[]")


def _kind(topic: str, type_: str, field: str, unit: str | None) -> str:
    *_, last_step = steps_of(field.removesuffix(".value"))
    last = words_of(f"{last_step.field} {last_step.element or ''}")
    if unit == "degC":
        return "temperature"
    if type_.endswith(("/JointState", "/DynamicJointState")):
        for kind in ("position", "velocity"):
            if kind in (steps_of(field)[0].field, last_step.element):
                return kind
    if plain_type(type_).startswith("std_msgs/"):
        last = words_of(topic.rpartition("/")[2])  # its only field says nothing
    for kind, called in KINDS.items():
        if called & set(last) and (unit is None or _fits(unit, _UNITS[kind])):
            return kind
    return ""


def _fits(unit: str, wanted: str) -> bool:
    try:
        quantity(f"1 {unit}" if unit else 1.0, wanted)
    except UnitError:
        return False
    return True


def _valued(found: Sequence[Recorded], sought: Sequence[SeenSignal]) -> Iterator[SeenSignal]:
    signals: list[Signal] = []
    for one in sought:
        try:
            signals.append(signal_of(one.name, found))
        except SourceError:
            continue  # of a recording beside it
    spans: dict[str, tuple[float, float, int]] = {}
    travels: dict[str, Travel] = defaultdict(Travel)
    for seen in statistics_of(found, signals, None, HELD).seen:
        low, high, count = spans.get(seen.signal.name, (math.inf, -math.inf, 0))
        whole = seen.whole
        travels[seen.signal.name] += seen.look.travel
        spans[seen.signal.name] = min(low, whole.lowest), max(high, whole.highest), count + whole.samples
    for one in sought:
        low, high, count = spans.get(one.name, (math.nan, math.nan, 0))
        travel = travels[one.name]
        speed = {"position": travel.pace, "velocity": travel.magnitude}.get(one.kind, math.nan)
        yield SeenSignal(one.topic, one.field, one.kind, one.unit, low, high, count, speed)
