"""What is seen of the wear of a robot's failure modes, and how it stands in an outlook in the place of their hazard.

The rule, by what is known of a mode's wear:

- *foretold*: models follow it, and it comes to its threshold more likely than not: what is foretold is in the place of
  the mode's hazard (``wear_to_come.py``);
- *no trend*: most of what is drawn never comes to the threshold: the same; in that share the mode's own hazard holds;
- *not followed*: no model foretold the last readings: what is foretold, and all of the mode's own hazard beside it;
- *reached*: the part has failed, unless it is said to work: then the mode's own hazard alone holds;
- *too few readings*, or a part whose life depends on others': the mode's own hazard alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime, timedelta
from typing import Any, Literal

from robophm.core.signal import SECOND
from robophm.design.task import Knowledge
from robophm.health.foretold_life import ForetoldLife
from robophm.health.plant import Plant
from robophm.health.prognosis import Outlook
from robophm.health.wear_to_come import WearToCome

WearState = Literal["foretold", "no trend", "not followed", "reached", "too few readings"]

WEAR = "wear: "
"""How the flag of wear begins that is at its threshold or followed by no model."""

MOSTLY = 0.5
"""Share of what is drawn that never comes to the threshold, up to which its wear says when a mode comes."""

BELIEVED: frozenset[WearState] = frozenset({"foretold", "no trend"})
"""Where no more of the mode's own hazard is counted than the wear leaves open."""


@dataclass(frozen=True)
class WearAlarm:
    """A change of a signal against its first readings; times [ns since the epoch]."""

    begin: int
    """Of the first reading that belongs to it."""
    raised: int
    """When it was seen."""
    end: int | None
    """When it was over; None: it goes on."""
    level: float
    """Mean of the readings in it."""
    usual: float
    """Mean of the first readings, against which it is one."""

    @property
    def words(self) -> str:
        """When it was, and what changed."""
        level = f"{self.level:.4g} in place of {self.usual:.4g}"
        if self.end is None:
            return f"changed since {moment(self.begin)}: {level}"
        return f"had changed from {moment(self.begin)} to {moment(self.end)}: {level}"


def moment(time: int) -> str:
    """A time [ns since the epoch] in words."""
    return f"{datetime(1970, 1, 1, tzinfo=UTC) + timedelta(seconds=time // SECOND):%Y-%m-%d %H:%M:%S} UTC"


