"""Wear that sensors see of a robot's failure modes, and how it stands in an outlook in the place of their hazard.

The rule, by what is known of a mode's wear:

- *foretold*: a trend shows that models follow: the forecast is in the place of the mode's hazard (``wear_to_come.py``);
- *not followed*: no model foretold the last readings: the forecast, if there is one, and all of the mode's own hazard
  beside it;
- *reached*: the part has failed, unless it is said to work: then the mode's own hazard alone holds;
- *no trend* that leads to the threshold, *too few readings*, or a part whose life depends on others': the mode's own
  hazard alone.
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


@dataclass(frozen=True)
class WearAlarm:
    """A change of a signal against its first readings; times [ns since the epoch]."""

    begin: int
    """Time of the first reading that belongs to it."""
    raised: int
    """Time when it was seen."""
    end: int | None
    """Time when it was over; None: it goes on."""
    level: float
    """Mean of the readings in it."""
    usual: float
    """Mean of the first readings, against which it is one."""

    @property
    def words(self) -> str:
        """Return when it was, and what changed."""
        level = f"{self.level:.4g} in place of {self.usual:.4g}"
        if self.end is None:
            return f"changed since {moment(self.begin)}: {level}"
        return f"had changed from {moment(self.begin)} to {moment(self.end)}: {level}"


def moment(time: int) -> str:
    """Return a time [ns since the epoch] in words."""
    return f"{datetime(1970, 1, 1, tzinfo=UTC) + timedelta(seconds=time // SECOND):%Y-%m-%d %H:%M:%S} UTC"


@dataclass(frozen=True)
class SeenWear:
    """The wear of one failure mode as it is known; times of the clock of its readings, from the last of them on."""

    mode: str
    """Path of the failure mode."""
    part: str
    """Path of its component."""
    signal: str
    """The signal that was read, in words."""
    state: WearState
    unit: str
    """The unit of its clock."""
    readings: int
    threshold: float
    last: float | None = None
    """The last reading."""
    when: int | None = None
    """Time of the last reading [ns since the epoch]."""
    early: float = math.inf
    """Time until which the threshold is reached with a probability of 5 %; infinite where nothing is foretold."""
    median: float = math.inf
    late: float = math.inf
    """Time until which it is reached with 95 %; infinite where it may never be."""
    never: float = 1.0
    """Probability that the threshold is never reached."""
    why: str = ""
    """The reason why nothing is foretold; empty where something is."""
    alarms: tuple[WearAlarm, ...] | None = None
    """Changes of the signal, the first one first; None where none are looked for."""
    unlooked: str = ""
    """The reason why none are looked for; empty where they are."""
    dated: bool = False
    """Whether its clock is the calendar, as that of dates without recordings."""
    life: ForetoldLife | None = field(default=None, repr=False)
    """Life from the last reading to the threshold, where it is ever reached; None where nothing is foretold."""
    aged: float | None = None
    """Age, as the mode's life counts it, at the last reading, without the initial exposure; None: as it is now."""
    stress: float = 1.0
    """Units that this age advances in a unit of the readings' clock: the mean stress factor over the readings."""
    share: float = 1.0
    """Share of the mode's own hazard that the wear stands for."""

    @property
    def critical(self) -> bool:
        """Whether its threshold is reached, or no model follows it."""
        return self.state in ("reached", "not followed")

    @property
    def counts(self) -> bool:
        """Whether it is in the figures, and not its mode's hazard alone."""
        return self.life is not None or self.state == "reached"

    @property
    def says(self) -> str:
        """Say what is known of it, and what stands for the mode in the figures."""
        goal, unit = f"{self.threshold:.4g}", self.unit + ("s" if self.unit in ("cycle", "start") else "")
        when = f"reaches {goal} in {self.median:.3g} {unit}"
        if math.isinf(self.late):
            when += f", 5 % by {self.early:.3g}" if math.isfinite(self.early) else ""
            when += f"; with {100 * self.never:.2g} % it never does, and goes by its hazard"
        else:
            when += f", 90 % between {self.early:.3g} and {self.late:.3g}"
        return {
            "foretold": when,
            "no trend": f"no trend shows that leads to {goal}: it goes by its hazard",
            "not followed": f"no model follows it, so that its hazard counts beside it; that it {when} is not to be "
                            "believed" if self.life else "no model follows it, and it goes by its hazard",
            "reached": f"has reached {goal}: it counts as failed",
            "too few readings": f"goes by its hazard: {self.why}",
        }[self.state]  # fmt: skip

    @property
    def alarming(self) -> WearAlarm | None:
        """Return the change that goes on; None where there is none."""
        return self.alarms[-1] if self.alarms and self.alarms[-1].end is None else None

    def to_json(self) -> dict[str, Any]:
        """Return plain values; null is what cannot be said."""
        hidden = {"life", "aged", "stress", "share", "dated"}
        said = {name: value for name, value in asdict(replace(self, life=None)).items() if name not in hidden}
        times = {name: said[name] if math.isfinite(said[name]) else None for name in ("early", "median", "late")}
        return said | times | {"alarms": None if self.alarms is None else [asdict(one) for one in self.alarms]}


def with_wear(outlook: Outlook, seen: Iterable[SeenWear]) -> Outlook:
    """Return the outlook of a robot some of whose failure modes are seen to wear, by the rule above."""
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
            worn[i] = WearToCome(one.life, one.never, since, rate, one.share, doubted=one.state == "not followed")
            unseen[i] = worn[i].unseen_hazard
    known = Knowledge(frozenset(failed), knowledge.working)
    return replace(outlook, worn=worn, unseen_hazard=unseen, knowledge=known)


def apart(plant: Plant) -> frozenset[int]:
    """Return the failure modes of parts that depend on each other, whose wear is not told apart."""
    return frozenset(int(i) for held in plant.groups for i in held.modes)


def believed(outlook: Outlook) -> frozenset[str]:
    """Return the failure modes, by path, whose wear says when they come."""
    modes = outlook.plant.robot.modes
    return frozenset(modes[i].path for i, one in outlook.worn.items() if not one.doubted)


def wear_flags(seen: Sequence[SeenWear], modes: Iterable[str]) -> tuple[str, ...]:
    """Return the flags that wear puts on figures of something with these failure modes, by path."""
    inside = {*modes}
    return tuple(flag_of(one) for one in seen if one.mode in inside and one.critical)


def flag_of(one: SeenWear) -> str:
    """Return the flag that a wear puts on figures, in words."""
    return f"{WEAR}{one.mode} {'has reached its threshold' if one.state == 'reached' else 'is followed by no model'}"
