"""When parts are due as a calendar that others subscribe to: iCalendar, RFC 5545."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import UTC, datetime, timedelta
from hashlib import sha256

from robophm.core.signal import SECOND
from robophm.health.part_due import Dues, PartDue
from robophm.report.words import duration_text

AHEAD = 10 * 8766.0
"""Hours of calendar time beyond which nothing is put into a calendar."""

_LONGEST = 75  # bytes of a line (RFC 5545, 3.1)


def calendar(robot: str, identity: str, found: Dues, known_to: int | None) -> str:
    """Return the parts that are due, each as an event of a whole day, the day before which it is to be done.

    ``identity``: the robot's, from which with the part's path the name of an event is made, that stays the same while
    the day moves; ``known_to``: time of which the figures are [ns since the epoch], None: of a new robot, so of now.
    """
    now = datetime.now(UTC) if known_to is None else datetime.fromtimestamp(known_to / SECOND, UTC)
    lines = [
        "BEGIN:VCALENDAR", "VERSION:2.0", "PRODID:-//robophm//maintenance//EN", "CALSCALE:GREGORIAN",
        "METHOD:PUBLISH", f"X-WR-CALNAME:{_text(f'Maintenance of {robot}')}",
    ]  # fmt: skip
    for one in found.parts:
        if one.due is not None and one.due <= AHEAD:
            lines += _event(robot, identity, one, found.risk, now)
    return "".join(f"{line}\r\n" for line in _folded([*lines, "END:VCALENDAR"]))


def _event(robot: str, identity: str, one: PartDue, risk: float, now: datetime) -> list[str]:
    day = (now + timedelta(hours=one.due or 0.0)).date()
    name = sha256(f"{identity}\0{one.part}".encode()).hexdigest()[:32]
    said = [f"{one.why}."]
    if one.state == "ahead":
        said.append(
            f"Until then it fails with {100 * risk:g} %. It fails within {duration_text(one.early)} with 5 %, "
            f"{duration_text(one.median)} with 50 %, {duration_text(one.late)} with 95 %."
        )
    return [
        "BEGIN:VEVENT",
        f"UID:{name}@robophm",
        f"DTSTAMP:{now.astimezone(UTC):%Y%m%dT%H%M%SZ}",
        f"DTSTART;VALUE=DATE:{day:%Y%m%d}",
        f"DTEND;VALUE=DATE:{day + timedelta(days=1):%Y%m%d}",
        f"SUMMARY:{_text(f'{robot}: replace {one.part}')}",
        f"DESCRIPTION:{_text(' '.join(said))}",
        "TRANSP:TRANSPARENT",
        "END:VEVENT",
    ]


def _text(said: str) -> str:
    """A text as a value (RFC 5545, 3.3.11); control characters may not stand in it."""
    for character in ("\\", ";", ","):
        said = said.replace(character, f"\\{character}")
    return "".join(one if one.isprintable() else "\\n" if one == "\n" else " " for one in said)


def _folded(lines: Iterable[str]) -> Iterable[str]:
    """Lines of at most 75 bytes, none of which is cut within a character."""
    for line in lines:
        rest, most = line.encode(), _LONGEST
        pieces = []
        while len(rest) > most:
            cut = most
            while rest[cut] & 0xC0 == 0x80:
                cut -= 1
            pieces.append(rest[:cut])
            rest, most = rest[cut:], _LONGEST - 1
        yield "\r\n ".join(piece.decode() for piece in [*pieces, rest])