@dataclass(frozen=True)
class SeenWear:
    """What is known of the wear of one failure mode; times of the clock of its readings, from the last of them on."""

    mode: str
    """Path of the failure mode."""
    part: str
    """Path of its component."""
    signal: str
    """What was read, in words."""
    state: WearState
    unit: str
    """Of its clock."""
    readings: int
    threshold: float
    last: float | None = None
    """The last reading."""
    when: int | None = None
    """Of the last reading [ns since the epoch]."""
    early: float = math.inf
    """Time to the threshold that 5 % of what is drawn reach it by; infinite where it may never come."""
    median: float = math.inf
    late: float = math.inf
    """That 95 % do."""
    never: float = 1.0
    """Share of what is drawn that never reaches it."""
    why: str = ""
    """Why nothing is foretold."""
    alarms: tuple[WearAlarm, ...] | None = None
    """Changes of the signal, the first one first; None where none are looked for."""
    unlooked: str = ""
    """Why none are."""
    dated: bool = False
    """Whether its clock is the calendar, as that of dates without recordings."""
    life: ForetoldLife | None = field(default=None, repr=False)
    """From the last reading to the threshold, where it is ever reached."""
    aged: float | None = None
    """What the mode's life counts had come to at the last reading, without the initial exposure; None: as it is now."""
    stress: float = 1.0
    """How far that goes in a unit of the readings' clock: the mean stress factor over the readings."""
    share: float = 1.0
    """Of the mode's own hazard, what the wear stands for."""

    @property
    def critical(self) -> bool:
        """Whether its threshold is reached, or no model follows it."""
        return self.state in ("reached", "not followed")

    @property
    def says(self) -> str:
        """What is known of it, in words, and what stands for the mode in the figures."""
        goal, unit = f"{self.threshold:.4g}", self.unit + ("s" if self.unit in ("cycle", "start") else "")
        when = f"reaches {goal} in {self.median:.3g} {unit}"
        if math.isinf(self.late):
            when += f", 5 % by {self.early:.3g}" if math.isfinite(self.early) else ""
            when += f"; in {100 * self.never:.2g} % of what is drawn it never does, and goes by its hazard"
        else:
            when += f", 90 % between {self.early:.3g} and {self.late:.3g}"
        return {
            "foretold": when,
            "no trend": f"no trend to {goal}: in {100 * self.never:.2g} % of what is drawn it does not come there, and "
                        "goes by its hazard",
            "not followed": f"no model follows it, so that its hazard counts beside it; that it {when} is not to be "
                            "believed",
            "reached": f"has reached {goal}: it counts as failed",
            "too few readings": f"goes by its hazard: {self.why}",
        }[self.state]  # fmt: skip

    @property
    def alarming(self) -> WearAlarm | None:
        """The change that goes on."""
        return self.alarms[-1] if self.alarms and self.alarms[-1].end is None else None

    def to_json(self) -> dict[str, Any]:
        """As plain values; null is what cannot be said."""
        hidden = {"life", "aged", "stress", "share", "dated"}
        said = {name: value for name, value in asdict(replace(self, life=None)).items() if name not in hidden}
        times = {name: said[name] if math.isfinite(said[name]) else None for name in ("early", "median", "late")}
        return said | times | {"alarms": None if self.alarms is None else [asdict(one) for one in self.alarms]}


def with_wear(outlook: Outlook, seen: Iterable[SeenWear]) -> Outlook:
    """A robot some of whose failure modes are seen to wear, by the rule above."""
    by_path = {one.mode: one for one in seen}
    if not by_path:
        return outlook
    plant, knowledge = outlook.plant, outlook.knowledge
    dependent = apart(plant)
    pace = outlook.course.pace(plant)
    worn, unseen, failed = {}, outlook.unseen_hazard.copy(), set(knowledge.failed)
    for i, mode in enumerate(plant.robot.modes):
        one = by_path.get(mode.path)
        if one is None:
            continue
        if one.state == "reached":
            failed.update(set(plant.components[int(plant.part[i])].units) - knowledge.working)
        elif one.life is not None and i not in dependent:
            rate = float(pace[i]) if one.dated else one.stress
            aged = float(outlook.age[i] - outlook.new_age[i])
            if not rate > 0:
                continue
            since = 0.0 if one.aged is None else max(aged - one.aged, 0.0) / rate
            doubted = one.state not in BELIEVED
            worn[i] = WearToCome(one.life, one.never, since, rate, one.share, doubted)
            unseen[i] = worn[i].unseen
    known = Knowledge(frozenset(failed), knowledge.working)
    return replace(outlook, worn=worn, unseen_hazard=unseen, knowledge=known)


def apart(plant: Plant) -> frozenset[int]:
    """The failure modes of parts that depend on each other, whose wear is not told apart."""
    return frozenset(int(i) for held in plant.groups for i in held.modes)


def believed(outlook: Outlook) -> frozenset[str]:
    """The failure modes, by path, whose wear says when they come."""
    modes = outlook.plant.robot.modes
    return frozenset(modes[i].path for i, one in outlook.worn.items() if not one.doubted and one.never <= MOSTLY)


def wear_flags(seen: Sequence[SeenWear], modes: Iterable[str]) -> tuple[str, ...]:
    """What of wear qualifies the figures of something with these failure modes, by path."""
    inside = {*modes}
    return tuple(flag_of(one) for one in seen if one.mode in inside and one.critical)


def flag_of(one: SeenWear) -> str:
    """In words, what of wear qualifies figures."""
    return f"{WEAR}{one.mode} {'has reached its threshold' if one.state == 'reached' else 'is followed by no model'}"
