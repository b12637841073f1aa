"""Learned rates as people and machines read them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from robophm.cli.shared.output import console, print_table, table
from robophm.learning.rates.fleet import StatedRateRatio
from robophm.learning.rates.rate_update import LearnedRate, UnstatedRate
from robophm.report.learned_rates import contradictions, learned_rows, unstated_text


def print_learned(
    whose: str, learned: Sequence[LearnedRate], unrated: Sequence[UnstatedRate], more: str = "", then: str = ""
) -> None:
    """Print what the field says of rates; ``more`` is said where robots differ, ``then`` in the end."""
    out = console()
    columns, rows = learned_rows(learned, unrated)
    print_table(out, table(f"What the field says of {whose}", columns, rows, figures=range(1, len(columns))))
    for words in contradictions(learned, more):
        out.print(words, style="yellow" if words.startswith("* ") else None, markup=False, soft_wrap=True)
    for other in unrated:
        out.print(unstated_text(other), style="yellow", markup=False, soft_wrap=True)
    out.print(f"expected: failures by the stated rate; times: learned over stated. {then}".rstrip(), markup=False)


def unstated_json(one: UnstatedRate) -> dict[str, Any]:
    """Return what the field says of a part of unknown rate."""
    (low, high), any_ = one.interval, one.exposure > 0
    return {
        "mode": one.mode.path, "clock": one.mode.clock, "failures": one.failures, "exposure": one.exposure,
        "rate": one.rate if any_ else None, "low": low if any_ else None, "high": high if any_ else None,
    }  # fmt: skip


def rate_json(one: LearnedRate) -> dict[str, Any]:
    """Return what was learned of a rate."""
    found = one.posterior
    return {
        "mode": one.mode.path, "clock": one.mode.clock, "failures": one.failures, "expected": one.expected,
        "exposure": one.exposure, "stated_rate": one.stated, "learned_rate": one.rate, "factor": one.factor,
        "low": one.low, "high": one.high, "shape": one.shape, "prior_failures": found.prior,
        "conflict": found.conflict, "surprise": found.surprise, "prior_failures_left": found.left,
        "fleet_mean": ratio_json(one.fleet.mean), "next_robot": ratio_json(one.fleet.next),
        "spread_of_robots": one.fleet.spread and dict(zip(("low", "median", "high"), one.fleet.spread, strict=True)),
    }  # fmt: skip


def robots_json(one: LearnedRate) -> dict[str, Any]:
    """Return what was learned of each robot's own rate."""
    return {
        name: {"failures": failures, **ratio_json(own)}
        for name, failures, own in zip(one.robots, one.failures_of, one.fleet.robots, strict=True)
    }


def ratio_json(one: StatedRateRatio) -> dict[str, float]:
    """Return the estimate of a ratio of rates with its interval."""
    return {"factor": one.times, "low": one.low, "high": one.high}
