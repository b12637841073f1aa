"""Evidence written into a design beside each rate; all else in it stays letter for letter."""

from __future__ import annotations

from collections.abc import Sequence

from robophm.design.naming import quoted
from robophm.design.robot import CLOCK_UNITS
from robophm.learning.failure_mode_edits import edited
from robophm.learning.rates.rate_update import LearnedRate

FEWEST_TO_DIFFER = 2
"""Failures from which on a fleet says anything of how much its robots differ."""

SHOWN = 0.1
"""Coefficient of variation that robots have at least with 95 % where it can be said that they differ."""


def spread_text(spread: tuple[float, float, float]) -> str:
    """A clause on how much the rates of robots differ, from three quantiles of their coefficient of variation."""
    low, usual, high = (f"{100 * part:.0f}" for part in spread)
    if spread[0] < SHOWN:
        return f"the field does not tell whether robots differ: by {low} … {high} %"
    return f"robots differ by {usual} % ({low} … {high} %)"


def with_evidence(text: str, label: str, learned: Sequence[LearnedRate]) -> str:
    """Return a design's text with what was learned of its rates; what was learned of them before gives way.

    Raises DesignError where a part cannot be edited in its place, or the result would not say what was learned.
    """
    return edited(text, label, {one.mode.path: {"learned": _written(one)} for one in learned})


def _written(one: LearnedRate) -> str:
    found = one.posterior
    values: dict[str, str] = {
        "factor": f"{one.factor:.6g}",
        "shape": f"{one.shape:.6g}",
        "failures": f"{one.failures:g}",
        "expected": f"{one.expected:.4g}",
        "exposure": f"{one.exposure:.10g} {CLOCK_UNITS[one.mode.clock]}",
        "low": f"{one.low:.4g}",
        "high": f"{one.high:.4g}",
        "prior": f"{found.prior:.4g}",
    }
    notes = []
    if found.conflict:
        left = f"{found.left:.2g}"
        notes.append(f"contradicts the stated rate, which counts as {left} failure{'s' * (left != '1')} beside them")
    if one.fleet.spread and found.failures >= FEWEST_TO_DIFFER:
        notes.append(f"{spread_text(one.fleet.spread)}; low … high are of one")
    if notes:
        values["note"] = quoted("; ".join(notes))
    return "{" + ", ".join(f"{key}: {value}" for key, value in values.items()) + "}"
