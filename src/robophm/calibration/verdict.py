"""The verdict on scores, in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from robophm.calibration.count import SMALLEST
from robophm.calibration.lives import MOST_CENSORED, LifeScore
from robophm.calibration.tasks import LEVEL, TaskScore

Finding = Literal["calibrated", "not calibrated", "too little data"]

WORTH_SEEING = 2.0
"""A model is called calibrated only where being off by this factor, either way, would have been seen."""

_SAME = 1.2  # times one probability is much the same


@dataclass(frozen=True)
class Verdict:
    """A judgement of a model in one or two sentences, and whether it is honest."""

    finding: Finding
    text: str

    def __str__(self) -> str:
        return f"{self.finding.capitalize()}{self.text}"


def judge_tasks(score: TaskScore) -> Verdict:
    """Return the verdict on predicted probabilities of task completion."""
    counted = f"{score.failed:,} of {_many(score.tasks, 'task')} failed where {_figure(score.expected)} were expected"
    if score.impossible:
        return Verdict("not calibrated", f" (p = 0): {_impossible(score.impossible)}; {counted}.")
    if score.p_value < LEVEL:
        return Verdict("not calibrated", f" ({p_text(score.p_value)}): {_task_fault(score, counted)}.")
    low, high = score.seen
    if high > WORTH_SEEING or low < 1 / WORTH_SEEING:
        more = f"{_figure(high)} times as many as promised" if np.isfinite(high) else "what it calls impossible"
        fewer = f"{_figure(low)} times as many" if low > 0 else "none"
        return Verdict(
            "too little data",
            f" to tell: {counted}; of too many failures only {more} would have been seen, of too few {fewer}.",
        )
    text = (
        f": {counted} ({p_text(score.p_value)}); {_figure(high)} or {_figure(low)} times as many would have been seen."
    )
    if score.bins[-1].highest <= _SAME * score.bins[0].lowest:
        text += " It gives all tasks much the same probability: honest, but no help in telling them apart."
    return Verdict("calibrated", text)


def _task_fault(score: TaskScore, counted: str) -> str:
    worst = min(score.bins, key=lambda one: one.p_value)
    where = (
        f"of {_many(worst.tasks, 'task')} predicted to fail with {_percent(worst.lowest)} … {_percent(worst.highest)}, "
        f"{worst.failed:,} did where {_figure(worst.expected)} were expected"
    )
    if score.p_total * 3 >= LEVEL:
        return f"in all {counted}, but the probabilities do not fit the tasks: {where}"
    fault = f"it promised too {'much' if score.failed > score.expected else 'little'}: {counted}"
    return f"{fault}; furthest off, {where}" if min(score.p_worst_bin, score.p_bins) < score.p_total else fault


def judge_lives(score: LifeScore) -> Verdict:
    """Return the verdict on predicted remaining lives."""
    notes = [f"the first of their {score.predictions:,} predictions"] if score.predictions > score.lives else []
    notes += [f"{score.censored:,} still going on"] if score.censored else []
    counted = _many(score.lives, "life", "lives") + (f" ({'; '.join(notes)})" if notes else "")
    if score.impossible:
        return Verdict("not calibrated", f" (p = 0): {_impossible(score.impossible)}; {counted}.")
    held = ", ".join(f"{_percent(one.share)} in the {_percent(one.level)} interval" for one in score.coverage)
    if score.p_value < LEVEL:
        return Verdict(
            "not calibrated", f" ({p_text(score.p_value)}): {_life_fault(score)}; of {counted} ended {held}."
        )
    if score.censored > MOST_CENSORED * score.lives:
        return Verdict("too little data", f" to tell: {counted} say too little; at least half must have ended.")
    if score.seen > WORTH_SEEING:
        seen = f"only hazards {_off(score.seen)}" if np.isfinite(score.seen) else "nothing that is possible"
        return Verdict("too little data", f" to tell: {counted}; {seen} would have been seen.")
    return Verdict(
        "calibrated",
        f": of {counted} ended {held} ({p_text(score.p_value)}); hazards {_off(score.seen)} would have been seen.",
    )


def _life_fault(score: LifeScore) -> str:
    faults = []
    if abs(score.mean - 0.5) > 3 * (12 * score.lives) ** -0.5:
        faults.append(f"lives were {'longer' if score.mean > 0.5 else 'shorter'} than it said")
    if any(one.high < one.level for one in score.coverage):
        faults.append("its intervals were too narrow")
    elif any(one.low > one.level for one in score.coverage):
        faults.append("its intervals were too wide")
    return " and ".join(faults) or "lives did not spread as it said"


def _impossible(count: int) -> str:
    return "what it called impossible happened" + (f" {count:,} times" if count > 1 else "")


def _off(factor: float) -> str:
    return f"{_figure(factor)} times as high as promised, or as much lower,"


def p_text(p: float) -> str:
    """Return a p-value as text: "p = 3e-12", "p < 1e-279"."""
    return f"p < {10 * SMALLEST:.0e}" if 0 < p < 10 * SMALLEST else f"p = {p:.2g}"


def _figure(value: float) -> str:
    """A number of events or a factor to three digits, at least one decimal below a thousand."""
    return f"{value:,.0f}" if value >= 1000 else f"{value:.1f}" if value >= 10 else f"{value:.3g}"


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %"


def _many(count: int, one: str, more: str = "") -> str:
    return f"{count:,} {one if count == 1 else more or one + 's'}"
