"""A signal is one number of one topic over time: ``/topic.field[2]``, or ``/joint_states.effort[elbow]`` by a name.

Of an array of raw samples it may be one number of them all: ``/vibration.data[:rms]``.
"""

from __future__ import annotations

import re
from typing import Literal, NamedTuple, Self, cast

from robophm.core.errors import SourceError

SECOND = 1_000_000_000
"""Nanoseconds in a second: a sample's time is an integer of nanoseconds."""

HOUR = 3600 * SECOND
"""Nanoseconds in an hour."""

DAY = 24 * HOUR
"""Nanoseconds in a day."""

CLOCK = "clock"
"""The signal by which a live source says that time went on although the robot said nothing."""

REORDERED = "order changed: "
"""Prefix of a count: values of a signal by an index at which messages had another element than at first."""

NOT_FINITE = "not finite: "
"""Prefix of a count: values of a signal that are NaN, infinite, or texts that are no number."""

_ROBOT = re.compile(r"[A-Za-z]\w*(/[A-Za-z]\w*)*\Z", re.ASCII)
_TOPIC = re.compile(r"[^.\s\x00-\x1f]+\Z")
_ELEMENT = r"""'[^'\x00-\x1f\x7f]+'|"[^"\x00-\x1f\x7f]+"|[^\[\]\x00-\x1f\x7f]+"""
_STEP = rf"[A-Za-z_][A-Za-z0-9_]*(?:\[(?:{_ELEMENT})\])?"
_FIELD = re.compile(rf"{_STEP}(?:\.{_STEP})*\Z")
_BAND = re.compile(r"band\s+(\d+(?:\.\d+)?)\s*-\s*(\d+(?:\.\d+)?)\s+of\s+(\d+(?:\.\d+)?)\Z")
_STEPS = re.compile(rf"([A-Za-z_][A-Za-z0-9_]*)(?:\[({_ELEMENT})\])?(?:\.|\Z)")
_ANY = re.compile(rf"\[(?:{_ELEMENT})\]")
_PAIR = re.compile(r"(?P<whose>[^\x00-\x1f\x7f]+)/(?P<what>[^/\x00-\x1f\x7f]+)\Z")
_PAIRS = {
    "diagnostics": "status[{whose}].values[{what}].value",
    "dynamic_joint_states": "interface_values[{whose}].values[{what}]",
}
"""The field path of a pair of names, ``motor 3/temperature``, by what is in the name of a topic that has such pairs."""


class Sample(NamedTuple):
    """One value of one signal. Ties in time are ordered by (signal, value), as the tuple compares."""

    time: int
    """Nanoseconds since the epoch."""
    signal: str
    """``/topic.field[2]``, ``/topic.field[name]``, or ``clock``."""
    value: float
    """Value in the unit of the message, unconverted; NaN where the message says so."""


class WantedSignal(str):
    """The name of a signal with the unit in which its values are wanted; it is equal to the name alone.

    By it a text that has a unit of its own, as diagnostics have them, is read.
    """

    unit: str | None

    def __new__(cls, name: str, unit: str | None = None) -> Self:
        """Return the name with its unit."""
        made = super().__new__(cls, name)
        made.unit = unit
        return made


def wanted_unit(signal: str) -> str | None:
    """The unit in which values of a signal, or of a field of one, are wanted; None where nobody says."""
    return signal.unit if isinstance(signal, WantedSignal) else None


def is_topic(text: str) -> bool:
    """Whether a text can be the topic of a signal: it has no dots and blanks."""
    return bool(_TOPIC.match(text))


def is_robot_name(text: str) -> bool:
    """Whether a text can be the name of one of several robots, and its namespace: ``amr_7``, ``hall/amr_7``."""
    return bool(_ROBOT.match(text))


def signal_name(topic: str, field: str) -> str:
    """The name of a signal, ``/topic.field[2]``; a pair of names, ``motor 3/temperature``, is spelled out.

    Raises SourceError where the field is not a path of names with optional indices, or the topic has a dot or blank.
    """
    if not is_topic(topic):
        raise SourceError(f"'{topic}' is not a topic; expected e.g. '/power/temperature', without dots and blanks")
    field = _spelled_out(topic, field)
    if not _FIELD.match(field):
        raise SourceError(
            f"field '{field}' of topic '{topic}' is not a field path; expected e.g. 'pose.x' or 'effort[elbow]'"
        )
    steps_of(field)
    return f"{topic}.{field}"


