"""The commands."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from robophm.cli import BREACHED
from robophm.cli.output import (
    console,
    json_text,
    may_write,
    print_json,
    print_report,
    print_table,
    progress_console,
    table,
    warn,
    write,
)
from robophm.core.errors import ModelError, RobophmError, UnitError
from robophm.report.words import number_text, rate_text

app = typer.Typer(
    help="The honest health of a robot: hazard rate, reliability, remaining life and task completion.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _version(wanted: bool) -> None:
    if wanted:
        from importlib.metadata import version

        typer.echo(version("robophm"))
        raise typer.Exit


@app.callback()
def robophm(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="print it and end")
    ] = False,
) -> None:
    """The honest health of a robot: hazard rate, reliability, remaining life and task completion."""


Design = Annotated[Path, typer.Argument(help="the robot's design file", metavar="ROBOT.YAML")]
Json = Annotated[bool, typer.Option("--json", help="print one JSON document on stdout")]


def _known_unit(unit: str) -> str:
    try:
        rate_text(0.0, unit)
    except UnitError as error:
        raise typer.BadParameter(str(error)) from None
    return unit


Unit = Annotated[str, typer.Option(help="of hazard rates: 1/h, FIT or FPMH", callback=_known_unit)]


@app.command()
def check(design: Design, as_json: Json = False) -> None:
    """Say whether a design is valid, and what in it is odd."""
    from robophm.design.file import load

    robot = load(design)
    count = sum(component.quantity for component in robot.all_components())
    if as_json:
        print_json(
            {
                "robot": robot.name,
                "parts": count,
                "signals": list(robot.signals),
                "warnings": list(robot.warnings),
            }
        )
        return
    for warning in robot.warnings:
        warn(warning)
    console().print(
        f"{design}: {robot.name} is valid: {len(list(robot.all_modules()))} modules, {count} parts, "
        f"{len(robot.signals)} signals, {len(robot.warnings)} warnings", markup=False
    )  # fmt: skip


@app.command()
def show(
    design: Design,
    hours: Annotated[float, typer.Option(help="operating hours at which to state λ and R")] = 1000.0,
    unit: Unit = "1/h",
    svg: Annotated[Path | None, typer.Option(help="also draw the diagram into this SVG file")] = None,
    legacy: Annotated[bool, typer.Option("--legacy", help="beside the figures of the 2020 tool")] = False,
    as_json: Json = False,
) -> None:
    """Draw a design and state what it promises when new."""
    from robophm.cli.show import draw, promises, promises_table, svg_diagram
    from robophm.design.file import load
    from robophm.health.report import plain

    if not 0 <= hours < float("inf"):
        raise UnitError(f"--hours {hours:g}: expected a number of at least 0")
    may_write(svg, design)
    robot = load(design)
    found = promises(robot, hours, legacy=legacy)
    if svg:
        write(svg, svg_diagram(robot, unit))
    if as_json:
        print_json({"robot": robot.name, "hours": hours, "modules": [plain(asdict(one)) for one in found]})
        return
    out = console()
    draw(out, robot, unit)
    print_table(out, promises_table(robot, found, hours, unit))


@app.command()
def rate(
    model: Annotated[str | None, typer.Argument(help="e.g. mil_hdbk_217f.capacitor; none lists them")] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="INPUT=VALUE", help="e.g. temperature='60 degC'")
    ] = None,
    explain: Annotated[bool, typer.Option("--explain", help="show every factor")] = False,
    unit: Unit = "1/h",
    as_json: Json = False,
) -> None:
    """The hazard rate that a handbook gives for a part."""
    import numpy as np

    from robophm.hazard.handbooks import handbook_model, handbook_models
    from robophm.hazard.model import Choice

    out = console()
    if model is None:
        models = [(name, handbook_model(name)) for name in handbook_models()]
        if as_json:
            print_json({"models": [{"name": n, "formula": m.formula, "source": str(m.source)} for n, m in models]})
        else:
            rows = [(n, m.formula, str(m.source)) for n, m in models]
            print_table(out, table("Hazard models", ("model", "formula", "source"), rows))
        return
    chosen = handbook_model(model)
    given = {}
    for pair in set_ or []:
        name, equals, value = (word.strip() for word in pair.partition("="))
        if not equals:
            raise ModelError(f"--set {pair}: expected INPUT=VALUE")
        if name in given:
            raise ModelError(f"--set {pair}: '{name}' is given twice")
        given[name] = value
    if not given and any(
        getattr(entry, "required", True) and entry.default is None for entry in chosen.inputs.values()
    ):
        takes = [
            (name, chosen.expected(name), "" if e.default is None else str(e.default), e.description)
            for name, e in chosen.inputs.items()
        ]
        if as_json:
            keys = ("name", "expected", "default", "description")
            print_json({"model": chosen.name, "unit": chosen.unit, "formula": chosen.formula,
                        "source": str(chosen.source),
                        "inputs": [dict(zip(keys, row, strict=True)) for row in takes]})  # fmt: skip
            return
        out.print(f"{chosen.name}: {chosen.formula}\n{chosen.source}", markup=False)
        for name, expected, default, description in takes:
            out.print(
                f"  {name}: {description}; {expected}" + (f"; default {default}" if default else ""),
                markup=False,
            )
        return
    inputs = chosen.settle(given)
    result = chosen.explain(inputs)
    answer = float(np.asarray(result.value))
    factors = [(f.symbol, float(np.asarray(f.value)), f.note) for f in result.leaves()]
    if as_json:
        listed = [{"symbol": s, "value": v, "note": n} for s, v, n in factors]
        units = {n: e.unit for n, e in chosen.inputs.items() if not isinstance(e, Choice)}
        print_json({"model": chosen.name, "inputs": inputs, "units": units, "hazard_rate": answer, "unit": chosen.unit,
                    "formula": chosen.formula, "source": str(chosen.source), "factors": listed})  # fmt: skip
        return
    shown = rate_text(answer, unit) if chosen.unit == "1/h" else f"{number_text(answer)} {chosen.unit}"
    out.print(f"{chosen.name}: {shown}", markup=False)
    if explain:
        out.print(f"{chosen.formula}\n{chosen.source} ({chosen.source.status})", markup=False)
        for symbol, number, note in factors:
            out.print(f"  {symbol:<6} {number:<12.6g} {note}", markup=False)


@app.command()
def predict(
    design: Design,
    store: Annotated[Path | None, typer.Option(help="the robot's past, as kept by replay")] = None,
    distance: Annotated[str | None, typer.Option(help="of the task, e.g. '250 m'")] = None,
    speed: Annotated[str | None, typer.Option(help="of the task, e.g. '0.3 m/s'")] = None,
    duration: Annotated[str | None, typer.Option(help="of the task, instead of a speed, e.g. '20 min'")] = None,
    unit: Unit = "1/h",
    as_json: Json = False,
) -> None:
    """Say what lies ahead: remaining life, task completion."""
    from robophm.core.units import quantity
    from robophm.design.build import Fault, plain_task
    from robophm.design.file import load
    from robophm.health.exposure import Ledger
    from robophm.monitor import Monitor

    robot = load(design)
    task = robot.task
    if (distance, speed, duration) != (None, None, None):
        try:
            task = plain_task(
                quantity(distance, "m") if distance is not None else None,
                quantity(speed, "m/s") if speed is not None else None,
                quantity(duration, "h") if duration is not None else None,
            )
        except Fault as fault:
            raise RobophmError(f"task: {fault}") from None
    monitor = Monitor(robot, _kept(store, robot, Ledger) if store else None)
    report = monitor.report(task=task)
    if as_json:
        print_json(report.to_json())
    else:
        print_report(report, unit)
    if report.breaches:
        raise typer.Exit(BREACHED)


@app.command()
def replay(
    design: Design,
    recordings: Annotated[list[Path], typer.Argument(help=".bag, .db3, .mcap, rosbag2 folders, a .csv or a .journal")],
    store: Annotated[
        Path | None, typer.Option(help="keep the robot's past in this SQLite file, and go on from it")
    ] = None,
    report: Annotated[Path | None, typer.Option(help="write a page about its health, HTML")] = None,
    skip_missing: Annotated[
        bool, typer.Option("--skip-missing", help="bound topics that are not recorded stay silent")
    ] = False,
    unit: Unit = "1/h",
    as_json: Json = False,
) -> None:
    """A robot's health after what it recorded."""
    from robophm.design.file import load
    from robophm.monitor import available, recording_key
    from robophm.monitor import replay as replay_recording
    from robophm.report.health_page import health_page
    from robophm.stores.memory import MemoryStore
    from robophm.stores.sqlite import SqliteStore
    from robophm.stores.store import Store
    from robophm.transports.source import open_source

    may_write(report, design, *recordings, *([store] if store else []))
    robot = load(design)
    for warning in robot.warnings:
        warn(warning)
    with open_source(*recordings) as source:
        signals = available(robot, source, skip_missing=skip_missing)  # before a store is made for it
        # Without a store the course is kept only for a page that shows it: its reports cost time.
        kept: Store | None = SqliteStore(store) if store else MemoryStore() if report else None
        with kept or nullcontext(), _progress(source, "replaying") as tick:
            if kept and kept.progress(robot.name, recording_key(source, signals)).complete:
                warn(f"this recording is already in {store}; it is not counted again")
            health = replay_recording(robot, source, store=kept, skip_missing=skip_missing, on_tick=tick)
            history = list(kept.history(robot.name)) if kept and report else []
    if report:
        write(report, health_page(robot, health, history))
    if as_json:
        print_json(health.to_json())
    else:
        print_report(health, unit)
        if report:
            console().print(f"Report: {report}", markup=False)
    if health.breaches:
        raise typer.Exit(BREACHED)


