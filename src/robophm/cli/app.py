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


Legacy = Annotated[bool, typer.Option("--legacy", help="beside the figures of the 2020 tool")]
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
    count = sum(component.quantity for component in robot.all_components()) - len(robot.causes)
    if as_json:
        print_json(
            {
                "robot": robot.name,
                "parts": count,
                "common_causes": len(robot.causes),
                "signals": list(robot.signals),
                "warnings": list(robot.warnings),
            }
        )
        return
    for warning in robot.warnings:
        warn(warning)
    console().print(
        f"{design}: {robot.name} is valid: {len(list(robot.all_modules()))} modules, {count} parts, "
        + (f"{len(robot.causes)} common causes, " if robot.causes else "")
        + f"{len(robot.signals)} signals, {len(robot.warnings)} warnings", markup=False
    )  # fmt: skip


@app.command()
def show(
    design: Design,
    hours: Annotated[float, typer.Option(help="operating hours at which to state λ and R")] = 1000.0,
    unit: Unit = "1/h",
    svg: Annotated[Path | None, typer.Option(help="also draw the diagram into this SVG file")] = None,
    legacy: Legacy = False,
    monte_carlo: Annotated[
        int | None, typer.Option(min=1, max=1_000_000_000, help="only estimate R by so many simulated robots")
    ] = None,
    seed: Annotated[int, typer.Option(help="of --monte-carlo")] = 0,
    as_json: Json = False,
) -> None:
    """Draw a design and state what it promises when new."""
    from robophm.cli.show import draw, estimate, promises, promises_table, svg_diagram
    from robophm.design.file import load
    from robophm.health.report import plain

    if not 0 <= hours < float("inf"):
        raise UnitError(f"--hours {hours:g}: expected a number of at least 0")
    may_write(svg, design)
    robot = load(design)
    if monte_carlo:
        by_chance = estimate(robot, hours, monte_carlo, seed)
        if as_json:
            print_json({"robot": robot.name, "hours": hours, "seed": seed, **asdict(by_chance)})
        else:
            low, high = (f"{one:.6g}" for one in (by_chance.low, by_chance.high))
            console().print(
                f"{robot.name}, new, nominal: R({hours:g} h) = {by_chance.probability:.6g}, with 95 % confidence "
                f"between {low} and {high} ({by_chance.samples:,} simulated)", markup=False, soft_wrap=True
            )  # fmt: skip
        return
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
    taken = [f"{name} '{word}' is taken as {inputs[name]}" for name, word in given.items()
             if isinstance(chosen.inputs[name], Choice) and inputs[name] != word]  # fmt: skip
    result = chosen.explain(inputs)
    answer = float(np.asarray(result.value))
    factors = [(f.symbol, float(np.asarray(f.value)), f.note) for f in result.leaves()]
    if as_json:
        listed = [{"symbol": s, "value": v, "note": n} for s, v, n in factors]
        units = {n: e.unit for n, e in chosen.numbers.items()}
        print_json({"model": chosen.name, "inputs": inputs, "units": units, "hazard_rate": answer, "unit": chosen.unit,
                    "formula": chosen.formula, "source": str(chosen.source), "factors": listed})  # fmt: skip
        return
    shown = rate_text(answer, unit) if chosen.unit == "1/h" else f"{number_text(answer)} {chosen.unit}"
    out.print(f"{chosen.name}: {shown}", markup=False)
    for note in taken:
        out.print(note, markup=False)
    if explain:
        out.print(f"{chosen.formula}\n{chosen.source} ({chosen.source.status})", markup=False)
        for symbol, number, note in factors:
            out.print(f"  {symbol:<6} {number:<12.6g} {note}", markup=False)


@app.command()
def models(
    kind: Annotated[str | None, typer.Argument(help="of part, e.g. motor, 'chip resistor'; none lists all")] = None,
    reference: Annotated[bool, typer.Option("--reference", help="print the reference page, Markdown")] = False,
    as_json: Json = False,
) -> None:
    """The hazard models for a kind of part."""
    from robophm.cli.models import find
    from robophm.cli.models import reference as page

    if reference:
        typer.echo("\n".join(page()))
        return
    found = find(kind)
    if as_json:
        print_json({
            "models": [
                {"name": name, "formula": model.formula, "unit": model.unit, "description": model.description,
                 "source": str(model.source), "status": model.source.status}
                for name, model in found.items()
            ]
        })  # fmt: skip
        return
    rows = [(name, model.formula, f"{model.source} ({model.source.status})") for name, model in found.items()]
    print_table(console(), table("Hazard models and accelerations", ("model", "formula", "source"), rows))


