"""``robophm why``: what decides a robot's health, and what would restore it."""

from __future__ import annotations

from dataclasses import asdict

import typer

from robophm.cli import BREACHED
from robophm.cli.shared.options import Design, Future, Horizon, Json, Store, horizon_of
from robophm.cli.shared.output import console, print_json
from robophm.cli.shared.stored_past import kept
from robophm.core.json_values import plain
from robophm.design.file import load
from robophm.health.outlooks import FutureName
from robophm.health.why import explain
from robophm.monitoring.monitor import Monitor
from robophm.monitoring.stress_since import with_since
from robophm.report.why import reasons, sentence
from robophm.stores import existing_store


def command(
    design: Design, store: Store = None, future: Future = "recent", horizon: Horizon = None, as_json: Json = False
) -> None:
    """Explain a robot's health: what decides it, and what would restore it."""
    robot = load(design)
    chosen: FutureName = future
    monitor = Monitor(robot, kept(store, robot) if store else None)
    report = monitor.report(future=chosen, horizon=horizon_of(horizon))
    found = explain(report)
    if store:
        with existing_store(store) as opened:
            found = with_since(found, opened.history(robot.identity), report.time)
    if as_json:
        said = {"robot": robot.name, "time": report.time, "sentence": sentence(report, found), "state": report.state}
        limits = {"breaches": list(report.breaches), "warnings": list(report.warnings)}
        print_json({"schema_version": 1, **said, **plain(asdict(found)), **limits})
    else:
        out = console()
        out.print(sentence(report, found), markup=False)
        for line in (*report.breaches, *report.warnings, *reasons(found)):
            out.print(line, markup=False)
    if report.breaches:
        raise typer.Exit(BREACHED)
