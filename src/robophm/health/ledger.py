"""The ledger: a robot's past as sums by failure mode, the open window, and its load history in a few steps."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from robophm.core.errors import StoreError
from robophm.core.signal import HOUR, SECOND, Sample
from robophm.design.identities import identities
from robophm.design.robot import Robot
from robophm.health.ledger_formats import VERSION, up_to_date
from robophm.health.ledger_parts import TOTALS, DesignChange, brought_to, known_parts
from robophm.health.wear_readings import WearCourse
from robophm.health.window import Array, Window

RECENT = 600 * SECOND
"""Nanoseconds over which the recent mean is taken: the last ten minutes."""

MOST_HISTORY = 128
"""Steps in which a ledger keeps the past, to draw the future from."""

_RECENT_STEP = 30 * SECOND  # the recent past is kept in steps of at least this, so that it stays small


class Total:
    """Sums that lose nothing: each is a double and the rounding left over from all additions (Neumaier 1974)."""

    def __init__(self, high: Array, low: Array) -> None:
        self.high = high
        self.low = low

    @classmethod
    def zeros(cls, n: int) -> Total:
        """Make ``n`` sums that are zero."""
        return cls(np.zeros(n), np.zeros(n))

    def add(self, more: Array) -> None:
        """Add to every sum; shape (n,)."""
        total = self.high + more
        shifted = total - self.high
        self.low = self.low + ((self.high - (total - shifted)) + (more - shifted))
        self.high = total

    @classmethod
    def add_each(cls, totals: Sequence[Total], rows: Sequence[Array]) -> None:
        """Add to each of some totals rows of its own, one after the other; shapes (rows, n)."""
        cuts = np.cumsum([len(total.high) for total in totals])[:-1]
        joined = cls(*(np.concatenate([getattr(total, name) for total in totals]) for name in ("high", "low")))
        for row in np.concatenate(rows, axis=1):
            joined.add(row)
        for total, high, low in zip(totals, np.split(joined.high, cuts), np.split(joined.low, cuts), strict=True):
            total.high, total.low = high, low

    @property
    def value(self) -> Array:
        """The sums, shape (n,)."""
        return self.high + self.low

    def copy(self) -> Total:
        """Return an independent copy of the sums."""
        return Total(self.high.copy(), self.low.copy())


class Step(NamedTuple):
    """The exposure of one stretch of the past, for parts that were needed in it: clocks count in full, idle or not."""

    end: int
    calendar: float
    """Calendar time of the step [h]."""
    operating: float
    """Operating time of the step [h]."""
    age: Array
    """Age that each mode gained [unit of its clock]; shape (modes,)."""
    effective: Array
    """Stress factor times age of each mode; shape (modes,)."""
    inputs: dict[str, tuple[float, float]]
    """Integrals of channels over operating time, and the time [ns] in which each had a valid value."""

    def then(self, later: Step) -> Step:
        """Return this step and a later one joined to one."""
        inputs = self.inputs.copy()
        for key, (value, time) in later.inputs.items():
            before = inputs.get(key, (0.0, 0.0))
            inputs[key] = before[0] + value, before[1] + time
        return Step(
            later.end,
            self.calendar + later.calendar,
            self.operating + later.operating,
            self.age + later.age,
            self.effective + later.effective,
            inputs,
        )


class Seen(NamedTuple):
    """The sums of a failure mode at the time when its part was last known to work."""

    time: int
    age: float
    effective: float
    hazard: float


class Service(NamedTuple):
    """A part replaced, repaired or failed, or a failure that was none: what its mode has behind it before and after."""

    time: int
    mode: str
    kind: Literal["replaced", "repaired", "failed", "struck out"]
    """``failed``: it has failed, and nothing was done about it yet; ``struck out``: that was said, and was not so."""
    failed: bool
    """Whether this mode had failed; else its part was served in time."""
    before: tuple[float, float, float]
    """Age, effective age, cumulative hazard of its stress; without the initial exposure, while that still counts."""
    after: tuple[float, float, float]
    by: str = ""
    """The person who said so; empty where that is not known."""
    note: str = ""
    """Words that were said about it."""


class SuspectTime(NamedTuple):
    """A stretch in which the machine's clock was not plausible, and time went on without it."""

    begin: int
    end: int
    ahead: float
    """Seconds by which the clock was ahead of the time that counts, when it was last heard; below zero, behind."""
    outcome: str = ""
    """The way it ended: passed, believed, taken in or struck out; empty while it lasts."""


