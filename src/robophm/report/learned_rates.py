"""Rates as failures in the field have them, in the rows of a table and in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from robophm.design.robot import CLOCK_UNITS, UNKNOWN
from robophm.learning.rates.evidence import FEWEST_TO_DIFFER, spread_text
from robophm.learning.rates.rate_update import LearnedRate, UnstatedRate
from robophm.report.words import number_text


def learned_rows(learned: Sequence[LearnedRate], unrated: Sequence[UnstatedRate]) -> tuple[list[str], list[list[str]]]:
    """Return the columns of a table of learned rates, and its rows; an asterisk marks what contradicts its rate."""
    whose = " of the next robot" if len({name for one in learned for name in one.robots}) > 1 else ""
    if learned and learned[0].of:
        whose = f" of {learned[0].of}"
    columns = ["", "failures", "expected", "exposure", "stated rate", "learned rate", f"90 %{whose}", "times"]
    rows = []
    for one in learned:
        unit = CLOCK_UNITS[one.mode.clock]
        rows.append([
            one.mode.path + (" *" if one.posterior.conflict else ""),
            number_text(one.failures), number_text(one.expected, 3), f"{number_text(one.exposure)} {unit}",
            f"{number_text(one.stated, 3)} /{unit}", f"{number_text(one.rate, 3)} /{unit}",
            f"{number_text(one.stated * one.low, 3)} … {number_text(one.stated * one.high, 3)}",
            number_text(one.factor, 3),
        ])  # fmt: skip
    for other in unrated:
        exposure = f"{number_text(other.exposure)} {CLOCK_UNITS[other.mode.clock]}"
        rows.append([other.mode.path, number_text(other.failures), "–", exposure, UNKNOWN, "–", "–", "–"])
    return columns, rows


def contradictions(learned: Sequence[LearnedRate], more: str = "") -> Iterator[str]:
    """Say which stated rates the field contradicts, and how far robots differ; ``more``: added to the latter."""
    for one in learned:
        found, unit = one.posterior, CLOCK_UNITS[one.mode.clock]
        if found.conflict:
            yield (
                f"* {one.mode.path}: {_failures(found.failures)} the stated rate, by which "
                f"{number_text(found.expected, 3)} were expected (p = {number_text(found.surprise, 2)}); it weighs as "
                f"much as {number_text(found.left, 2)} failures now, instead of {number_text(found.prior, 3)}"
            )
        if one.fleet.spread and found.failures >= FEWEST_TO_DIFFER:
            mean = [number_text(one.stated * end, 3) for end in one.fleet.mean[1:]]
            yield (
                f"{one.mode.path}: {spread_text(one.fleet.spread)}; "
                f"their mean is {mean[0]} … {mean[1]} /{unit} with 90 %{'' if one.of else more}"
            )


def unstated_text(one: UnstatedRate) -> str:
    """Say what the field alone says of a part whose rate the design does not know."""
    unit, (low, high) = CLOCK_UNITS[one.mode.clock], one.interval
    said = f"{one.mode.path}: its rate is {UNKNOWN}, there is none to learn beside"
    if not one.exposure > 0:
        return f"{said}; nor does the field say more, which is of no exposure"
    if not one.failures:
        return f"{said}. By the field alone, if it is constant: below {number_text(high, 3)} /{unit} with 95 %"
    return (
        f"{said}. By the field alone, if it is constant: {number_text(one.rate, 3)} /{unit}, 90 % between "
        f"{number_text(low, 3)} and {number_text(high, 3)}; in a design rate: {one.rate:.4g} /{unit} with "
        f"uncertainty: {{failures: {one.failures:g}}}"
    )


def _failures(number: float) -> str:
    return f"{number_text(number, 3)} failure{'s contradict' if number != 1 else ' contradicts'}"