Store_ = Annotated[Path | None, typer.Option("--store", help="the robot's past, as kept by replay")]
Failed = Annotated[list[str] | None, typer.Option(metavar="PART", help="is known to have failed")]
Working = Annotated[list[str] | None, typer.Option(metavar="PART", help="is known to work now")]
Draws = Annotated[int, typer.Option(help="of uncertain rates and loads; 0 for none", min=0, max=100_000)]


MOST_DRAWN = 30_000_000
"""Rates that are drawn in all: ten arrays of so many numbers are 2.4 GB."""


def _affordable(draws: int, robot: Any) -> None:
    most = MOST_DRAWN // max(sum(mode.uncertainty is not None for mode in robot.modes), 1)
    if draws > most:
        raise RobophmError(f"--draws {draws}: too many for so many uncertain rates; expected at most {most}")


def _known_future(name: str) -> str:
    from robophm.core.errors import nearest

    if name not in FUTURES:
        raise typer.BadParameter(f"no future '{name}'{nearest(name, FUTURES)}")
    return name


FUTURES = ("recent", "last", "nominal")
Future_ = Annotated[
    str, typer.Option("--future", help="stress and usage to come: recent, last or nominal", callback=_known_future)
]


@app.command()
def predict(
    design: Design,
    store: Store_ = None,
    distance: Annotated[str | None, typer.Option(help="of the task, e.g. '250 m'")] = None,
    speed: Annotated[str | None, typer.Option(help="of the task, e.g. '0.3 m/s'")] = None,
    duration: Annotated[str | None, typer.Option(help="of the task, instead of a speed, e.g. '20 min'")] = None,
    future: Future_ = "recent",
    plan: Annotated[Path | None, typer.Option(help="tasks.yaml or .csv that it does again and again")] = None,
    failed: Failed = None,
    working: Working = None,
    parts: Annotated[bool, typer.Option("--parts", help="remaining life of every component too")] = False,
    draws: Draws = 2000,
    unit: Unit = "1/h",
    as_json: Json = False,
) -> None:
    """Say what lies ahead: remaining life, task completion."""
    from robophm.cli.output import print_parts
    from robophm.cli.task import with_knowledge
    from robophm.core.units import quantity
    from robophm.design.build_task import plain_task
    from robophm.design.fault import Fault
    from robophm.design.file import load
    from robophm.design.task import Plan
    from robophm.design.task_file import load_plan
    from robophm.health.ledger import Ledger
    from robophm.monitor import Monitor

    robot = load(design)
    _affordable(draws, robot)
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
    tasks = load_plan(plan, robot) if plan else None
    knowledge = with_knowledge(tasks or Plan(()), robot, failed or (), working or ()).knowledge
    monitor = Monitor(robot, _kept(store, robot, Ledger) if store else None)
    chosen: Any = future
    report = monitor.report(task=task, future=chosen, plan=tasks, knowledge=knowledge, draws=draws, parts=parts)
    if as_json:
        print_json(report.to_json())
    else:
        print_report(report, unit)
        if parts:
            print_parts(report)
    if report.breaches:
        raise typer.Exit(BREACHED)


SkipMissing = Annotated[bool, typer.Option("--skip-missing", help="bound topics that are not recorded stay silent")]
Seed = Annotated[int, typer.Option(help="of all that is drawn at random")]


