"""Topics of recordings in the rows of tables, with their rates and gaps, and their fields with units."""

from __future__ import annotations

from collections.abc import Sequence

from robophm.core.signal import HOUR
from robophm.measured.overview import LOOKED_INTO, Topic, per_second, within_bursts
from robophm.measured.splits import NAMING, Splits
from robophm.report.words import duration_text, moment_text, number_text

FIELD_COLUMNS = ["topic", "type", "fields [unit]"]


def span_text(some: Splits) -> str:
    """Return in words when it was recorded."""
    one = some.seen
    none = "no message that can be read; what is wrong stands below" if one.notes else "no messages"
    begin, end = one.span or (0, 0)
    return f"{moment_text(begin)}, {duration_text((end - begin) / HOUR)}" if one.span else none


def topic_rows(some: Splits, topics: Sequence[Topic]) -> tuple[list[str], list[list[str]]]:
    """Return the columns of a table of topics, and a row of each: messages, rate, when it was heard, gaps."""
    begin, _ = some.seen.span or (0, 0)
    partly = any(count < len(some.files) for count in some.with_topic.values())
    rows = []
    for topic in topics:
        rate, heard = per_second(topic), ["–", "–"]
        if topic.span:
            first, last = topic.span
            heard = [duration_text(round((since - other) / 1e6) * 1e6 / HOUR)
                     for since, other in ((first, begin), (last, first))]  # fmt: skip
        gaps = "–"
        if topic.longest_gap:
            at, length = topic.longest_gap
            many = f"{topic.gap_count:,}" if topic.bursts is False else _bursts(topic)
            gaps = f"{many}; {duration_text(length / HOUR)} from {moment_text(at)[5:19]}"
        per = "–" if rate is None else " … ".join(dict.fromkeys(number_text(each, 3) for each in rate))
        files = [f"{some.with_topic[topic.name]:,}"] if partly else []
        rows.append([topic.name, *files, f"{topic.messages:,}", per, *heard, gaps])
    columns = ["topic", *(["in files"] if partly else []), "messages", "per s", "first after", "for", "gaps; longest"]
    return columns, rows


def field_rows(some: Splits, topics: Sequence[Topic]) -> list[list[str]]:
    """Return a row of each topic: its type, and its fields with their units or why it has none."""
    looked = len(some.files) > NAMING
    return [
        [topic.name, topic.type.replace("/msg/", "/") or "?", ", ".join(_fields(topic, looked)) or _no_numbers(topic)]
        for topic in topics
    ]


def field_notes(some: Splits, topics: Sequence[Topic]) -> list[str]:
    """Return what the signs in these rows mean, of those that are there."""
    notes = []
    if any(topic.names and (len(some.files) > NAMING or topic.messages > LOOKED_INTO) for topic in topics):
        notes.append("…: maybe others too, as some messages were looked into")
    if any(topic.lengths for topic in topics):
        notes.append("(…): elements in the first message")
    return notes


def _fields(topic: Topic, looked: bool) -> list[str]:
    """The fields of a topic, how many elements arrays have at first, and the names of those that have some.

    ``looked``: some files were looked into for names.
    """
    shown = []
    for name, unit in topic.fields.items():
        head, array, tail = name.rpartition("[]")
        length = topic.lengths.get(head + array) if array and not tail else None
        if "header." not in name:
            shown.append(name + (f" ({length:,})" if length is not None else "") + (f" [{unit}]" if unit else ""))
    more = " …" if looked or topic.messages > LOOKED_INTO else ""
    return shown + [f"{field} of {', '.join(of)}{more}" for field, of in topic.names.items()]


def _bursts(topic: Topic) -> str:
    """How its messages come in bursts, if they do."""
    within = within_bursts(topic)
    each = f"bursts of {number_text(topic.burst_size, 2)}" + (f" at {number_text(within, 3)}/s" if within else "")
    return f"in {each}" if topic.bursts else f"{topic.gap_count:,}, or {each}"


def _no_numbers(topic: Topic) -> str:
    """Why a topic has none to show: a header's are not."""
    return "no numbers" + (f": {topic.no_numbers}" if topic.no_numbers else " but those of its header")
