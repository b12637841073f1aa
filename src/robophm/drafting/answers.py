"""Questions, at most seven, on what neither a description nor a recording tells, each with the assumption that is made
where nobody answers it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, replace

from robophm.core.argument_checks import shown
from robophm.core.errors import RobophmError, nearest
from robophm.core.units import quantity
from robophm.design.importers.urdf import Description
from robophm.design.importers.urdf.drives import DRIVES, LIGHT, moved, words_of
from robophm.drafting.parts_by_topic import BATTERY
from robophm.drafting.seen import Seen
from robophm.hazard.environments import environment
from robophm.parts import Entry, library, search

NONE = ("none", "no", "-")

PLACES = (
    "if it moves: indoor robot, outdoor robot, flying, ship, underwater, space; if it stands still: indoor, factory"
)
"""Words of ``hazard.environments`` by example: that it moves is what tells them apart most."""

LEGS = frozenset({"leg", "thigh", "calf", "shank", "knee", "hip", "foot", "ankle"})
"""Words of links by which a robot walks."""

ODOMETRY = "nav_msgs/Odometry"

LONGEST = 1000
"""Letters of an answer."""


@dataclass(frozen=True)
class Answers:
    """Answers to the questions about a robot; for one that is None an assumption is made."""

    hours: str | None = None
    """Hours that the robot works in a day: "8", "8 h"."""
    where: str | None = None
    """A word or symbol of ``hazard.environments``: "indoor robot", "factory", "flying", "GM"."""
    battery: str | None = None
    """The battery in words by which the library of parts is searched, "mains" or "none"."""
    computer: str | None = None
    sensors: str | None = None
    """Sensors that no description or topic tells of, with commas between them."""
    drive: str | None = None
    """The drive of its wheels or joints in words: dynamixel, harmonic drive, planetary gearbox …"""
    needs: str | None = None
    """Parts or modules without which it cannot do its task, apart by commas; "all"."""

    def __post_init__(self) -> None:
        for one in fields(self):
            said = getattr(self, one.name)
            if said is not None and (not isinstance(said, str) or len(said) > LONGEST):
                raise RobophmError(
                    f"answer {one.name} {shown(said)}: expected text of at most {LONGEST} letters, or None"
                )

    def with_(self, **said: str | None) -> Answers:
        """The same with these answers where they are none."""
        known = {field.name for field in fields(self)}
        if unknown := [key for key in said if key not in known]:
            raise RobophmError(f"no question '{unknown[0]}'{nearest(unknown[0], known)}")
        return replace(self, **{key: text for key, text in said.items() if text is not None})


@dataclass(frozen=True)
class Question:
    """A question, and what is taken where nobody answers it."""

    key: str
    """The name of the field of ``Answers`` that it asks for, and of the option of ``robophm new``."""
    text: str
    default: str
    because: str
    """Why that is assumed."""


@dataclass(frozen=True)
class Known:
    """The evidence of a robot: its description, if there is one, and what its recordings show."""

    description: Description | None
    seen: Seen
    files: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Names of the files that it is of, by what they are: urdf, recordings."""

    @property
    def uses(self) -> frozenset[str]:
        """The uses of its joints, by their names and types: wheel, arm, rotor …"""
        return frozenset(one.use for one in moved(self.description)) if self.description else frozenset()

    @property
    def flies(self) -> bool:
        """Whether it has rotors, or an autopilot is heard."""
        return "rotor" in self.uses or any(topic.type.startswith("px4_msgs/") for topic in self.seen.topics)

    @property
    def travels(self) -> bool:
        """Whether it moves over ground: it has wheels or legs, or tells how far it came, and no rotors."""
        legs = self.description is not None and any(LEGS & {*words_of(one.name)} for one in self.description.links)
        return not self.flies and ("wheel" in self.uses or legs or bool(self.seen.of_type(ODOMETRY)))

    @property
    def stands(self) -> bool:
        """Whether it has joints of an arm and does not move from its place."""
        return "arm" in self.uses and not self.travels and not self.flies

    @property
    def light(self) -> bool:
        """Whether its description makes it light."""
        return self.description is not None and 0 < self.description.mass <= LIGHT

    @property
    def has_battery(self) -> bool:
        """Whether a battery is heard."""
        return bool(self.seen.of_type(*BATTERY))

    @property
    def summary(self) -> Iterator[str]:
        """Sentences that say what there is of the robot, one for each kind of evidence."""
        if self.description:
            found = self.description
            moving = sum(joint.moves for joint in found.joints)
            yield f"{found.name}: {len(found.links)} links, {moving} joints that move, {found.mass:.3g} kg"
        if self.seen.recorded:
            bags, topics = len(self.seen.recorded), len(self.seen.topics)
            yield f"{bags} recording{'s' * (bags != 1)}, {topics} topics"
        elif self.seen.topics:
            yield f"{len(self.seen.topics)} topics heard of the robot that runs"