@app.command()
def schema() -> None:
    """Print the JSON Schema of the design file."""
    from robophm.design.schema import json_schema

    typer.echo(json_text(json_schema()))


@app.command()
def demo(
    output: Annotated[Path, typer.Option(help="folder for the recording, the store and the report")] = Path(
        "robophm-demo"
    ),
    seed: Annotated[int, typer.Option(help="of the synthetic robot")] = 1,
) -> None:
    """Watch a synthetic robot work for a day."""
    from robophm.cli.demo import run

    run(output, seed)


@app.command()
def doctor(as_json: Json = False) -> None:
    """Say what is installed here and whether it works."""
    from robophm.cli.doctor import run

    run(as_json=as_json)


def _kept(path: Path, robot: Any, ledger: Any) -> Any:
    from robophm.core.errors import StoreError
    from robophm.stores.sqlite import SqliteStore

    if not path.exists():
        raise StoreError(f"{path}: no such store; `robophm replay --store` makes it")
    with SqliteStore(path) as store:
        data = store.ledger(robot.name)
    if data is None:
        raise StoreError(f"{path}: knows no robot '{robot.name}'")
    return ledger.of(robot, data)


def _progress(source: Any, what: str) -> Any:
    from robophm.cli.progress import progress

    return progress(progress_console(), source, what)
