"""A robot's health on one page: figures, diagram, curves, tables, assumptions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from datetime import UTC, datetime
from itertools import chain
from typing import Any

import numpy as np

from robophm.core.signal import SECOND
from robophm.design.robot import Robot
from robophm.health.curve_span import curve_span
from robophm.health.report import HealthReport
from robophm.health.subject import Figures, Subject
from robophm.health.unknown_rates import marked, marks, named
from robophm.health.why import explain
from robophm.monitoring.told_past import ToldPast
from robophm.report.basis import made_of, sensors
from robophm.report.curve import Line, curve_svg
from robophm.report.dependence import dependence
from robophm.report.diagram_svg import diagram_svg
from robophm.report.doubts import doubts_drawn
from robophm.report.failures_to_come import contributors
from robophm.report.importance import matters, replace_first
from robophm.report.labels import part_labels
from robophm.report.markup import Html
from robophm.report.minimal_sets import what_it_takes_to_fail
from robophm.report.outline import Label
from robophm.report.page import figure, page, section, side_by_side, table_html, tile, tiles
from robophm.report.past_curves import VIEWS, past_curves
from robophm.report.style import Tone
from robophm.report.trends import trends
from robophm.report.wear import wear_curves, wear_table
from robophm.report.why import reasons, sentence
from robophm.report.words import (
    duration_text,
    number_text,
    odds_text,
    percent_text,
    percent_texts,
    rate_text,
    task_text,
)
from robophm.stores.figures import FigureSeries

PAST = ("hazard_rate", "unreliability")
"""The figures whose past is drawn."""


def health_page(
    robot: Robot,
    report: HealthReport,
    past: ToldPast | None = None,
    ledger: Mapping[str, Any] | None = None,
    *,
    short: bool = False,
) -> Html:
    """The whole page as HTML. ``past``: what a store tells beside it; ``ledger``, as JSON, is what the report was
    made of; ``short``: what is well or not, why, and what to do, without all that it follows from.
    """
    found = past.why if past else explain(report)
    head = (sentence(report, found), _summary(report), _tiles(report))
    changed = [*trends(past.day, past.month)] if past else []
    why = section("Why", *reasons(found)), section("What has changed", *changed) if changed else ""
    act = (
        section("What will fail it", *contributors(report.failures_to_come, report.components)),
        section("What to replace first", *replace_first(robot, report.outlooks, report.task)),
    )
    made = section("What this report is made of", made_of(robot, ledger, past.series if past else None))
    whole = () if short else _evidence(robot, report, past.series if past else None, ledger)
    body = (*head, *why, *act, *whole, made)
    return page(f"Health of {report.robot}", (one for one in body if one))


def _evidence(
    robot: Robot, report: HealthReport, series: FigureSeries | None, ledger: Mapping[str, Any] | None
) -> Iterable[Html | str]:
    """Sections on what the health follows from."""
    label = _labels(robot, report)
    levels = [("", robot), *((module.path, module) for module in robot.modules)]
    wiring = (
        (figure(diagram_svg(level.wiring, label), path or "Modules of the robot", True), *dependence(robot, path))
        for path, level in levels
    )
    yield section("How it is wired", *chain.from_iterable(wiring))
    past = past_curves(report.robot, series, PAST) if series else ()
    yield section("Curves", side_by_side(*past, *_outlook_curves(robot, report)))
    yield section("Modules", _subject_table(report.subjects))
    if report.wear:
        drawn = wear_curves(robot, report.wear, ledger) if ledger else ()
        table = wear_table(report.wear, report.outlooks["sensor_based"].plant)
        yield section("What is seen to wear", *table, *drawn)
    yield section("What it takes to fail", *what_it_takes_to_fail(robot, report))
    life = report.system.sensor_based.remaining_life
    yield section("What matters most", *matters(robot, report.outlooks, life.median if life else 0.0))
    whole = "Every sample was taken, and every signal was there."
    told = report.notes or (whole if report.time is not None else "Nothing has been observed yet.",)
    yield section("Sensors and data", *sensors(robot), *told, *doubts_drawn(report.doubts))
    yield section("Assumptions", *_assumptions(robot))


def _summary(report: HealthReport) -> str:
    parts = [f"{number_text(report.clocks['operating'])} h of operation in {number_text(report.clocks['calendar'])} h"]
    units = {"kilometres": "km", "cycles": "cycles", "starts": "starts"}
    parts += [f"{number_text(report.clocks[name])} {unit}" for name, unit in units.items() if name in report.clocks]
    at = f", up to {_clock(report.time)}" if report.time is not None else ""
    silent = f" What is sensor-based {report.system.silence}." if report.system.silence else ""
    return "Observed: " + ", ".join(parts) + at + "." + silent


def _clock(time: int) -> str:
    return datetime.fromtimestamp(time // SECOND, UTC).strftime("%Y-%m-%d %H:%M:%S UTC")


def _tiles(report: HealthReport) -> Html:
    system = report.system
    both = {VIEWS[view]: getattr(system, view) for view in VIEWS}
    tone: Tone | None = report.state if report.state != "ok" or report.design.limited else None
    rate, works, ahead = marks(system.unknown)
    each = [
        tile(
            "Hazard rate now",
            _each(both, lambda f: marked(rate, rate_text(f.hazard_rate))),
            "per hour of operation",
            tone,
        ),
        tile(
            "Reliability",
            dict(zip(both, (works + one for one in _reliabilities(*both.values())), strict=True)),
            _odds("survival since new", system.sensor_based.unreliability),
            tone,
        ),
    ]
    if system.nominal.remaining_life:
        lives = {
            name: marked(ahead, duration_text(f.remaining_life.median)) for name, f in both.items() if f.remaining_life
        }
        late = system.sensor_based.remaining_life
        span = f"90 % between {duration_text(late.early)} and {duration_text(late.late)}" if late else ""
        if late and (unsure := report.life_with_rates_unsure):
            low, high = duration_text(unsure.low), duration_text(unsure.high)
            span += f" at the stated rates, between {low} and {high} with rates unsure"
        note = f"median; {system.unknown.said_ahead(span) if system.unknown else span}" if span else ""
        each.append(tile("Remaining life", lives, note, tone))
    if report.task and system.nominal.completion:
        texts = {
            n: ahead + percent_text(f.completion.probability, f.completion.failure)
            for n, f in both.items()
            if f.completion
        }
        task = task_text(report.task.distance, report.task.duration)
        after = system.sensor_based.completion
        what = _odds(task, after.failure if after else 0.0)
        each.append(tile("Next task completed", texts, what, tone))
    told: dict[str, tuple[str, ...]] = {
        "Thresholds breached": report.breaches, "Thresholds of a warning passed": report.warnings
    }  # fmt: skip
    if system.unknown:
        told["Parts of unknown rate"] = (
            f"{system.unknown.sentence} ({named(report.outlooks['sensor_based'].plant.robot)}).",
        )
    return Html("".join((tiles(*each), *(section(title, *words) for title, words in told.items() if words))))


def _odds(what: str, failure: float) -> str:
    return ", ".join(filter(None, (what, odds_text(failure))))


def _each(figures: Mapping[str, Figures], text: Callable[[Figures], str]) -> dict[str, str]:
    return {name: text(figures_) for name, figures_ in figures.items()}


def _reliabilities(nominal: Figures, sensor_based: Figures) -> tuple[str, str]:
    return percent_texts(*((one.reliability, one.unreliability) for one in (nominal, sensor_based)))


def _labels(robot: Robot, report: HealthReport) -> Callable[[str], Label]:
    rates = {subject.path: subject.sensor_based.hazard_rate for subject in report.subjects}
    rates |= {component.path: component.sensor_based_hazard_rate for component in report.components}
    return part_labels(
        robot, rates, stale=[one.path for one in report.subjects if one.stale],
        unknown={one.path: marks(one.unknown)[0] for one in report.subjects},
    )  # fmt: skip


def _outlook_curves(robot: Robot, report: HealthReport) -> Iterable[Html]:
    lives = [getattr(report.system, view).remaining_life for view in VIEWS]
    hours = np.linspace(0, curve_span(lives, robot.usage.operating), 241)
    states = {view: report.outlooks[view].survival_curve(robot.diagram, hours) for view in ("nominal", "sensor_based")}
    lines = [Line(VIEWS[v], hours, s.works, dashed=v == "sensor_based") for v, s in states.items()]
    yield figure(
        curve_svg(lines, title="Reliability ahead", x_label="operating hours from now", y_label="R"),
        "Survival since new, if use goes on as in the last ten minutes (sensor-based) or as designed (nominal)",
    )
    ahead = ((view, outlook.hazard_curve(robot.diagram, hours)) for view, outlook in report.outlooks.items())
    rates = [Line(VIEWS[v], hours, rate, dashed=v == "sensor_based") for v, rate in ahead]
    yield figure(
        curve_svg(
            rates,
            title="Hazard rate ahead",
            x_label="operating hours from now",
            y_label="λ = f/R [1/h of operation]",
        ),
        "Of survivors since new",
    )


def _subject_table(subjects: Iterable[Subject]) -> Html:
    rows = []
    for one in subjects:
        nominal, lived = one.nominal, one.sensor_based
        life, task = lived.remaining_life, lived.completion
        rate, works, ahead = marks(one.unknown)
        rows.append((
            one.path, marked(rate, number_text(nominal.hazard_rate)), marked(rate, number_text(lived.hazard_rate)),
            *(works + text for text in _reliabilities(nominal, lived)),
            marked(ahead, duration_text(life.median)) if life else None,
            ahead + percent_text(task.probability, task.failure) if task else None,
            ", ".join(one.marks) or None,
        ))  # fmt: skip
    columns = ["", "λ nominal [1/h]", "λ sensor [1/h]", "R nominal", "R sensor", "RUL median", "PoTC", "flags"]
    shown = len(columns) if any(row[-1] for row in rows) else len(columns) - 1
    caption = "sensor: sensor-based; RUL and PoTC are, given that the module works now"
    return table_html(columns[:shown], [row[:shown] for row in rows], caption, "lrrrrrrl"[:shown])


def _assumptions(robot: Robot) -> Iterable[str]:
    usage = robot.usage
    yield (
        "Nominal: every part at its design stress. Sensor-based: exposure from the signals, the future as the last "
        f"ten minutes. The robot works {100 * usage.operating:.0f} % of the day; remaining life is in calendar time, "
        "without repair."
    )
    yield "R is survival since new. Hazard rate, remaining life and task completion are given that the robot works now."