def questions(known: Known) -> Iterator[Question]:
    """The questions, with what is assumed in view of the evidence."""
    yield Question("hours", "How many hours a day does it work?", "8", "a working day")
    yield Question("where", f"Where does it work ({PLACES})?", *_where(known))
    yield Question("battery", "Which battery does it have (li-ion, lipo, lead acid … or mains)?", *_battery(known))
    yield Question(
        "computer", "Which computer does it have (raspberry pi, jetson, mini pc … or none)?", *_computer(known)
    )
    yield Question("sensors", "Which sensors were not seen (in words, with commas, or none)?", "none",
                   "those of the description and of the topics are taken for all")  # fmt: skip
    if known.uses & {"wheel", "arm"}:
        yield Question("drive", "What moves its wheels or joints (dynamixel, harmonic drive, planetary gearbox …)?", "",
                       "by names of meshes, mass and limits")  # fmt: skip
    yield Question("needs", "What must work for a task (parts or modules with commas, or all)?", "all",
                   "that fails on the safe side")  # fmt: skip


def _where(known: Known) -> tuple[str, str]:
    if known.flies:
        return "flying", "it has rotors"
    if known.stands:
        return ("indoor", "a light arm") if known.light else ("factory", "an arm that is not light")
    return "mobile robot", "it moves over ground" if known.travels else "most robots move over ground"


def _battery(known: Known) -> tuple[str, str]:
    if known.flies:
        return "lipo", "most drones have one"
    if known.stands and not known.has_battery:
        return "mains", "an arm, and no battery is heard"
    return "li-ion", "a battery is heard" if known.has_battery else "most robots that drive have one"


def _computer(known: Known) -> tuple[str, str]:
    if known.flies:
        return "none", "the autopilot is one, and is in the draft"
    if known.stands and not known.light:
        return "industrial pc", "an arm that is not light"
    return "raspberry pi", "most small robots have one like it"


def settled(answers: Answers, known: Known) -> tuple[Answers, list[tuple[Question, str]]]:
    """The answers with what is assumed in place of those that are missing, and which questions those are."""
    assumed = [(one, one.default) for one in questions(known) if getattr(answers, one.key) is None]
    return answers.with_(**{one.key: said for one, said in assumed}), assumed


# -- what answers mean


def share_of_day(hours: str) -> float:
    """The share of a day that an answer in hours a day is, above 0 and at most 1. Raises RobophmError for another."""
    text = hours.strip()
    value = quantity(text if any(letter.isalpha() for letter in text) else f"{text} h", "h")
    if not 0 < value <= 24:
        raise RobophmError(f"hours {hours!r:.40}: expected more than 0 and at most 24 a day")
    return value / 24


def entry_called(words: str, kinds: tuple[str, ...] = (), what: str = "part") -> Entry:
    """The entry that fits words best, of these kinds if any. Raises RobophmError where none does."""
    words = words.strip()
    found = [library()[words]] if words in library() else search(words)
    fitting = [entry for entry in found if not kinds or entry.kind in kinds]
    if not fitting:
        hint = f"; it finds {found[0].name}, which is none" if found else "; robophm parts lists all"
        raise RobophmError(f"{what} {words!r:.40}: the library has none of that name{hint}")
    return fitting[0]


def drive_called(words: str | None) -> Entry | None:
    """The entry of the library for an answer on drives; None where it is "none" or missing.

    Raises RobophmError where no drive fits the words.
    """
    return entry_called(words, DRIVES, "drive") if words and words.lower() not in NONE else None


def listed(text: str | None) -> list[str]:
    """The words of an answer that has commas between them, without "none" and "all"."""
    said = [word.strip() for word in (text or "").split(",")]
    return [word for word in said if word and word.lower() not in (*NONE, "all")]


Ask = Callable[[Question], str]
"""Puts a question to somebody, and returns what was said, "" for what is assumed."""


def asked(answers: Answers, known: Known, ask: Ask) -> Answers:
    """The answers, with those that are missing asked for."""
    for one in questions(known):
        if getattr(answers, one.key) is None and (said := ask(one)):
            answers = answers.with_(**{one.key: said})
    return answers


def check(key: str, said: str) -> None:
    """Refuse an answer that this question cannot have. Raises RobophmError."""
    if key == "hours":
        share_of_day(said)
    elif key == "where":
        environment(said)
    elif key == "drive":
        drive_called(said)
    elif key == "battery" and said.lower() not in ("mains", *NONE):
        battery_called(said)
    elif key == "computer" and said.lower() not in NONE:
        entry_called(said, ("computers",), "computer")
    elif key == "sensors":
        for word in listed(said):
            entry_called(word, what="sensor")


def faults(answers: Answers) -> dict[str, str]:
    """The reasons why questions cannot have their answers, by the keys of these."""
    found = {}
    for one in fields(answers):
        said = getattr(answers, one.name)
        try:
            if said:
                check(one.name, said)
        except RobophmError as error:
            found[one.name] = str(error)
    return found


def battery_called(words: str) -> Entry:
    """The entry of a battery: lipo and lead acid are batteries of that kind. Raises RobophmError."""
    said = words.strip().lower()
    found = [*search(words), *search(f"{words} battery")]
    fitting = [one for one in found if one.kind == "batteries" and any(said in word.lower() for word in one.words)]
    return fitting[0] if fitting else entry_called(words, ("batteries",), "battery")
