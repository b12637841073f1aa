"""The parts that failures to come will come from, in words, bars and a table."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from robophm.health.failures_to_come import Contribution, FailuresToCome
from robophm.health.report import ComponentHealth
from robophm.report.bars import bars_svg
from robophm.report.markup import Html
from robophm.report.page import figure, table_html
from robophm.report.words import duration_text, more_text, percent_text, share_text

MOST = 10
"""Parts that a page shows."""

FEW = 5
"""Parts that a terminal and the page of the service show."""

VIEWS = ("nominal", "sensor-based")


def horizon_text(found: FailuresToCome) -> str:
    """The horizon in words: "within 2.1 years, the median remaining life"."""
    return f"within {duration_text(found.horizon)}" + ("" if found.stated else ", the median remaining life")


def shown(found: FailuresToCome, most: int) -> list[Contribution]:
    """The parts with the largest shares; none where nothing can fail or all has."""
    return [one for one in found.contributions[:most] if one.sensor_based > 0 or one.nominal > 0]


def notes(found: FailuresToCome, some: Sequence[Contribution]) -> Iterable[str]:
    """The notes that belong beside the shares."""
    if found.unknown:
        yield f"{found.unknown.of_shares}."
    if any(one.group for one in some):
        yield "A group of parts that depend on each other is one unit."


def contributors(found: FailuresToCome, components: Iterable[ComponentHealth]) -> Iterable[Html | str]:
    """Bars and a table of the parts that the failures to come will come from."""
    some = shown(found, MOST)
    if not some:
        yield "As far as is known nothing is left to fail."
        return
    ahead = horizon_text(found)
    yield figure(
        bars_svg({one.path: (one.nominal, one.sensor_based) for one in some}, VIEWS,
                 title=f"Share of the failures {ahead}, that a part brings about"),
        "Given that the robot fails: its failure is the one that fails the robot; percent: sensor-based",
    )  # fmt: skip
    rates = {one.path: (one.nominal_hazard_rate, one.sensor_based_hazard_rate) for one in components}
    rows = [
        (
            one.path,
            one.quantity,
            *rates.get(one.path, (None, None)),
            share_text(one.nominal),
            share_text(one.sensor_based),
        )
        for one in some
    ]
    columns = ("part", "quantity", "λ now nominal [1/h]", "λ now sensor [1/h]", "share nominal", "share sensor")
    works = percent_text(1 - found.sensor_based_failure, found.sensor_based_failure)
    says = found.unknown.said_ahead(works) if found.unknown else works
    rest = len(found.contributions) - len(some)
    caption = f"The robot survives {ahead}, with {says}. λ is of all equal parts together"
    yield table_html(columns, rows, caption + (f"; {more_text(rest, 'shown')}" if rest else ""), "lrrrrr")
    yield from notes(found, some)
