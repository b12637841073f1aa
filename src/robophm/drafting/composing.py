"""The parts of a draft, from evidence and answers, with the changes that somebody asks for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from robophm.core.errors import RobophmError, nearest
from robophm.design.draft import DraftPart
from robophm.design.importers.urdf import described_parts
from robophm.drafting.answers import NONE, Answers, Known, battery_called, drive_called, entry_called, listed
from robophm.drafting.parts_by_topic import FUSED, parts_by_topic
from robophm.parts import part

_PACKS = ("battery_li_ion", "battery_lfp")
"""Batteries that have an electronic board of their own to watch them."""


@dataclass(frozen=True)
class Change:
    """A part that somebody wants to be another entry of the library, to be added, or to be left out."""

    part: str
    """The path or name of the part; a part is added where the draft has none of that name."""
    words: str
    """The words by which its entry is searched in the library; "none" leaves the part out."""


def change_of(text: str) -> Change:
    """A change as it is written, ``lidar=rplidar a1`` or ``imu=none``. Raises RobophmError."""
    name, equals, words = (piece.strip() for piece in text.partition("="))
    if not (name and equals and words):
        raise RobophmError(f"{text!r:.60}: expected NAME=WORDS, such as 'lidar=rplidar a1', or NAME=none")
    return Change(name, words)


def composed(known: Known, answers: Answers, changes: Sequence[Change] = ()) -> list[DraftPart]:
    """The parts of a robot: what its description and its topics tell of, and what the answers add."""
    described = described_parts(known.description, drive_called(answers.drive)) if known.description else []
    parts = [*parts_by_topic(known.seen, described)]
    parts += _supplied(known, answers)
    parts += _computing(known, answers, parts)
    for words in listed(answers.sensors):
        entry = entry_called(words, what="sensor")
        parts.append(DraftPart("sensing", words, entry.name, "said to be there"))
    names = {one.entry for one in parts}
    inside = {name: whole for whole, several in FUSED.items() if whole in names for name in several}
    parts = [one for one in parts if one.entry not in inside or one.seen == "said to be there"]
    for change in changes:
        parts = changed(parts, change)
    if not parts:
        raise RobophmError("nothing tells of a part; expected a URDF, a recording, or parts by NAME=WORDS")
    return _told_apart(parts)


def left_to_others(known: Known, answers: Answers) -> Iterator[str]:
    """Sensors that are taken to be inside another part, in words."""
    names = {one.entry for one in [*parts_by_topic(known.seen, []), *_computing(known, answers, [])]}
    if known.description:
        names |= {one.entry for one in described_parts(known.description)}
    for whole, inside in FUSED.items():
        if whole in names and (these := [name for name in inside if name in names]):
            yield f"{', '.join(these)}: taken to be inside the part {whole}"


def changed(parts: Sequence[DraftPart], change: Change) -> list[DraftPart]:
    """Parts after a change. Raises RobophmError for a part that is not there and is to be left out."""
    found = [one for one in parts if change.part in (one.path, one.name, one.module)]
    if change.words.lower() in NONE:
        if not found:
            names = [name for one in parts for name in (one.path, one.name)]
            raise RobophmError(f"no part '{change.part:.60}' to leave out{nearest(change.part, names)}")
        return [one for one in parts if one not in found]
    entry = entry_called(change.words)
    if not found:
        module, _, name = change.part.rpartition("/")
        return [*parts, DraftPart(module or "further parts", name, entry.name, "said to be there")]
    return [replace(one, entry=entry.name, assumed="", seen=f"{one.seen}, said to be {change.words}")
            if one in found else one for one in parts]  # fmt: skip


def _supplied(known: Known, answers: Answers) -> Iterator[DraftPart]:
    """What feeds it."""
    words = (answers.battery or "").strip()
    if not words or words.lower() in NONE:
        return
    if words.lower() == "mains":
        yield DraftPart("power", "power supply", "power_supply", "it is fed from the mains")
        return
    heard = [topic.name for topic in known.seen.of_type("sensor_msgs/BatteryState", "px4_msgs/BatteryStatus")]
    entry = battery_called(words)
    if entry.name == "battery_lipo" and not known.flies:
        entry = part("battery_lipo_robot")  # a charge lasts hours, not minutes
    yield DraftPart("power", "battery", entry.name, f"battery {words}" + (f", heard on {heard[0]}" if heard else ""))
    if entry.name in _PACKS:
        yield DraftPart("power", "battery management", "bms", f"battery {words}", "its cells are watched by a board")
    if not known.flies:
        yield DraftPart("power", "converter", "dc_dc_converter", f"battery {words}", "it feeds the computer")


def _computing(known: Known, answers: Answers, parts: Sequence[DraftPart]) -> Iterator[DraftPart]:
    """What thinks in it: its computer, and what stands between that and the motors."""
    words = (answers.computer or "").strip()
    if known.flies:
        yield DraftPart("computing", "flight controller", "flight_controller", "it flies", "a drone has an autopilot")
        yield DraftPart("computing", "remote control receiver", "rc_receiver", "it flies", "a drone has a receiver")
    if words and words.lower() not in NONE:
        entry = entry_called(words, ("computers",), "computer")
        yield DraftPart("computing", "computer", entry.name, f"computer {words}")
        if entry.name == "single_board_computer":
            yield DraftPart("computing", "memory card", "sd_card", f"computer {words}", "it boots from a card")
    entries = {one.entry for one in parts}
    if any(part(name).kind == "servos" for name in entries):
        yield DraftPart("computing", "servo bus", "bus_interface", "its servos", "servos on a bus have an adapter")
    if entries & {"gearmotor_hobby", "smart_servo"} and "wheel" in known.uses:
        board = "microcontroller_board"
        yield DraftPart("computing", "control board", board, "its wheels", "a small robot has a board for its motors")


def _told_apart(parts: Sequence[DraftPart]) -> list[DraftPart]:
    taken: set[str] = set()
    found = []
    for one in parts:
        name, more = one.name, 2
        while f"{one.module}/{name}" in taken:
            name, more = f"{one.name} {more}", more + 1
        taken.add(f"{one.module}/{name}")
        found.append(replace(one, name=name))
    return sorted(found, key=lambda one: list(dict.fromkeys(two.module for two in parts)).index(one.module))
