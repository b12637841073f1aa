"""The samples of a signal of wear become readings as they come: those that count, stretch of time by stretch.

A sample counts where it is within its range, was taken at the stated load, and above an ambient that is known. Of each
stretch sums of powers are kept about its first sample, added one sample after the other, so that it makes no difference
how samples come or where a run was interrupted. Stretches double when there are too many: memory does not grow.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.core.signal import SECOND
from robophm.design.wear_signal import Gauge, WearSignal
from robophm.health.window import Array, Columns, Times

MOST_READINGS = 1024
"""Stretches that are kept of one signal. Of more, two neighbours each become one, and later ones are twice as long."""

WIDEST = 1e60
"""The largest sample, up or down, that counts: its powers are numbers too."""

FEW = 0.25
"""Share of the usual number of samples below which a stretch makes no reading."""

_POWERS = (1, 2, 3, 4)


class Stretch(NamedTuple):
    """Sums over the samples of one stretch of time."""

    number: int
    """Stretches since the epoch."""
    samples: float
    first: float
    """The first sample; sums of powers are about it."""
    sums: tuple[float, float, float, float]
    lowest: float
    highest: float
    time: float
    """Sum of its samples' times since its begin [ns]."""
    age: float
    """Sum of the ages of the part at its samples [unit of its clock], without the initial exposure."""
    effective: float
    """The same of effective ages."""

    def joined(self, later: Stretch, every: int) -> Stretch:
        """Return both neighbours as one stretch twice as long, which begins with the even one of them."""
        d, n = later.first - self.first, later.samples
        a, b, c, e = later.sums
        about = (
            a + n * d,
            b + 2 * d * a + n * d**2,
            c + 3 * d * b + 3 * d**2 * a + n * d**3,
            e + 4 * d * c + 6 * d**2 * b + 4 * d**3 * a + n * d**4,
        )
        one, two, three, four = (x + y for x, y in zip(self.sums, about, strict=True))
        return Stretch(
            self.number // 2, self.samples + n, self.first, (one, two, three, four),
            min(self.lowest, later.lowest), max(self.highest, later.highest),
            self.doubled(every).time + later.doubled(every).time,
            self.age + later.age, self.effective + later.effective,
        )  # fmt: skip

    def doubled(self, every: int) -> Stretch:
        """Return the same samples as those of a stretch twice as long."""
        late = self.number % 2 * every * self.samples
        return self._replace(number=self.number // 2, time=self.time + late)

    @property
    def mean(self) -> float:
        """Return the mean of its samples."""
        return self.first + self.sums[0] / self.samples

    def about_mean(self) -> tuple[float, float]:
        """Return the mean second and fourth power about the mean."""
        m, second, third, fourth = (one / self.samples for one in self.sums)
        return max(second - m**2, 0.0), max(fourth - 4 * m * third + 6 * m**2 * second - 3 * m**4, 0.0)


def _kurtosis(one: Stretch) -> float:
    second, fourth = one.about_mean()
    return fourth / second**2 if second > 1e-24 * one.first**2 else math.nan


READINGS: Mapping[str, Callable[[Stretch], float]] = {
    "mean": lambda one: one.mean,
    "rms": lambda one: math.sqrt(one.about_mean()[0]),
    "kurtosis": _kurtosis,
    "highest": lambda one: one.highest,
    "lowest": lambda one: one.lowest,
}
"""The statistics of a stretch, by name. An rms is about the mean; a kurtosis is 3 of noise."""


class WearReadings(NamedTuple):
    """Readings of one part in order of time, each later on its clock than the one before; shapes (readings,)."""

    when: Times
    """Mean of the samples' times [ns since the epoch]."""
    ages: Array
    """Ages of the part then [unit of its clock], without the initial exposure."""
    effective: Array
    """Effective ages of the part then."""
    values: Array
    left_out: Mapping[str, int]
    """Samples and stretches that did not count, by why, and how many."""


NO_READINGS = WearReadings(np.empty(0, np.int64), np.empty(0), np.empty(0), np.empty(0), {})


class Ageing(NamedTuple):
    """How a part aged over the periods in which samples came."""

    bounds: Times
    """Ends of the periods [ns]; shape (periods + 1,)."""
    begun: Array
    """Age and effective age when each period began, shape (2, periods)."""
    added: Array
    """Age and effective age that each period added, shape (2, periods)."""

    def at(self, times: Times) -> Array:
        """Age and effective age at some times, evenly between two bounds; shape (2, times)."""
        k = np.clip(np.searchsorted(self.bounds, times, side="left") - 1, 0, len(self.bounds) - 2)
        share = (times - self.bounds[k]) / np.maximum(self.bounds[k + 1] - self.bounds[k], 1)
        result: Array = self.begun[:, k] + np.clip(share, 0.0, 1.0) * self.added[:, k]
        return result


Heard = tuple[int, float]
"""When a signal said what [ns]."""


@dataclass
class WearCourse:
    """The readings of one failure mode's signal, as far as they have come."""

    of: str
    """The design's words on the signal, by ``definition``; where they change, readings begin anew."""
    begun: int = 0
    """Time when the part's readings began [ns], by which two parts are told apart."""
    doubled: int = 0
    stretches: list[Stretch] = field(default_factory=list)
    ambient: Heard | None = None
    load: Heard | None = None
    left_out: Counter[str] = field(default_factory=Counter)

    @classmethod
    def begin(cls, wear: WearSignal) -> WearCourse:
        """Return a course that has no reading yet."""
        return cls(definition(wear))

    def copy(self) -> WearCourse:
        """Return an independent copy."""
        return replace(self, stretches=self.stretches.copy(), left_out=self.left_out.copy())

    def take(self, wear: WearSignal, columns: Columns, ageing: Ageing) -> None:
        """Take samples by signal, ascending in time: all that there are of some periods."""
        times, values = columns.get(wear.gauge.signal, _NOTHING)
        sound = (np.abs(values) <= WIDEST) & (values >= wear.gauge.low) & (values <= wear.gauge.high)
        times, values = self._kept(sound, "samples that are no number within their range", times, values)
        if wear.load:
            said, self.load = _beside(wear.load, self.load, columns, times, within=False)
            times, values, said = self._kept(
                ~np.isnan(said), "samples at a load that is not known", times, values, said
            )
            there = (said >= wear.load.low) & (said <= wear.load.high)
            times, values = times[there], values[there]
        if wear.ambient:
            said, self.ambient = _beside(wear.ambient, self.ambient, columns, times, within=True)
            values = values - said
            times, values = self._kept(~np.isnan(values), "samples without a known ambient", times, values)
        if len(times):
            self._add(times, values, ageing.at(times), wear.every)

    def _kept(self, sound: npt.NDArray[np.bool_], why: str, *columns: Any) -> Any:
        if missing := len(sound) - int(sound.sum()):
            self.left_out[f"{why}, left out"] += missing
            return tuple(one[sound] for one in columns)
        return columns

    def _add(self, times: Times, values: Array, ages: Array, every: int) -> None:
        start = 0
        while start < len(times):
            length = every << self.doubled
            number = int(times[start]) // length
            end = int(np.searchsorted(times, (number + 1) * length, side="left"))
            here = slice(start, end)
            if not self.stretches or self.stretches[-1].number != number:
                if len(self.stretches) == MOST_READINGS:
                    self._double(length)
                    continue
                first = float(values[start])
                self.begun = self.begun or int(times[start])
                self.stretches.append(Stretch(number, 0.0, first, (0.0, 0.0, 0.0, 0.0), first, first, 0.0, 0.0, 0.0))
            one = self.stretches[-1]
            away = values[here] - one.first
            one_, two, three, four = (_summed(total, away**k) for k, total in zip(_POWERS, one.sums, strict=True))
            self.stretches[-1] = Stretch(
                number, one.samples + (end - start), one.first, (one_, two, three, four),
                min(one.lowest, float(values[here].min())), max(one.highest, float(values[here].max())),
                _summed(one.time, (times[here] - number * length).astype(float)),
                _summed(one.age, ages[0, here]), _summed(one.effective, ages[1, here]),
            )  # fmt: skip
            start = end

    def _double(self, every: int) -> None:
        """Two neighbours each become one."""
        self.doubled += 1
        found: list[Stretch] = []
        waiting: Stretch | None = None
        for one in self.stretches:
            if waiting is not None and waiting.number // 2 == one.number // 2:
                found.append(waiting.joined(one, every))
                waiting = None
                continue
            if waiting is not None:
                found.append(waiting.doubled(every))
            waiting = one
        self.stretches = [*found, *([waiting.doubled(every)] if waiting is not None else [])]

    def until(self, before: int, wear_every: int) -> None:
        """Take out what was read from a time [ns] on."""
        length = wear_every << self.doubled
        self.stretches = [one for one in self.stretches if one.number * length < before]
        self.ambient, self.load = (
            None if one is None else (min(one[0], before), one[1]) for one in (self.ambient, self.load)
        )

    def readings(self, wear: WearSignal) -> WearReadings:
        """Return a reading of each stretch that has enough samples, while the part aged."""
        left_out = Counter(self.left_out)
        usual = float(np.median([one.samples for one in self.stretches])) if self.stretches else 0.0
        kept = [one for one in self.stretches if one.samples >= FEW * usual]
        if few := len(self.stretches) - len(kept):
            left_out[f"stretches with less than {FEW:g} of the usual {usual:g} samples, left out"] += few
        values = np.array([READINGS[wear.reading](one) for one in kept])
        sound = np.isfinite(values)
        if not sound.all():
            left_out[f"stretches of one value alone, of which there is no {wear.reading}"] += int((~sound).sum())
        length = wear.every << self.doubled
        when = np.array([one.number * length + round(one.time / one.samples) for one in kept], dtype=np.int64)
        ages = np.array([(one.age / one.samples, one.effective / one.samples) for one in kept]).reshape(-1, 2).T
        when, ages, values = when[sound], ages[:, sound], values[sound]
        later = np.diff(np.maximum.accumulate(ages[0]), prepend=-math.inf) > 0
        if still := int((~later).sum()):
            left_out["readings while the part did not age, left out"] += still
        return WearReadings(when[later], ages[0, later], ages[1, later], values[later], left_out)

    def to_json(self) -> dict[str, Any]:
        """Return plain values, of which floats come back bit for bit."""
        return {
            "of": self.of,
            "begun": self.begun,
            "doubled": self.doubled,
            "stretches": [[*one[:3], *one.sums, *one[4:]] for one in self.stretches],
            "ambient": list(self.ambient) if self.ambient else None,
            "load": list(self.load) if self.load else None,
            "left_out": dict(self.left_out),
        }

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> WearCourse:
        """Return the course that ``to_json`` wrote."""
        ambient, load = (None if data[name] is None else (data[name][0], data[name][1]) for name in ("ambient", "load"))
        stretches = [
            Stretch(row[0], row[1], row[2], (row[3], row[4], row[5], row[6]), *row[7:]) for row in data["stretches"]
        ]
        return cls(data["of"], data["begun"], data["doubled"], stretches, ambient, load, Counter(data["left_out"]))


def definition(wear: WearSignal) -> str:
    """Return a text that is the same for two signals of wear whose samples are made alike."""
    beside = [f"{name} {one}" for name, one in (("ambient", wear.ambient), ("load", wear.load)) if one]
    return "; ".join([str(wear.gauge), f"every {wear.every / SECOND:g} s", *beside])


_NOTHING = (np.empty(0, np.int64), np.empty(0))


def _beside(
    gauge: Gauge, last: Heard | None, columns: Columns, times: Times, *, within: bool
) -> tuple[Array, Heard | None]:
    """What another signal said last before some times, NaN where that is not known; and what it said last of all."""
    when, said = columns.get(gauge.signal, _NOTHING)
    if within:
        known = (said >= gauge.low) & (said <= gauge.high)
        when, said = when[known], said[known]
    if last is not None:
        when, said = np.append(last[0], when), np.append(last[1], said)
    if not len(when):
        return np.full(len(times), math.nan), None
    index = np.searchsorted(when, times, side="right") - 1
    old = (index < 0) | (times - when[index] >= gauge.max_age)
    return np.where(old, math.nan, said[index]), (int(when[-1]), float(said[-1]))


def _summed(total: float, more: Array) -> float:
    """Added one after the other, which any split of them gives bit for bit."""
    return float(np.add.accumulate(np.append(total, more))[-1])


def take_samples(
    courses: dict[str, WearCourse],
    signals: Sequence[tuple[str, WearSignal]],
    columns: Columns,
    ageing: Sequence[Ageing],
) -> None:
    """Take the samples of some periods into the courses of failure modes, by key; ``ageing`` is of each mode's part."""
    for (key, wear), how in zip(signals, ageing, strict=True):
        course = courses.get(key)
        if course is None or course.of != definition(wear):
            course = courses[key] = WearCourse.begin(wear)
        course.take(wear, columns, how)