@app.command()
def task(
    design: Design,
    tasks: Annotated[
        Path | None, typer.Argument(help="tasks.yaml, tasks.csv, or a recording; default: the design's task")
    ] = None,
    store: Store_ = None,
    failed: Failed = None,
    working: Working = None,
    future: Future_ = "recent",
    repeat: Annotated[int, typer.Option(help="do the list so often, one after the other", min=1, max=1_000_000)] = 1,
    threshold: Annotated[float | None, typer.Option(help="for --repeat; default the design's", min=0, max=1)] = None,
    draws: Draws = 2000,
    seed: Seed = 0,
    topic: Annotated[
        list[str] | None, typer.Option(help="of a recording: what tells of tasks, or where the robot was")
    ] = None,
    speed: Annotated[str | None, typer.Option(help="of a recording's planned legs that state none")] = None,
    function: Annotated[list[str] | None, typer.Option(help="that a recording's tasks need")] = None,
    skip_missing: SkipMissing = False,
    legacy: Legacy = False,
    as_json: Json = False,
) -> None:
    """Say whether a robot can do its tasks: the probability that each will be completed, and what decides it."""
    from robophm.cli import task_recording
    from robophm.cli.task import Question, run, with_knowledge
    from robophm.core.errors import nearest
    from robophm.core.units import quantity
    from robophm.design.file import load
    from robophm.design.task import Plan
    from robophm.design.task_file import load_plan
    from robophm.health.ledger import Ledger
    from robophm.transports.recording import SUFFIXES, Recording

    robot = load(design)
    _affordable(draws, robot)
    chosen: Any = future
    if unknown := [name for name in function or () if name not in robot.functions]:
        raise RobophmError(f"no function '{unknown[0]}'{nearest(unknown[0], robot.functions)}")
    ledger = _kept(store, robot, Ledger) if store else None
    if tasks is not None and (tasks.is_dir() or tasks.suffix.lower() in SUFFIXES):
        listed = {"--repeat": repeat != 1, "--threshold": threshold is not None, "--future": future != "recent"}
        if given := [name for name, stated in listed.items() if stated]:
            raise RobophmError(f"{given[0]} is of a list of tasks; {tasks} is a recording")
        knowledge = with_knowledge(Plan(()), robot, failed or (), working or ()).knowledge
        at = quantity(speed, "m/s") if speed is not None else None
        if at is not None and not at > 0:
            raise UnitError(f"--speed {speed}: expected above zero")
        with Recording(tasks) as source:
            breached = task_recording.run(
                robot, ledger, source, topic or (), speed=at, functions=function or (), knowledge=knowledge,
                skip_missing=skip_missing, legacy=legacy, as_json=as_json,
            )  # fmt: skip
    else:
        if tasks is None and robot.task is None:
            raise RobophmError(f"{design}: has no task; expected one in it, or a tasks file")
        if given := [
            name for name, value in (("--topic", topic), ("--speed", speed), ("--function", function)) if value
        ]:
            raise RobophmError(f"{given[0]} is of a recording; expected a .bag, .db3 or .mcap with it")
        if threshold is not None and repeat == 1:
            raise RobophmError("--threshold is of --repeat; of single tasks it is the design's")
        plan = load_plan(tasks, robot) if tasks else Plan((robot.task,) if robot.task else ())
        plan = with_knowledge(plan, robot, failed or (), working or ())
        question = Question(plan, chosen, repeat, threshold, draws, seed, legacy)
        breached = run(robot, ledger, question, as_json=as_json)
    if breached:
        raise typer.Exit(BREACHED)


@app.command()
def replay(
    design: Design,
    recordings: Annotated[list[Path], typer.Argument(help=".bag, .db3, .mcap, rosbag2 folders, a .csv or a .journal")],
    store: Annotated[
        Path | None, typer.Option(help="keep the robot's past in this SQLite file, and go on from it")
    ] = None,
    report: Annotated[Path | None, typer.Option(help="write a page about its health, HTML")] = None,
    skip_missing: SkipMissing = False,
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


@app.command("import-bom")
def import_bom(
    source: Annotated[Path, typer.Argument(help="the parts list", metavar="PARTS.CSV|XLSX|ODS")],
    design: Annotated[
        Path, typer.Argument(help="the design to make, or to bring up to the list", metavar="ROBOT.YAML")
    ],
    module: Annotated[
        str | None, typer.Option(help="where they belong, e.g. 'Power/Motor board'; default the robot")
    ] = None,
    mapping: Annotated[Path | None, typer.Option(help="what the columns mean, as --save-mapping wrote it")] = None,
    save_mapping: Annotated[Path | None, typer.Option(help="write what the columns were taken for")] = None,
    environment: Annotated[str | None, typer.Option(help="symbol; default the design's, or GM: ground, mobile")] = None,
    temperature: Annotated[str, typer.Option(help="around the parts")] = "40 degC",
    stress: Annotated[float, typer.Option(help="applied by rated voltage or power", min=0, max=1)] = 0.5,
    quality: Annotated[str | None, typer.Option(help="level; default each model's own")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="say what would be done, and write no design")] = False,
    as_json: Json = False,
) -> None:
    """Put the parts of a list into a design, rated where enough is known, and say what was assumed."""
    from robophm.cli.import_bom import Wishes, run

    wishes = Wishes(module, mapping, save_mapping, environment, temperature, stress, quality, dry_run, as_json)
    run(source, design, wishes)


@app.command("import-legacy")
def import_legacy(
    source: Annotated[Path, typer.Argument(help="phm_configurations_*.yaml of the 2020 tool", metavar="SOURCE.YAML")],
    design: Annotated[Path, typer.Argument(help="the design file to write", metavar="ROBOT.YAML")],
    force: Annotated[bool, typer.Option("--force", help="also where that file exists")] = False,
    as_json: Json = False,
) -> None:
    """Make a design of a file of the 2020 tool, and say what is odd in it."""
    from robophm.cli.import_legacy import run

    run(source, design, force=force, as_json=as_json)


