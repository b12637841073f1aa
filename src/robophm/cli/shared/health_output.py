"""A robot's health on a terminal: the table of its figures, and all that qualifies them."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence

from rich.table import Table

from robophm.cli.shared.output import console, print_table, table
from robophm.design.robot import Robot
from robophm.health.failures_to_come import FailuresToCome
from robophm.health.plant import Plant
from robophm.health.prognosis import RemainingLife
from robophm.health.report import ComponentHealth, HealthReport
from robophm.health.uncertainty import Interval
from robophm.health.unknown_rates import PartsOfUnknownRate, marked, marks, named
from robophm.health.worn import SeenWear
from robophm.report.failures_to_come import FEW, horizon_text, notes
from robophm.report.failures_to_come import shown as largest
from robophm.report.wear import wear_lines
from robophm.report.words import (
    duration_text,
    more_text,
    number_text,
    percent_text,
    percent_texts,
    probability_text,
    rate_text,
    share_text,
    task_text,
)

COURSE = "λ sensor, recent"
"""Head of the column that shows the recent course of the hazard rate."""


def health_table(
    report: HealthReport, unit: str, *, course: Mapping[str, str] | None = None, without: Collection[str] = ()
) -> Table:
    """Return the figures of a report, both views side by side, ``without`` some columns by their heads.

    Of ``course``'s subjects alone, with it.
    """
    columns = ["", "λ nominal", "λ sensor", "R nominal", "R sensor", "RUL median", "PoTC", COURSE]
    rows = []
    for one in report.subjects:
        if course is not None and one.path not in course:
            continue
        name = one.path if one.kind == "robot" else "  " * (1 + one.path.count("/")) + one.path.rpartition("/")[2]
        life, task = one.sensor_based.remaining_life, one.sensor_based.completion
        rate, works, ahead = marks(one.unknown)
        rows.append([
            name + (" *" if one.flags else ""),
            marked(rate, rate_text(one.nominal.hazard_rate, unit)),
            marked(rate, rate_text(one.sensor_based.hazard_rate, unit)),
            *(works + text for text in percent_texts(*(
                (of.reliability, of.unreliability) for of in (one.nominal, one.sensor_based)
            ))),
            marked(ahead, duration_text(life.median)) if life else "–",
            ahead + percent_text(task.probability, task.failure) if task else "–",
            course[one.path] if course is not None else "",
        ])  # fmt: skip
    kept = [i for i, head in enumerate(columns) if head not in without and (head != COURSE or course is not None)]
    chosen = [[row[i] for i in kept] for row in rows]
    figures = [n for n, i in enumerate(kept) if i and columns[i] != COURSE]
    return table(f"Health of {report.robot}", [columns[i] for i in kept], chosen, figures=figures)


def observed_text(report: HealthReport) -> str:
    """Return how long the robot was observed, by each of its clocks."""
    clocks = {"operating": "h of operation", "calendar": "h in all", "kilometres": "km"}
    lived = ", ".join(f"{number_text(v)} {clocks.get(n, n)}" for n, v in report.clocks.items())
    return f"Observed: {lived if report.time is not None else 'nothing yet; sensor-based is nominal'}"


def mark_lines(report: HealthReport) -> list[str]:
    """Return the lines that say what the stars of the table mean."""
    return [f"* {one.path}: {', '.join(one.marks)}" for one in report.subjects if one.marks]


def print_report(report: HealthReport, unit: str) -> None:
    """Print a report for people: the table, what qualifies it, what is breached."""
    out = console()
    print_table(out, health_table(report, unit))
    out.print(observed_text(report), markup=False)
    out.print("R is survival since new over that time; λ, remaining life and PoTC are given that it works now.")
    robot = report.design
    print_unknown(report.system.unknown, robot)
    print_wear(report.wear, report.outlooks["sensor_based"].plant)
    system = report.system.sensor_based
    left_out = report.system.unknown
    if system.remaining_life:
        print_life(report, system.remaining_life)
    if report.task and system.completion:
        task = task_text(report.task.distance, report.task.duration)
        chance = probability_text(system.completion.probability, system.completion.failure)
        out.print(
            f"Next task ({task}): completed with {left_out.said_ahead(chance) if left_out else chance}", markup=False
        )
    if system.remaining_life:
        print_failures_to_come(report.failures_to_come)
    for line in (*mark_lines(report), *report.notes):
        out.print(line, style="yellow", markup=False)
    for words in report.warnings:
        out.print(f"warning: {words}", style="yellow", markup=False)
    for breach in report.breaches:
        out.print(f"threshold breached: {breach}", style="bold red", markup=False)


def print_life(report: HealthReport, life: RemainingLife) -> None:
    """Print a remaining life as if all were exactly as stated, and with what is unsure."""
    left_out, wanted = report.system.unknown, report.design.thresholds.survival
    if left_out and math.isinf(life.median):
        console().print("Remaining life: unknown, as is the rate of all that can fail", markup=False)
        return

    def said(text: str) -> str:
        return left_out.said_ahead(text) if left_out else text

    spans = {what: _span(interval) for what, interval in _unsure(report) if interval is not None}
    stated = ", at the stated rates" if any("rates" in what for what in spans) else ""
    stated += " and its recent load" if stated and any("load" in what for what in spans) else ""
    out, span = console(), _span(Interval(life.early, life.median, life.late))
    text = said(f"{span}, mean {duration_text(life.mean)}")
    out.print(f"Remaining life (calendar time{stated}): {text}", markup=False, soft_wrap=True)
    for what, text in spans.items():
        out.print(f"  with {what} unsure: {said(text)}", markup=False, soft_wrap=True)
    if life.threshold is not None and wanted is not None:
        text = f"{duration_text(life.threshold)} with {percent_text(wanted)}{stated}"
        out.print(f"Works on for {said(text)}", markup=False)


def _unsure(report: HealthReport) -> Iterator[tuple[str, Interval | None]]:
    """What is not known exactly, all of it first, and how far the remaining life may lie for that."""
    load = "the load (drawn from its past)"
    if (sure := report.uncertainty) is None:
        yield "rates", report.life_with_rates_unsure
    elif sure.of_rates and sure.of_load:
        yield f"rates and {load}", sure.all_sources
        yield "rates alone", sure.load_known
        yield "the load alone", sure.rates_known
    elif sure.of_rates or sure.of_load:
        yield "rates" if sure.of_rates else load, sure.all_sources


def print_unknown(left_out: PartsOfUnknownRate | None, robot: Robot) -> None:
    """Print the effect of parts of unknown rate on the figures, and which they are; nothing where there are none."""
    if left_out:
        console().print(f"{left_out.sentence} ({named(robot)})", style="yellow", markup=False, soft_wrap=True)


def print_wear(seen: Sequence[SeenWear], plant: Plant) -> None:
    """Which parts are seen to wear, and when they reach their thresholds; nothing where none is."""
    if seen:
        console().print("Seen to wear (in sensor-based figures in the place of the mode's hazard):")
    for line, critical in wear_lines(seen, plant):
        console().print(f"  {line}", style="bold red" if critical else "", markup=False, soft_wrap=True)


def print_parts(report: HealthReport) -> None:
    """Print the remaining life of every component, the shortest first."""
    lives = [(part, part.remaining_life) for part in report.components if part.remaining_life]

    def text(part: ComponentHealth, time: float) -> str:
        if not part.unknown:
            return duration_text(time)
        return "unknown" if math.isinf(time) else f"≤ {duration_text(time)}"

    rows = [
        (part.path, *(text(part, time) for time in (life.early, life.median, life.late)))
        for part, life in sorted(lives, key=lambda pair: pair[1].median)
    ]
    title = "Remaining life of each component alone, calendar time"
    print_table(console(), table(title, ("", "5 % by", "median", "95 % by"), rows, figures=(1, 2, 3)))


def print_failures_to_come(found: FailuresToCome, *, both: bool = True) -> None:
    """Print the few parts that bring about most of the failures to come."""
    some = largest(found, FEW)
    if not some:
        return
    views = ("nominal", "sensor-based") if both else ("nominal",)
    rows = [
        [one.path + (f" ×{one.quantity}" if one.quantity > 1 else ""),
         *(share_text(getattr(one, view.replace("-", "_"))) for view in views)]
        for one in some
    ]  # fmt: skip
    title = f"What will fail it: share of the failures {horizon_text(found)}"
    out = console()
    out.print(f"\n{title}", style="bold", markup=False, soft_wrap=True)
    print_table(out, table("", ("", *views), rows, figures=range(1, 1 + len(views))))
    for note in notes(found, some):
        out.print(note)
    if rest := len(found.contributions) - len(some):
        out.print(more_text(rest, "listed"))


def _span(interval: Interval) -> str:
    low, median, high = (duration_text(time) for time in interval)
    return f"median {median}, 90 % between {low} and {high}"
