"""Forecasts of wear from the unit's own past and from others of its kind, worn out or still running.

Five ways of foretelling are weighed by how well each foretells the others, one by one, from where the unit is now:

- its own past, by all degradation models (``averaging.py``), with the lives of the others as a prior; by itself, and as
  far as such forecasts held of the others (``own_forecast.py``);
- the lives of the others, whatever the signal says;
- how long others went on from the level where it is now, by how fast each had come there: from new, and through the
  last part of the way. That is similarity to their courses, with as much of it kept as the others themselves show;
- the courses of those most like it, at a pace and a size of its own (``shape_invariant.py``);
- of what breaks late, how long others went on since their damage showed (``since_onset.py``).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.core.errors import DataError
from robophm.learning.wear.averaging import DRAWS, LONGEST, WIDEST, Forecast, checked, first_passage, forecast
from robophm.learning.wear.log_regression import LIFE_SCATTER, Array, LogStudent, lasting
from robophm.learning.wear.own_forecast import WORST, OwnForecast
from robophm.learning.wear.shape_invariant import DegradationCurve, along
from robophm.learning.wear.since_onset import onset
from robophm.learning.wear.stated_life import StatedLife
from robophm.learning.wear.sudden_falls import before

PARTS = (0.0, 0.5, 0.8)
"""Shares of the present level from which the way to it is looked at."""

ASKED, FOLLOWED = 6, 4
"""The largest numbers of other units whose known ends the ways that take long foretell, so as to be weighted by that,
and whose courses one unit is foretold along."""

STEADY = 0.02
"""Noise of a level, as a share of the way to the threshold, down to which readings are averaged."""

SPIKE = 6.0
"""Usual steps by which one reading alone may be off before it is left out."""

BEFOREHAND = {"its own past": 1.0, "others' lives": 0.15, "from": 1.0, "along": 1.0, "since": 1.0}
"""Weights of the ways before anybody was asked: alike, but a trend that shows says more than age alone."""

STEPS = 200
"""Steps of the EM algorithm, after which weights stay."""


@dataclass(frozen=True)
class Unit:
    """Readings of another unit; shapes (readings,)."""

    times: Array
    values: Array
    threshold: float | None = None
    """Threshold of this unit; None: that of the unit that is asked about."""
    failed: float | None = None
    """When it failed, if that is known from elsewhere; None: when its readings first are at the threshold, if ever."""
    conditions: Mapping[str, Array] = field(default_factory=dict)
    """Conditions that its readings were taken under, by name (``conditions.py``); shapes (readings,)."""
    name: str = ""

    def called(self, k: int) -> str:
        """Return what it is called in an error, as the other unit ``k``, from 0."""
        return f"unit {f'{self.name!r:.40}' if self.name else k + 1} of the others"


@dataclass(frozen=True)
class Trajectory:
    """Levels that rise from 0 when new to 1 at the threshold, and how long it went on, from its first reading."""

    times: Array
    wear: Array
    level: Array
    duration: float
    ended: bool
    onset: float | None = None
    """When its damage began to show, since its first reading; None where it showed early, or it is not looked for."""

    def reached(self, level: float) -> float | None:
        """Time since its first reading; None where it never came so far."""
        if level > self.level[-1]:
            return None
        k = int(np.argmax(self.level >= level))
        if k == 0:
            return 0.0
        share = (level - self.level[k - 1]) / (self.level[k] - self.level[k - 1])
        return float(self.times[k - 1] + share * (self.times[k] - self.times[k - 1]) - self.times[0])

    @property
    def at_end(self) -> float:
        """Return what it read when it ended, to a millionth."""
        return float(np.interp(self.times[0] + self.duration, self.times, self.wear)) + 1e-6

    @property
    def worked(self) -> npt.NDArray[np.bool_]:
        """Return which readings are of before its end; shape (readings,)."""
        passed = self.times - self.times[0]
        result: npt.NDArray[np.bool_] = passed < self.duration if self.ended else passed <= self.duration
        return result

    def until(self, time: float) -> Trajectory:
        """Return the part of the trajectory that was known at a time since its first reading."""
        known = max(int(np.searchsorted(self.times - self.times[0], time, side="right")), 2)
        return replace(self, times=self.times[:known], wear=self.wear[:known], level=self.level[:known])


class UnitsAlike(NamedTuple):
    """Units of a kind on one scale: 0 as most begin, 1 at the threshold, on signals turned so that wear grows."""

    others: tuple[Trajectory, ...]
    own: Trajectory | None
    new: float
    """Signal at which most begin."""
    way: float
    """Change of the signal from there to the threshold."""


def forecast_among(
    others: Sequence[Unit], times: npt.ArrayLike, values: npt.ArrayLike, threshold: float, *, falls: bool = False,
    deviation: float = 0.0, seed: int = 0, draws: int = DRAWS, stated: StatedLife | None = None,
) -> Forecast:  # fmt: skip
    """Forecast when readings will reach a threshold, with others of the kind as teachers; else as ``forecast``.

    ``stated``: the life that is stated of the kind, which counts where no other has ended.

    ``weights`` of what is returned has "others' lives", "others from here", "along others' courses" and "others since
    damage showed" beside the unit's own models. Raises DataError as ``forecast`` does, and for others without two
    readings.
    """

    def alone_if(law_ends: bool) -> Forecast:
        return forecast(
            times, values, threshold, falls=falls, deviation=deviation, seed=seed, draws=draws, law_ends=law_ends
        )

    def by_stated_life() -> Forecast:
        if not (stated and stated.ages):
            return alone_if(True)
        # What takes the draws' prior off knows that of laws that go on; when life ends is said here, and not unknown.
        return stated.given(alone_if(False), float(np.asarray(times, dtype=float)[-1]))

    if not others:
        return by_stated_life()
    alone = alone_if(True)
    if alone.worn_out:
        return alone
    t, y, _ = checked(times, values, threshold, deviation, falls=falls)
    if alone.renewed is not None:
        t, y = t[t >= alone.renewed], y[t >= alone.renewed]
    kind = alike(others, threshold, falls=falls, own=(t, y))
    courses, now = list(kind.others), kind.own
    assert now is not None
    if not any(one.ended for one in courses):
        return by_stated_life()
    if alone.shows and (now := _looked_at(now)).onset is not None:
        courses.sort(key=lambda one: not one.ended)
        courses[:ASKED] = map(_looked_at, courses[:ASKED])
    asked = _asked(now, courses) if alone.shows else []
    ways = _ways(now, courses, OwnForecast(alone.passage), _fared_with(asked), draws)
    if not alone.shows:  # before damage shows its level tells nothing
        ways = {"others' lives": ways["others' lives"]}
    weights = _weights(courses, ways, asked)
    rng = np.random.default_rng(seed)
    counts = rng.multinomial(draws, list(weights.values()))
    passage = np.concatenate([ways[name].quantile(rng.random(n)) for name, n in zip(weights, counts, strict=True)])
    its_own = sum(share for name, share in weights.items() if name.startswith("its own past"))
    said = {name: its_own * share for name, share in alone.weights.items()}
    said["others' lives"] = weights["others' lives"]
    said["along others' courses"] = weights.get("along", 0.0)
    said["others since damage showed"] = weights.get("since", 0.0)
    said["others from here"] = sum(share for name, share in weights.items() if name.startswith("from"))
    return replace(alone, passage=passage, weights=said, surprise=max(alone.surprise, 1 - its_own))


class _Asked(NamedTuple):
    """An other that ended, where it was as the unit is."""

    one: Trajectory
    then: Trajectory
    left: float
    """How long it went on from there."""
    own: OwnForecast | None
    """The forecast of its own models; None where it was not asked for it, or they had too few readings."""
    off: float | None
    """How far off that was [its deviations]; None where it said nothing."""


_Way = OwnForecast | LogStudent


def alike(
    others: Sequence[Unit], threshold: float, *, falls: bool = False, own: tuple[Array, Array] | None = None
) -> UnitsAlike:
    """Return units on one scale of wear. ``own``: readings of the unit itself, its values turned so that wear grows.

    Raises DataError for others without two readings, or past the threshold from the first one on.
    """
    goal = -threshold if falls else threshold
    turned = [_turned(one, threshold, k, falls=falls) for k, one in enumerate(others)]
    starts = [float(wear[0]) for _, wear, _, _ in turned] + ([float(own[1][0])] if own else [])
    new = float(np.median(starts))
    if goal <= new:
        new = float(own[1][0]) if own else min(starts)
    way = goal - new
    levels = [1 - (limit - wear) / way for _, wear, limit, _ in turned]
    mine = [1 - (goal - own[1]) / way] if own else []
    width = _width([*levels, *mine])
    courses = tuple(_course(one[0], wear, width, one[3]) for one, wear in zip(turned, levels, strict=True))
    if own and len(courses) > 1 and not any(one.duration > 0 for one in courses):
        raise DataError(
            "the others all begin beyond the threshold: these readings passed it before they began; expected older ones"
        )
    for k, one in enumerate(courses):
        if not one.duration > 0:
            raise DataError(
                f"{others[k].called(k)} is past the threshold when its readings begin: how long it lived is not seen"
            )
    now = Trajectory(own[0], mine[0], _level(mine[0], width), float(np.ptp(own[0])), False) if own else None
    return UnitsAlike(courses, now, new, way)


def _turned(one: Unit, threshold: float, k: int, *, falls: bool) -> tuple[Array, Array, float, float | None]:
    """Times, wear that grows, threshold, and the end that is told."""
    t, y = np.asarray(one.times, dtype=float), np.asarray(one.values, dtype=float)
    if t.shape != y.shape or t.ndim != 1 or len(t) < 2 or np.any(np.diff(t) <= 0):
        raise DataError(f"{one.called(k)}: expected two readings or more, each later than the one before")
    if not (np.abs(y).max() <= WIDEST and np.abs(t).max() <= LONGEST and np.diff(t).min() >= 1 / LONGEST):
        raise DataError(f"{one.called(k)}: a time or value is no number, or none that a clock or sensor says")
    sign = -1.0 if falls else 1.0
    return t, sign * y, sign * (threshold if one.threshold is None else one.threshold), one.failed


def crossed(times: Array, wear: Array, threshold: float) -> float | None:
    """When readings came to a threshold to stay, or until they end; None where they never did."""
    end = first_passage(times, wear, threshold)
    if end is None and wear[-1] >= threshold:
        before = int(np.flatnonzero(wear < threshold)[-1]) if np.any(wear < threshold) else 0
        end = float(np.interp(threshold, wear[before : before + 2], times[before : before + 2]))
    return end


def _course(times: Array, wear: Array, width: int, failed: float | None) -> Trajectory:
    level = _level(wear, width)
    failed = crossed(times, wear, 1.0) if failed is None else failed
    end = float(times[-1]) if failed is None else failed
    return Trajectory(times, wear, level, end - float(times[0]), failed is not None)


def _level(wear: Array, width: int) -> Array:
    """The highest mean of the last readings so far; a reading far off by itself is left out."""
    kept = np.where(_spikes(wear), before(wear, 4), wear) if len(wear) > 8 else wear
    sums = np.concatenate([[0.0], np.cumsum(kept)])
    after = np.arange(1, len(wear) + 1)
    first = np.maximum(after - width, 0)
    means = (sums[after] - sums[first]) / (after - first)
    from scipy.optimize import isotonic_regression  # takes long to load

    result: Array = np.asarray(isotonic_regression(means).x, dtype=np.float64)
    return result


def _spikes(wear: Array) -> npt.NDArray[np.bool_]:
    """Whether each reading is far off the four before it and the one before: noise of no usual kind."""
    steps = np.abs(np.diff(wear, prepend=wear[0]))
    usual = SPIKE * before(steps, 50) + 1e-12
    found: npt.NDArray[np.bool_] = (np.abs(wear - before(wear, 4)) > usual) & (steps > usual)
    found[:3] = False
    return found


def noise_of(levels: Sequence[Array]) -> float:
    """Return the standard deviation of a reading: how readings differ from the mean of both neighbours, as most do."""
    rough = [1.4826 / np.sqrt(6) * np.median(np.abs(np.diff(one, 2))) for one in levels if len(one) > 4]
    return float(np.median(rough)) if rough else 0.0


def _width(levels: Sequence[Array]) -> int:
    """The number of readings that make a steady level, a tenth of all readings at most."""
    wanted = (noise_of(levels) / STEADY) ** 2
    return max(1, min(int(np.ceil(wanted)), int(np.median([len(one) for one in levels])) // 10))


def _ways(
    now: Trajectory, others: Sequence[Trajectory], own: OwnForecast | None, off: Sequence[float], draws: int
) -> dict[str, _Way]:
    """Every forecast of the remaining time, by name of the way in which it is made; without draws those without any.

    ``off``: how far off other units' own models were.
    """
    passed = float(now.times[-1] - now.times[0])
    ended = np.array([one.ended for one in others], dtype=bool)
    lives = np.array([one.duration for one in others])
    none = np.zeros((len(others), 0))
    ways: dict[str, _Way] = {}
    lived = lasting(np.maximum(lives, 1e-12), ended, none, none[0], passed, LIFE_SCATTER) if len(others) else None
    if lived:
        ways["others' lives"] = lived
    level = float(now.level[-1])
    for name, parts in {**{f"from {part:g}": (part,) for part in PARTS}, "from all": PARTS}.items():
        if from_here := _from_here(now, others, level, parts, passed):
            ways[name] = from_here
    if draws and (courses := _nearest(now, others)):
        ways["along"] = OwnForecast(along(courses, now.times - now.times[0], now.wear, draws))
    if since := _since_damage_showed(now, others, passed):
        ways["since"] = since
    if own:
        shares = _beforehand(ways)
        priors = {way: shares[name] for name, way in ways.items()}
        ways["its own past"] = own.given(priors)
        if off:
            ways["its own past, as it held of others"] = own.as_others_fared(off).given(priors)
    return ways


def _since_damage_showed(now: Trajectory, others: Sequence[Trajectory], passed: float) -> LogStudent | None:
    """How long they went on since then; None where it does not show yet, or showed all their lives."""
    if now.onset is None or passed < now.onset:
        return None
    went_on = [(one.duration - one.onset, one.ended) for one in others if one.onset is not None]
    if not went_on:
        return None
    durations, ended = (np.array(column) for column in zip(*went_on, strict=True))
    none = np.zeros((len(durations), 0))
    return lasting(durations, ended, none, none[0], passed - now.onset, LIFE_SCATTER)


def _looked_at(one: Trajectory) -> Trajectory:
    """Return it with when its damage began to show, by what was known before it ended."""
    known = one.worked
    began = onset(one.times[known], one.wear[known])
    return replace(one, onset=None if began is None else began - float(one.times[0]))


def _nearest(now: Trajectory, others: Sequence[Trajectory]) -> list[DegradationCurve]:
    """Courses of those that came to the threshold, and to the present level in a time most like the unit's."""
    level = float(now.level[-1])
    came = [one for one in others if one.ended and one.at_end >= 1]
    came.sort(key=lambda one: abs((one.reached(level) or 0.0) - (now.reached(level) or 0.0)))
    return [DegradationCurve(one.times - one.times[0], one.wear, one.duration) for one in came[:FOLLOWED]]