@app.command()
def calibrate(
    predictions: Annotated[
        Path,
        typer.Argument(
            help="what was predicted and what happened, or a fleet's folder", metavar="PREDICTIONS.CSV|FLEET"
        ),
    ],
    report: Annotated[Path | None, typer.Option(help="write a page about it, HTML")] = None,
    controls: Annotated[
        bool, typer.Option("--controls", help="of a fleet: also models that are wrong, which must be found out")
    ] = False,
    jobs: Annotated[int, typer.Option(help="of a fleet: processes that share the work", min=1, max=256)] = 1,
    as_json: Json = False,
) -> None:
    """Say whether predictions were honest."""
    from robophm.calibration.fleet import files
    from robophm.calibration.predictions import read_predictions
    from robophm.calibration.score import score
    from robophm.cli.calibrate import breached, of_fleet, print_calibration
    from robophm.report.calibration_page import calibration_page

    if predictions.is_dir():
        may_write(report, *files(predictions))
        said = of_fleet(predictions, controls=controls, jobs=jobs)
    else:
        if controls:
            raise RobophmError("--controls is of a fleet's folder; a file has the models that it has")
        may_write(report, predictions)
        said = read_predictions(predictions)
    calibration = score(said)
    if report:
        write(report, calibration_page(calibration, predictions.name))
    if as_json:
        print_json(calibration.to_json())
    else:
        print_calibration(console(), calibration)
        if report:
            console().print(f"Report: {report}", markup=False)
    if breached(calibration):
        raise typer.Exit(BREACHED)


Order = Annotated[int | None, typer.Option(help="list the sets of at most so many parts, smallest first", min=1)]
At = Annotated[float, typer.Option(help="operating hours of a new robot at which to state probabilities", min=0)]
Most = Annotated[int, typer.Option(help="sets to list", min=1, max=100_000)]


@app.command()
def cutsets(
    design: Design,
    function: Annotated[str | None, typer.Option(help="of the robot; default the whole robot")] = None,
    order: Order = None,
    paths: Annotated[
        bool, typer.Option("--paths", help="what is enough to work, in place of what is enough to fail")
    ] = False,
    at: At = 1000.0,
    most: Most = 20,
    as_json: Json = False,
) -> None:
    """The smallest sets of parts whose failure fails a robot, the likeliest first."""
    from robophm.cli.fault_tree import cut_sets, of_robot
    from robophm.design.file import load

    cut_sets(of_robot(load(design), function, at), paths=paths, order=order, most=most, as_json=as_json)


@app.command("fault-tree")
def fault_tree(
    source: Annotated[
        Path, typer.Argument(help="an Open-PSA model, or a robot's design", metavar="MODEL.XML|ROBOT.YAML")
    ],
    function: Annotated[str | None, typer.Option(help="of a robot; default the whole robot")] = None,
    top: Annotated[str | None, typer.Option(help="gate of a model of which several are used by no other")] = None,
    time: Annotated[float | None, typer.Option(help="mission time, or of a new robot [h of operation]", min=0)] = None,
    order: Order = None,
    most: Most = 20,
    to: Annotated[Path | None, typer.Option(help="write the tree: as a model, .xml, or a design, .yaml")] = None,
    as_json: Json = False,
) -> None:
    """The probability of a fault tree's top event, and its minimal cut sets; of a robot, also its fault tree."""
    from robophm.cli.fault_tree import is_design, of_model, of_robot, tree
    from robophm.design.file import load

    may_write(to, source)
    if is_design(source):
        if top is not None:
            raise RobophmError("--top is of a model; of a robot it is --function")
        system = of_robot(load(source), function, 1000.0 if time is None else time)
    else:
        if function is not None:
            raise RobophmError("--function is of a robot; of a model it is --top")
        system = of_model(source, time, top)
    tree(system, order=order, most=most, to=to, as_json=as_json)


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
def simulate(
    design: Design,
    output: Annotated[Path, typer.Option(help="folder for the fleet; must not exist, or be empty")],
    robots: Annotated[int, typer.Option(help="how many")] = 20,
    tasks: Annotated[int, typer.Option(help="that each of them does, and the rest of that round of its plan")] = 10,
    seed: Annotated[int | None, typer.Option(help="writes the same fleet again; default: a fresh one")] = None,
    uncertain_rates: Annotated[
        bool, typer.Option("--uncertain-rates", help="each robot draws its true rates from the design's uncertainty")
    ] = False,
    as_json: Json = False,
) -> None:
    """Let robots of a design work and really fail: their recordings, tasks and failures."""
    from robophm.cli.simulate import run

    run(design, output, robots, tasks, seed, uncertain_rates=uncertain_rates, as_json=as_json)


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