def split_signal(signal: str) -> tuple[str, str]:
    """Topic and field of a signal name. Raises SourceError where there is no field."""
    topic, dot, field = signal.partition(".")
    field = _spelled_out(topic, field)
    if not dot or not _FIELD.match(field):
        raise SourceError(f"signal '{signal}' names no field; expected '/topic.field'")
    return topic, field


def _spelled_out(topic: str, field: str) -> str:
    """The path of a pair of names on a topic of diagnostics or of dynamic joint states; any other field as it is."""
    if not (pair := None if _FIELD.match(field) else _PAIR.match(field)):
        return field
    names = {key: bracketed(name) for key, name in pair.groupdict().items()}
    return next((path.format(**names) for part, path in _PAIRS.items() if part in topic), field)


def bracketed(name: str) -> str:
    """The name of an element as it is written in a field path: quoted where it would be read as something else."""
    quote = '"' if "'" in name else "'"
    other = (name.isdecimal() and name.isascii()) or name.startswith(":") or {*"[]"} & {*name}
    return f"{quote}{name}{quote}" if other else name


class Reduction(NamedTuple):
    """One number made of all elements of an array."""

    what: Literal["rms", "kurtosis", "peak", "band"]
    """A statistic about their mean. Noise has a kurtosis of 3; the peak is the largest; band is the rms within one."""
    low: float = 0.0
    high: float = 0.0
    """Ends of the band [Hz]."""
    rate: float = 0.0
    """Rate at which the elements were sampled [Hz]."""


Element = int | str | Reduction
"""An element of an array: an index, a name that the message gives it, or one number made of all elements."""


class Step(NamedTuple):
    """One step of a field path: a name, and an element where it is an array."""

    field: str
    element: Element | None
    """The element of an array that is meant; None where there is no array."""


def steps_of(field: str) -> list[Step]:
    """A field path step by step. Digits are an index; quoted, ``effort['7']``, they are a name, as are all others.

    What begins with a colon is made of all elements: ``[:rms]``, ``[:band 100-400 of 12000]``. Raises SourceError where
    that is nothing known.
    """
    return [Step(name, _element(element)) for name, element in _STEPS.findall(field)]


def _element(text: str) -> Element | None:
    if not text:
        return None
    if text[0] == ":":
        return _reduction(text)
    quoted = len(text) > 2 and text[0] == text[-1] and text[0] in "'\""
    return text[1:-1] if quoted else int(text) if text.isdecimal() and text.isascii() else text


def _reduction(text: str) -> Reduction:
    what = text[1:].strip()
    if what in ("rms", "kurtosis", "peak"):
        return Reduction(cast(Literal["rms", "kurtosis", "peak"], what))
    if band := _BAND.match(what):
        low, high, rate = (float(one) for one in band.groups())
        if low < high <= rate / 2:
            return Reduction("band", low, high, rate)
        raise SourceError(f"'[{text}]': expected a band that ascends, to at most half of the rate, {rate / 2:g} Hz")
    raise SourceError(
        f"'[{text}]' is nothing that is made of an array; expected [:rms], [:kurtosis], [:peak] or e.g. "
        "[:band 100-400 of 12000], in Hz"
    )


def reduction_of(field: str) -> tuple[str, Reduction] | None:
    """The array of a field path, ``data``, and what is made of it; None of a path to one number."""
    if "[:" not in field:
        return None
    element = steps_of(field)[-1].element
    return (field[: field.rindex("[:")], element) if isinstance(element, Reduction) else None


def named(field: str) -> bool:
    """Whether an element in a field path is told by its name."""
    return "[" in field and any(isinstance(step.element, str) for step in steps_of(field))


def no_number(signal: str) -> str:
    """Return why values of a signal are no samples: elements told by name may be texts, such as "8.0 N m"."""
    if named(signal.partition(".")[2]):
        return f"no finite number: {signal}; expected a number, alone or with a unit that fits"
    return f"{NOT_FINITE}{signal}"


def any_element(field: str) -> str:
    """A field path for any index or name: ``effort[]`` for ``effort[2]``."""
    return _ANY.sub("[]", field)
