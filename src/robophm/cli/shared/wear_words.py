"""Wear by its readings, in words and as JSON."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np
from rich.console import Console

from robophm.cli.shared.output import print_table, table
from robophm.core.prognostics import ALPHA
from robophm.health.prognosis import RemainingLife
from robophm.health.unknown_rates import marked, marks
from robophm.learning.wear.averaging import UNFOLLOWED, Interval
from robophm.learning.wear.backtest import Backtest
from robophm.learning.wear.cusum import Cusum
from robophm.learning.wear.trend_bend import FALSE_ALARMS
from robophm.learning.wear.worn_mode import WornMode
from robophm.monitoring.worn_life import Life, WornLife
from robophm.report.curve import sparkline
from robophm.report.words import duration_text, moment_text, more_text, number_text, percent_text, share_text

TELLING = 0.005
"""Weight of a model below which it is not listed."""

TOLD = 4
"""Times of events or alarms that are listed."""

_BEYOND = "–"

NOTHING_SAID = Interval(math.inf, math.inf, math.inf)


def print_worn(out: Console, found: WornMode) -> None:
    """Print trend, time to the threshold, events and changes of one failure mode."""

    def say(text: str, style: str = "") -> None:
        out.print(text, style=style, markup=False, soft_wrap=True)

    unit, values, wear = found.unit, found.values, found.wear
    first, last = (number_text(float(values[i])) for i in (0, -1))
    span = number_text(float(np.ptp(found.readings.times)))
    say(f"{found.source}: {len(values)} readings over {span} {unit}, {first} to {last}", "bold")
    say(sparkline(values, 60))
    if found.others:
        count = len(found.others)
        say("Beside " + (f"{count} others" if count > 1 else "one other") + " of its kind")
    if found.to_come:
        under = ", ".join(f"{name} {number_text(value, 3)}" for name, value in found.to_come.items())
        say(f"As it would be at {under}, as times and speeds count here")
        for outside in _outside(found):
            say(outside, "yellow")
    low, median, high = (number_text(1000 * one, 3) for one in wear.trend)
    bend = f"; so far it is {wear.bend.direction} (p = {number_text(wear.bend.p_value, 2)})"
    noise = f"; noise of a reading {number_text(wear.noise, 2)}" if wear.noise else ""
    if np.ptp(wear.drift) == 0:  # worn out: nothing is foretold
        say(f"Trend over all readings: {median} per 1000 {unit}{bend if wear.bend.direction else ''}")
    else:
        say(f"Trend now: {median} per 1000 {unit}, 90 % between {low} and {high}"
            f"{bend if wear.bend.direction else ''}{noise}")  # fmt: skip
    if wear.events:
        say(f"Wear fell back at once: {_times(found, wear.events)}")
    if wear.renewed is not None:
        say(f"As if new since {_time(found, wear.renewed)}: readings before that do not count for its life")
    say(_threshold_text(found), "bold red" if wear.worn_out else "")
    if not wear.followed:
        say(f"No model follows this wear: it went where it was foretold to go with {percent_text(wear.surprise)}, less "
            f"than {percent_text(UNFOLLOWED)}; its life is not to be believed", "bold red")  # fmt: skip
    elif wear.weights and wear.said:
        most = [one for one in sorted(wear.weights.items(), key=lambda one: -one[1]) if one[1] >= TELLING][:3]
        say(f"By {', '.join(f'{name} {share_text(share, 2)}' for name, share in most)}")
    say(*_change_text(found))


def _outside(found: WornMode) -> list[str]:
    """Of conditions to come that no reading comes near: what is said rests on the law by which they speed wear up."""
    said = []
    for name, value in found.to_come.items():
        taken = [found.readings.conditions, *(one.conditions for one in found.others)]
        seen = np.concatenate([under[name] for under in taken if name in under])
        low, high = float(seen.min()), float(seen.max())
        if not low <= value <= high:
            span = number_text(low, 3) + (f" … {number_text(high, 3)}" if high > low else "")
            said.append(
                f"Readings are at {name} {span}: what is said of {number_text(value, 3)} rests on its law alone"
            )
    return said


def _threshold_text(found: WornMode) -> str:
    wear = found.wear
    threshold = f"{wear.signal_threshold:g}" + (f" ± {found.deviation:g}" if found.deviation else "")
    if wear.reached is not None:
        at = f"reached {threshold} at {_time(found, wear.reached)}"
        if not wear.worn_out:
            life = _life_text(found, threshold)
            return f"Had {at}, before it was as if new; {life[0].lower()}{life[1:]}"
        if wear.recovered is None:
            return f"Has {at}"
        return f"Has {at}; short of it again since {_time(found, wear.recovered)}, and had reached it all the same"
    text = _life_text(found, threshold)
    if not wear.shows and np.quantile(wear.drift, 0.95) < 0:
        text += f"; its trend leads away from there, or it was past {threshold} when readings began"
    return text


def _life_text(found: WornMode, threshold: str) -> str:
    wear, unit = found.wear, found.unit
    if not wear.said:
        trend = "A trend shows, but not surely one" if wear.shows else "No trend shows yet"
        none = f"{trend} that leads to {threshold}"
        return f"{none}: when it is reached cannot be said; its hazard rate stands"
    low, median, high = (number_text(one, 3) for one in wear.remaining)
    goal = "fails" if found.index else f"reaches {threshold}"
    reaches = f"{goal} in {median} {unit}, 90 % between {low} and {high}"
    if math.isinf(wear.remaining.high):
        share = f"{share_text(wear.never, 2)} of what is drawn"
        reaches = f"{goal} in {median} {unit}; 5 % by {low}, and in {share} it does not come there"
    if not wear.shows:
        by = "by how long those went on that looked as sound" if found.index else "by the lives of the others"
        return f"No trend shows yet; {by} it {reaches}"
    return reaches[0].upper() + reaches[1:]


def _change_text(found: WornMode) -> tuple[str, str]:
    """The line about changes, and its style."""
    detector = found.detector
    if detector is None:
        return f"Change: not looked for: {found.unlooked}", ""
    at = _times(found, found.alarmed) if found.alarms else "none"
    delay = f"within {number_text(detector.delay, 3)}" if math.isfinite(detector.delay) else "later than is of use"
    text = f"Change against the first {detector.readings} readings: {at}"
    shift = f"{2 * detector.reference:g} deviation{'s' if detector.reference != 0.5 else ''}"
    meant = f"CUSUM for shifts of {shift}, half of them seen {delay} readings"
    if detector.promised:
        return f"{text} ({meant}; falsely once in {detector.between_false_alarms:g} while all is as then)", ""
    if detector.drifts:
        return f"{text} ({meant}; how often falsely cannot be promised: those drift already)", "yellow"
    worth = number_text(max(detector.independent, 1.0), 2)
    why = f"those follow one another, and are worth {worth} independent"
    return f"{text} ({meant}; how often falsely cannot be promised: {why})", "yellow"


def _time(found: WornMode, time: float) -> str:
    when = found.when(time)
    return f"{number_text(time)} {found.unit}" + (f", {moment_text(when)[:19]}" if when is not None else "")


def _times(found: WornMode, times: Sequence[float]) -> str:
    """The first of them, and how many more there are."""
    more = len(times) - TOLD
    listed = "; ".join(_time(found, time) for time in times[:TOLD])
    return f"{listed}; {more_text(more, 'listed')}" if more > 0 else listed


def print_backtest(out: Console, found: WornMode, done: Backtest) -> None:
    """Print what would have been said at earlier readings, what came, and how good that was."""
    unit, end = found.unit, _time(found, done.end)
    what = f"when {done.threshold:.4g} would be reached; it was at {end}"
    if not done.reached:
        what = f"when it would be where it is now, at {done.threshold:.4g}; it was first there at {end}"
    rows = []
    for cut in done.cuts:
        texts = [number_text(cut.time), str(cut.readings), *("–",) * 3, number_text(cut.left, 3), "", ""]
        if cut.forecast is not None:
            remaining = cut.forecast.remaining
            ends = (remaining.median, remaining.low, remaining.high)
            texts[2:5] = [number_text(one, 3) if math.isfinite(one) else _BEYOND for one in ends]
            texts[6] = "held" if cut.held else "missed"
        texts[7] = f"within {100 * ALPHA:g} %" if cut.near else ""
        rows.append(texts)
    columns = [f"at [{unit}]", "readings", "median", "5 % by", "95 % by", "it took", "interval", "median is"]
    title = f"Backtest, {found.mode.path}: what would have been said of {what}"
    out.print(title, style="bold", markup=False, soft_wrap=True)
    print_table(out, table("", columns, rows, figures=range(6)))
    held, of = sum(cut.held for cut in done.foretold), len(done.foretold)
    kept = f"{held} of {of} intervals of 90 % held"
    if not done.told:
        out.print(f"At no cut could a life have been said; {kept}", markup=False)
        return
    near = "never for good" if done.near_from is None else f"from {_time(found, done.near_from)} on"
    horizon = "none" if done.horizon is None else f"{number_text(done.horizon, 3)} {unit}"
    out.print(
        f"A life would have been said at {len(done.told)} of {len(done.cuts)} cuts, all of one life; {kept}; "
        f"relative accuracy {number_text(done.relative_accuracy or 0.0, 2)}; median within {100 * ALPHA:g} % of what "
        f"was left {near}; prognostic horizon {horizon}", markup=False, soft_wrap=True,
    )  # fmt: skip


def print_index_backtest(out: Console, found: WornMode, done: Mapping[str, Backtest]) -> None:
    """Print how well an index foretold each unit that failed, by others, and all of them together."""
    unit = found.unit
    rows = []
    for name, one in done.items():
        held = f"{sum(cut.held for cut in one.foretold)} of {len(one.foretold)}"
        accuracy = number_text(one.relative_accuracy, 2) if one.relative_accuracy is not None else _BEYOND
        horizon = number_text(one.horizon, 3) if one.horizon is not None else _BEYOND
        near = number_text(one.near_from, 3) if one.near_from is not None else _BEYOND
        rows.append([name, number_text(one.end, 3), held, accuracy, horizon, near])
    columns = [
        "unit", f"failed at [{unit}]", "intervals held", "relative accuracy", f"prognostic horizon [{unit}]",
        f"within {100 * ALPHA:g} % from [{unit}]",
    ]  # fmt: skip
    title = f"Backtest, {found.mode.path}: each unit that failed, foretold by the others at earlier readings"
    out.print(title, style="bold", markup=False, soft_wrap=True)
    print_table(out, table("", columns, rows, figures=range(1, 6)))
    cuts = [cut for one in done.values() for cut in one.foretold]
    out.print(
        f"{sum(cut.held for cut in cuts)} of {len(cuts)} intervals of 90 % held, of {len(done)} lives", markup=False
    )


def backtest_json(done: Backtest) -> dict[str, Any]:
    """Return a backtest for JSON; null is what cannot be said."""
    return {
        "threshold": done.threshold,
        "reached": done.reached,
        "end": done.end,
        "coverage": done.coverage,
        "relative_accuracy": done.relative_accuracy,
        "prognostic_horizon": done.horizon,
        "near_from": done.near_from,
        "cuts": [
            {
                "time": cut.time,
                "readings": cut.readings,
                "remaining": interval_json(cut.forecast.remaining) if cut.forecast else None,
                "said": cut.said,
                "left": cut.left,
                "held": cut.held if cut.forecast else None,
                "relative_accuracy": cut.accuracy,
                "near": cut.near,
            }
            for cut in done.cuts
        ],
    }


def print_lives(out: Console, lives: Mapping[str, WornLife]) -> None:
    """Print remaining lives, by hazard alone and with wear."""
    rows, unsaid = [], False
    for name, both in lives.items():
        with_wear = "with its wear" if both.holds else "with its wear, which no model follows"
        for what, (life, left_out) in (("by hazard alone", both.by_hazard), (with_wear, both.with_wear)):
            times = [duration_text(time) for time in (life.early, life.median, life.late)]
            if what == with_wear:
                times = [_BEYOND if math.isinf(one) else said for one, said in zip(_three(life), times, strict=True)]
                unsaid = unsaid or _BEYOND in times
            rows.append([f"{name} {what}", *(marked(marks(left_out)[2], one) for one in times)])
    columns = ["", "5 % by", "median", "95 % by"]
    print_table(out, table("Remaining life, calendar time", columns, rows, figures=(1, 2, 3)))
    if unsaid:
        out.print(f"{_BEYOND}: cannot be said; it may never come", markup=False)


def _three(life: RemainingLife) -> tuple[float, float, float]:
    return life.early, life.median, life.late


def worn_json(one: WornMode) -> dict[str, Any]:
    """Return the wear of one failure mode for JSON; null is what cannot be said."""
    wear = one.wear
    return {
        "mode": one.mode.path,
        "unit": one.unit,
        "readings": len(one.values),
        "others": len(one.others),
        "threshold": wear.signal_threshold,
        "threshold_deviation": one.deviation,
        "conditions_to_come": dict(one.to_come),
        "trend": wear.trend._asdict(),
        "bend": {"direction": wear.bend.direction, "p": wear.bend.p_value, "false_alarms": FALSE_ALARMS},
        "noise": wear.noise,
        "remaining": interval_json(wear.remaining if wear.said else NOTHING_SAID),
        "said": wear.said,
        "trend_shows": wear.shows,
        "never": wear.never,
        "reached": wear.reached,
        "recovered": wear.recovered,
        "renewed": wear.renewed,
        "events": wear.events,
        "followed": wear.followed,
        "surprise": wear.surprise,
        "weights": dict(wear.weights),
        "change": {"not_looked_for": one.unlooked} if one.detector is None else _change_json(one.detector, one.alarmed),
    }


def _change_json(detector: Cusum, alarmed: Sequence[float]) -> dict[str, Any]:
    return {
        "mean": detector.mean,
        "deviation": detector.deviation,
        "limit": detector.limit,
        "between_false_alarms": detector.between_false_alarms if detector.promised else None,
        "delay": _finite(detector.delay),
        "independent": detector.independent,
        "alarms": alarmed,
    }


def interval_json(interval: Interval) -> dict[str, float | None]:
    """Return an interval for JSON; null where it is beyond what can be said."""
    return {name: _finite(one) for name, one in interval._asdict().items()}


def lives_json(lives: Mapping[str, WornLife]) -> dict[str, Any]:
    """Return lives by hazard alone, and with wear, for JSON; of the latter null is what cannot be said."""

    def life(one: Life) -> dict[str, Any]:
        life, left_out = one
        return {"early": life.early, "median": life.median, "late": life.late, "mean": life.mean,
                **({"unknown": asdict(left_out)} if left_out else {})}  # fmt: skip

    def fused(one: WornLife) -> dict[str, Any]:
        found = life(one.with_wear)
        finite = {name: _finite(said) if isinstance(said, float) else said for name, said in found.items()}
        return {**finite, "holds": one.holds}

    return {name: {"hazard": life(one.by_hazard), "fused": fused(one)} for name, one in lives.items()}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
