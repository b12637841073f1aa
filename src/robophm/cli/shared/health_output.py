"""A robot's health on a terminal: the table of its figures, and all that qualifies them."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence

from rich.table import Table

from robophm.cli.shared.output import console, print_table, table
from robophm.design.robot import Robot
from robophm.health.failures_to_come import FailuresToCome
from robophm.health.plant import Plant
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
        life = system.remaining_life
        span = f"90 % between {duration_text(life.early)} and {duration_text(life.late)}"
        said = f"median {duration_text(life.median)}, mean {duration_text(life.mean)}, {span}"
        out.print(f"Remaining life (calendar time): {left_out.said_ahead(said) if left_out else said}", markup=False)
        wanted = robot.thresholds.survival
        if life.threshold is not None and wanted is not None:
            said = f"{duration_text(life.threshold)} with {percent_text(wanted)}"
            out.print(f"Works on for {left_out.said_ahead(said) if left_out else said}", markup=False)
    if sure := report.uncertainty:
        both = (("rates", sure.of_rates), ("the load (drawn from its past)", sure.of_load))
        unsure = [name for name, is_it in both if is_it]
        spans = [(f"with {' and '.join(unsure)} unsure", sure.all_sources)] if unsure else []
        if sure.of_rates and sure.of_load:
            spans.append(("if rates were known exactly", sure.rates_known))
            spans.append(("if the load stayed as it was recently", sure.load_known))
        for what, interval in spans:
            said = _span(interval)
            out.print(f"  {what}: {left_out.said_ahead(said) if left_out else said}", markup=False)
    if report.task and system.completion:
        task = f"{number_text(report.task.distance)} m in {duration_text(report.task.duration)}"
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