def _beforehand(ways: Iterable[str]) -> dict[str, float]:
    """Weights a priori, by name; those from here share theirs, as do those by its own past."""
    names = [name.partition(" ")[0] if name.startswith("from") else name.partition(",")[0] for name in ways]
    return {way: BEFOREHAND[name] / names.count(name) for way, name in zip(ways, names, strict=True)}


def _from_here(
    now: Trajectory, others: Sequence[Trajectory], level: float, parts: Sequence[float], passed: float
) -> LogStudent | None:
    """How long they went on from a level, by how long the last parts of the way there took."""
    mine = now.reached(level)
    assert mine is not None
    starts = [part * level for part in parts] if level > 0 and mine > 0 else []
    rows, features, ended = [], [], []
    for one in others:
        came = one.reached(level)
        if came is None or came >= one.duration:
            continue
        rows.append(one.duration - came)
        features.append(_took(one, came, starts))
        ended.append(one.ended)
    if not rows:
        return None
    own = _took(now, mine, starts)
    return lasting(np.array(rows), np.array(ended), np.array(features), own, passed - mine)


def _took(one: Trajectory, came: float, starts: Sequence[float]) -> Array:
    """Logarithms of how long the ways from lower levels took."""
    since = [one.reached(start) or 0.0 if start > 0 else 0.0 for start in starts]
    return np.log(np.maximum(came - np.array(since), 1e-9 * max(one.duration, 1e-300)))


