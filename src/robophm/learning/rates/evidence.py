"""Evidence written into a design beside each rate; all else in it stays letter for letter."""

from __future__ import annotations

from collections.abc import Sequence

from robophm.design.naming import quoted
from robophm.design.robot import CLOCK_UNITS
from robophm.learning.failure_mode_edits import edited
from robophm.learning.rates.rate_update import LearnedRate


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
        notes.append(f"contradicts the stated rate, whose weight was cut to {100 * found.weight:.2g} %")
    if one.of_fleet.spread:
        notes.append(f"robots differ by {100 * one.of_fleet.spread:.0f} % (standard deviation)")
    if notes:
        values["note"] = quoted("; ".join(notes))
    return "{" + ", ".join(f"{key}: {value}" for key, value in values.items()) + "}"