@dataclass
class Ledger:
    """A robot's past. Sums are by failure mode in design order, since new and without the initial exposure."""

    modes: tuple[str, ...]
    """Keys of the failure modes."""
    age: Total
    effective: Total
    hazard: Total
    """∫ψ·h₀(a)da, for the modes whose stress scales the hazard; zero for the others."""
    clocks: Total
    """Sums since the start: operating hours, calendar hours, and the robot's own measured clocks in design order."""
    odometers: tuple[str, ...] = ()
    """Names of the robot's own measured clocks."""
    started: int | None = None
    integrated_to: int | None = None
    newest: int | None = None
    heard: int | None = None
    """Time of the last sample of the robot itself."""
    off: int | None = None
    """Time until which it was off last."""
    ended: int | None = None
    """End of the last recording, when nothing was heard since; None where samples came live, or since another sample.

    It says nothing of the past, and is kept beside the ledger.
    """
    ends: list[int] = field(default_factory=list)
    """Ends of recordings, none of which goes on within ``max_gap``, that no integrated sample is later than."""
    last: dict[str, tuple[int, tuple[float, ...]]] = field(default_factory=dict)
    """The last valid value of every channel, position and clock signal, by its key."""
    pending: Window = field(default_factory=Window)
    """The open window: samples that have been received but not yet integrated."""
    aside: list[Sample] = field(default_factory=list)
    """Samples so far ahead of all others that the clock may have jumped; not yet confirmed, in order of arrival."""
    counts: Counter[str] = field(default_factory=Counter)
    """Numbers of samples that were not taken, by reason and signal."""
    stale: Counter[str] = field(default_factory=Counter)
    """Nanoseconds of operation without a valid value, by channel key."""
    extrapolated: Counter[str] = field(default_factory=Counter)
    """Nanoseconds of operation outside a model's printed range, by mode."""
    recent: list[Step] = field(default_factory=list)
    """Steps of the last ten minutes."""
    history: list[Step] = field(default_factory=list)
    """The whole past, in at most MOST_HISTORY steps."""
    history_step: int = HOUR
    """Nanoseconds of a step of the history; it doubles as the past grows."""
    replaced: dict[str, int] = field(default_factory=dict)
    """Time at which a mode's sums last began anew, in a new or repaired part: its initial exposure then counts no
    more."""
    seen: dict[str, Seen] = field(default_factory=dict)
    """Sums of each mode when its part was last known to work."""
    services: list[Service] = field(default_factory=list)
    """Every failure, replacement and repair, in order of time: what was there before stays known."""
    wear: dict[str, WearCourse] = field(default_factory=dict)
    """Readings of wear of each mode, by its key, since its part was put in or repaired."""
    begun: dict[str, int] = field(default_factory=dict)
    """Time since which a mode, by its key, is counted, of those that came into the design later."""
    archived: dict[str, Any] = field(default_factory=dict)
    """The past of modes, by their keys and as JSON has it, that are in the design no more."""
    parts: dict[str, Any] = field(default_factory=dict)
    """Path and traits of each part as last seen in a design, by its identity and as JSON has it."""
    changes: list[DesignChange] = field(default_factory=list)
    """The changes of the design that it went through, the latest last."""
    suspect_time: list[SuspectTime] = field(default_factory=list)
    """Stretches in which the machine's clock was not plausible, the latest last."""

    @classmethod
    def new(cls, robot: Robot) -> Ledger:
        """The ledger of a robot that has not lived yet."""
        n = len(robot.modes)
        return cls(
            tuple(mode.key for mode in robot.modes),
            Total.zeros(n),
            Total.zeros(n),
            Total.zeros(n),
            Total.zeros(2 + len(robot.clocks)),
            tuple(robot.clocks),
            parts=known_parts(identities(robot)),
        )

    @property
    def known_to(self) -> int | None:
        """Time of the newest sample, or since it that of the end of its recording, until which it was on or off."""
        return self.newest if self.ended is None else self.ended

    def copy(self) -> Ledger:
        """An independent copy, to look ahead without consequence."""
        totals = {name: getattr(self, name).copy() for name in ("age", "effective", "hazard", "clocks")}
        kept = (
            "ends",
            "last",
            "pending",
            "aside",
            "counts",
            "stale",
            "extrapolated",
            "recent",
            "history",
            "replaced",
            "seen",
            "services",
            "begun",
            "archived",
            "changes",
            "suspect_time",
        )
        wear = {key: course.copy() for key, course in self.wear.items()}
        return replace(self, **totals, **{name: getattr(self, name).copy() for name in kept}, wear=wear)

    @property
    def failed(self) -> frozenset[str]:
        """Return the modes, by key, by which parts failed that were neither replaced nor repaired since."""
        last = {one.mode: one.kind for one in self.services}
        return frozenset(mode for mode, kind in last.items() if kind == "failed")

    def fail(self, mode: str) -> None:
        """Record that the part of this mode, by key, has failed by it; its sums stay as they are."""
        sums = self._sums(mode)
        self.services.append(Service(self.integrated_to or 0, mode, "failed", True, sums, sums))

    def replace(self, modes: Iterable[str], failed: Collection[str] = ()) -> None:
        """Begin the sums of these modes, by key, anew, as of new parts; the modes in ``failed`` had failed."""
        for key in modes:
            self._begin_anew(key, "replaced", key in failed, (0.0, 0.0, 0.0))
            self.seen.pop(key, None)

    def repair(self, mode: str, after: tuple[float, float, float], *, failed: bool = False) -> None:
        """Record a repair: the part of this mode, by key, works again with these sums, initial exposure included."""
        self._begin_anew(mode, "repaired", failed, after)
        self.inspect((mode,))

    def strike_out(self, mode: str, by: str, note: str) -> None:
        """Record that the last failure of a mode, by key, was none; what a repair since then left out counts again."""
        own = [i for i, one in enumerate(self.services) if one.mode == mode]
        last = max(i for i in own if self.services[i].kind == "failed")
        if since := [i for i in own if i > last]:
            repaired = self.services.pop(since[0])
            i = self.modes.index(mode)
            more = [before - after for before, after in zip(repaired.before, repaired.after, strict=True)]
            for total, left_out in zip((self.age, self.effective, self.hazard), more, strict=True):
                total.high[i], total.low[i] = total.high[i] + (total.low[i] + left_out), 0.0
            served = [
                self.services[i].time for i in own if i < last and self.services[i].kind in ("replaced", "repaired")
            ]
            self.replaced.pop(mode, None)
            self.replaced |= {mode: served[-1]} if served else {}
            if (then := self.seen.get(mode)) is not None:
                self.seen[mode] = Seen(
                    then.time, *(one + left_out for one, left_out in zip(then[1:], more, strict=True))
                )
        was = self.services[last]
        told = f"{note}; " * bool(note) + f"told by {was.by or 'nobody named'}" + f": {was.note}" * bool(was.note)
        self.services[last] = was._replace(kind="struck out", failed=False, by=by, note=told)

    def _begin_anew(
        self, key: str, kind: Literal["replaced", "repaired"], failed: bool, after: tuple[float, float, float]
    ) -> None:
        i, now = self.modes.index(key), self.integrated_to or 0
        failed = failed or key in self.failed
        self.services.append(Service(now, key, kind, failed, self._sums(key), after))
        for total, value in zip((self.age, self.effective, self.hazard), after, strict=True):
            total.high[i], total.low[i] = value, 0.0
        self.replaced[key] = now
        self.wear.pop(key, None)

    def _sums(self, key: str) -> tuple[float, float, float]:
        """Age, effective age and cumulative hazard of a mode."""
        i = self.modes.index(key)
        age, effective, hazard = (float(one.high[i] + one.low[i]) for one in (self.age, self.effective, self.hazard))
        return age, effective, hazard

    def remember(self, new: Step) -> None:
        """Append a stretch of the past to the recent steps and the history, newest last."""
        self.recent = _appended(self.recent, new, _RECENT_STEP)
        self.recent = [step for step in self.recent if step.end > new.end - RECENT]
        self.history = _appended(self.history, new, self.history_step)
        if len(self.history) > MOST_HISTORY:
            self.history_step *= 2
            steps, self.history = self.history, []
            for step in steps:
                self.history = _appended(self.history, step, self.history_step)

    def inspect(self, modes: Iterable[str]) -> None:
        """Record that the parts of these modes, by key, are known to work now."""
        sums = [total.value for total in (self.age, self.effective, self.hazard)]
        for key in modes:
            i = self.modes.index(key)
            self.seen[key] = Seen(self.integrated_to or 0, *(float(total[i]) for total in sums))

    def to_json(self) -> dict[str, Any]:
        """Return the ledger as plain values for JSON; floats come back bit for bit."""
        totals = {name: getattr(self, name) for name in ("age", "effective", "hazard", "clocks")}
        return {
            "version": VERSION,
            "modes": list(self.modes),
            "odometers": list(self.odometers),
            "totals": {name: [total.high.tolist(), total.low.tolist()] for name, total in totals.items()},
            **{name: getattr(self, name) for name in _TIMES},
            "ends": list(self.ends),
            "last": {key: [time, list(values)] for key, (time, values) in self.last.items()},
            "pending": [list(sample) for sample in self.pending.samples()],
            "aside": [list(sample) for sample in self.aside],
            **{name: dict(getattr(self, name)) for name in ("counts", "stale", "extrapolated")},
            **{name: _steps_to_json(getattr(self, name)) for name in ("recent", "history")},
            "history_step": self.history_step,
            "replaced": self.replaced,
            "seen": {key: list(seen) for key, seen in self.seen.items()},
            "services": [list(service[:6]) for service in self.services],
            **({"said": said} if any(map(any, said := [one[6:] for one in self.services])) else {}),
            **({"wear": {key: one.to_json() for key, one in self.wear.items()}} if self.wear else {}),
            **{name: found for name in ("begun", "archived", "parts") if (found := getattr(self, name))},
            **({"changes": [list(change) for change in self.changes]} if self.changes else {}),
            **({"suspect_time": [list(one) for one in self.suspect_time]} if self.suspect_time else {}),
        }

    @classmethod
    def of(cls, robot: Robot, data: Mapping[str, Any]) -> Ledger:
        """Read back the ledger of a robot, to which parts may have come since, or of which some may be gone.

        Raises StoreError as ``from_json`` and ``brought_to``.
        """
        data = brought_to(up_to_date(data), identities(robot))
        return cls.from_json(data, tuple(mode.key for mode in robot.modes), tuple(robot.clocks))

    @classmethod
    def from_json(cls, data: Mapping[str, Any], modes: tuple[str, ...], odometers: tuple[str, ...]) -> Ledger:
        """Read back a ledger; an odometer that it does not have begins at zero.

        Raises StoreError where it was kept for other failure modes or another version.
        """
        data = up_to_date(data)
        kept, services = tuple(data["modes"]), data.get("services", ())
        if set(kept) != set(modes):
            other = sorted(set(kept) ^ set(modes))
            raise StoreError(f"ledger was kept for other parts: '{other[0]}' is in it or in the design alone")
        order = [kept.index(mode) for mode in modes]
        totals = {
            name: Total(*(np.array(part, dtype=float) for part in parts)) for name, parts in data["totals"].items()
        }
        for name in TOTALS:
            totals[name] = Total(totals[name].high[order], totals[name].low[order])
        clocks, counted = Total.zeros(2 + len(odometers)), totals["clocks"]
        names = ["operating", "calendar", *data["odometers"]]
        for i, name in enumerate(("operating", "calendar", *odometers)):
            if name in names:
                clocks.high[i], clocks.low[i] = counted.high[names.index(name)], counted.low[names.index(name)]
        return cls(
            modes,
            totals["age"],
            totals["effective"],
            totals["hazard"],
            clocks,
            odometers,
            **{name: data.get(name) for name in _TIMES},
            ends=list(data.get("ends", ())),
            last={key: (time, tuple(values)) for key, (time, values) in data["last"].items()},
            pending=Window(Sample(*sample) for sample in data["pending"]),
            aside=[Sample(*sample) for sample in data.get("aside", ())],
            counts=Counter(data["counts"]),
            stale=Counter(data["stale"]),
            extrapolated=Counter(data["extrapolated"]),
            recent=_steps_of_json(data["recent"], order),
            history=_steps_of_json(data["history"], order),
            history_step=data["history_step"],
            replaced=dict(data["replaced"]),
            seen={key: Seen(*values) for key, values in data["seen"].items()},
            services=[
                Service(time, mode, kind, failed, tuple(before), tuple(after), *said)
                for (time, mode, kind, failed, before, after), said in zip(
                    services, data.get("said") or [()] * len(services), strict=True
                )
            ],
            wear={key: WearCourse.from_json(one) for key, one in data.get("wear", {}).items()},
            begun=dict(data.get("begun", {})),
            archived=dict(data.get("archived", {})),
            parts=dict(data.get("parts", {})),
            changes=[DesignChange(*change) for change in data.get("changes", ())],
            suspect_time=[SuspectTime(*one) for one in data.get("suspect_time", ())],
        )