def _asked(now: Trajectory, others: Sequence[Trajectory]) -> list[_Asked]:
    """Others that ended, from where they were as the unit is; the first of them with what their own models said."""
    found: list[_Asked] = []
    for one in [other for other in others if other.ended]:
        came = one.reached(float(now.level[-1]))
        if came is not None and now.onset is not None:  # it came so far while it was sound
            came = max(came, one.onset or 0.0)
        if came is None or came >= one.duration:
            continue
        then = one.until(came)
        left = one.duration - float(then.times[-1] - then.times[0])
        if left > 0:
            own = _own_of(then) if len(found) < ASKED else None
            found.append(_Asked(one, then, left, own, own.off_by(left) if own else None))
    return found


def _fared_with(asked: Iterable[_Asked]) -> list[float]:
    return [other.off for other in asked if other.off is not None]


def _weights(others: Sequence[Trajectory], ways: dict[str, _Way], asked: Sequence[_Asked]) -> dict[str, float]:
    """By how well each way foretells the others that ended, from where they were as the unit is; they sum to 1."""
    if len(ways) == 1:
        return dict.fromkeys(ways, 1.0)
    scores: dict[str, list[float]] = {name: [] for name in ways}
    for k, (one, then, left, own, _) in enumerate(asked if len(others) > 1 else ()):
        rest = [other for other in others if other is not one]
        off = _fared_with(other for other in asked if other.one is not one)
        for name, way in _ways(then, rest, own, off, 500 if k < ASKED else 0).items():
            if name in scores:
                scores[name].append(max(float(way.log_density(left)), WORST))
    return stacked(_beforehand(ways), scores)


def stacked(prior: Mapping[str, float], scores: Mapping[str, Sequence[float]]) -> dict[str, float]:
    """Return weights of ways by the logarithmic scores of how each foretold units; ``prior`` counts as one unit more.

    Each unit may be of the kind that another way foretells: weights are the shares of kinds, by the EM algorithm of a
    mixture (Dempster, Laird and Rubin, J. R. Stat. Soc. B 39, 1977), and no way is left out because most units go
    otherwise. A unit that a way was not asked about counts with the mean of those that it was, or that others were.
    """
    units = max(map(len, scores.values()), default=0)
    names, weights = list(prior), np.array(list(prior.values()))
    start = weights = weights / weights.sum()
    if not units:
        return dict(zip(names, weights.tolist(), strict=True))
    means = {name: float(np.mean(found)) for name, found in scores.items() if found}
    usual = float(np.mean(list(means.values())))
    logs = np.array([[*scores[name], *[means.get(name, usual)] * (units - len(scores[name]))] for name in names]).T
    likely = np.exp(logs - logs.max(axis=1, keepdims=True))
    for _ in range(STEPS):
        shares = likely * weights
        weights = (start + (shares / shares.sum(axis=1, keepdims=True)).sum(axis=0)) / (1 + units)
    return dict(zip(names, weights.tolist(), strict=True))


def _own_of(then: Trajectory) -> OwnForecast | None:
    """The forecast that another unit's own models had given; None where they had too few readings."""
    try:
        return OwnForecast(forecast(then.times, then.wear, 1.0, draws=1000, judged=False).passage)
    except DataError:
        return None