_TIMES = ("started", "integrated_to", "newest", "heard", "off")


def _steps_to_json(steps: Sequence[Step]) -> dict[str, Any]:
    """Modes that share their clock and stresses have the same numbers, which are written once."""
    plain = [[step.end, step.calendar, step.operating, step.inputs] for step in steps]
    if not steps:
        return {"steps": plain, "kinds": [], "of": []}
    columns = np.concatenate([np.stack((step.age, step.effective)) for step in steps])
    kinds: dict[bytes, int] = {}
    of = [kinds.setdefault(column.tobytes(), len(kinds)) for column in columns.T]
    first = [of.index(kind) for kind in range(len(kinds))]
    return {"steps": plain, "kinds": columns[:, first].tolist(), "of": of}


def _steps_of_json(data: Mapping[str, Any], order: Sequence[int]) -> list[Step]:
    if not data["steps"]:
        return []
    columns = np.array(data["kinds"], dtype=float)[:, np.array(data["of"], dtype=int)[order]]
    return [
        Step(end, calendar, operating, age, effective, {key: (a, b) for key, (a, b) in inputs.items()})
        for (end, calendar, operating, inputs), age, effective in zip(
            data["steps"], columns[::2], columns[1::2], strict=True
        )
    ]


def _appended(steps: list[Step], new: Step, length: int) -> list[Step]:
    """The steps and a new one, in the last step where that has not ended."""
    if steps and (steps[-1].end - 1) // length == (new.end - 1) // length:
        return [*steps[:-1], steps[-1].then(new)]
    return [*steps, new]
