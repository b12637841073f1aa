"""The commands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import typer
import typer.core

from robophm.cli import BREACHED, EXIT_CODES, NotOursError
from robophm.cli.data import data
from robophm.cli.field import COMMANDS
from robophm.cli.output import Horizon, Json, horizon_of, json_text, may_write
from robophm.cli.page import PAGE_COMMANDS
from robophm.cli.store import store
from robophm.core.errors import UnitError
from robophm.report.words import rate_text


class _Commands(typer.core.TyperGroup):
    """Lets no library decide the exit code: typer makes 1 of these two, whoever raised them."""

    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except (EOFError, BrokenPipeError) as error:
            raise NotOursError from error


app = typer.Typer(
    cls=_Commands,
    help="The honest health of a robot: hazard rate, reliability, remaining life and task completion.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


app.add_typer(data, name="data")
app.add_typer(store, name="store")
for _command in (*COMMANDS, *PAGE_COMMANDS):
    app.command()(_command)


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


Ros = Annotated[str, typer.Option("--ros", help="auto, 1 or 2: which ROS; auto says what it takes and why")]


def _known_unit(unit: str) -> str:
    try:
        rate_text(0.0, unit)
    except UnitError as error:
        raise typer.BadParameter(str(error)) from None
    return unit


def _leave(breached: bool) -> None:
    """With the exit code that says so, where a threshold is breached."""
    if breached:
        raise typer.Exit(BREACHED)


Unit = Annotated[str, typer.Option(help="of hazard rates: 1/h, FIT or FPMH", callback=_known_unit)]

Chance = Annotated[int, typer.Option(help="seed of --monte-carlo", min=0)]


@app.command()
def check(design: Design, as_json: Json = False) -> None:
    """Say whether a design is valid, and what in it is odd."""
    from robophm.cli.check import run

    run(design, as_json=as_json)


@app.command()
def show(
    design: Design,
    hours: Annotated[float, typer.Option(help="operating hours at which to state λ and R")] = 1000.0,
    unit: Unit = "1/h",
    svg: Annotated[Path | None, typer.Option(help="also draw the diagram into this SVG file")] = None,
    horizon: Horizon = None,
    legacy: Legacy = False,
    monte_carlo: Annotated[
        int | None, typer.Option(min=1, max=1_000_000_000, help="only estimate R by so many simulated robots")
    ] = None,
    seed: Chance = 0,
    as_json: Json = False,
) -> None:
    """Draw a design and state what it promises when new."""
    from robophm.cli.show import estimated, shown

    if monte_carlo:
        estimated(design, hours, monte_carlo, seed, as_json=as_json)
    else:
        shown(design, hours, unit, svg, horizon_of(horizon), legacy=legacy, as_json=as_json)


@app.command()
def rate(
    model: Annotated[str | None, typer.Argument(help="e.g. mil_hdbk_217f.capacitor; none lists them")] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="INPUT=VALUE", help="e.g. temperature='60 degC'")
    ] = None,
    explain: Annotated[
        bool, typer.Option("--explain", help="show every input, what is assumed, and every factor")
    ] = False,
    unit: Annotated[
        str | None, typer.Option(help="of the rate: FIT, FPMH, 1/h, or '/10^6 cycle' of a rate per cycle")
    ] = None,
    as_json: Json = False,
) -> None:
    """The hazard rate that a handbook gives for a part."""
    from robophm.cli.rate import run

    run(model, set_ or [], unit, explain=explain, as_json=as_json)


@app.command()
def models(
    kind: Annotated[str | None, typer.Argument(help="of part, e.g. motor, 'chip resistor'; none lists all")] = None,
    reference: Annotated[bool, typer.Option("--reference", help="print the reference page, Markdown")] = False,
    as_json: Json = False,
) -> None:
    """The hazard models for a kind of part."""
    from robophm.cli.models import print_reference, run

    if reference:
        print_reference()
    else:
        run(kind, as_json=as_json)


Store_ = Annotated[Path | None, typer.Option("--store", help="the robot's past, as kept by replay")]
Failed = Annotated[list[str] | None, typer.Option(metavar="PART", help="is known to have failed")]
Working = Annotated[list[str] | None, typer.Option(metavar="PART", help="is known to work now")]
Draws = Annotated[int, typer.Option(help="of uncertain rates and loads; 0 for none", min=0, max=100_000)]


Future_ = Annotated[Literal["recent", "last", "nominal"], typer.Option("--future", help="stress and usage to come")]


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
    horizon: Horizon = None,
    unit: Unit = "1/h",
    as_json: Json = False,
) -> None:
    """Say what lies ahead: remaining life, task completion."""
    from robophm.cli.predict import Wishes, run

    wishes = Wishes(
        distance, speed, duration, future, plan, tuple(failed or ()), tuple(working or ()), draws,
        horizon_of(horizon), parts=parts,
    )  # fmt: skip
    _leave(run(design, store, wishes, unit, as_json=as_json))


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
    from robophm.cli.task_request import Request, run

    request = Request(
        tasks, store, tuple(failed or ()), tuple(working or ()), future, repeat, threshold, draws, seed,
        tuple(topic or ()), speed, tuple(function or ()), skip_missing=skip_missing, legacy=legacy, as_json=as_json,
    )  # fmt: skip
    _leave(run(design, request))


@app.command()
def replay(
    design: Design,
    recordings: Annotated[list[Path], typer.Argument(help=".bag, .db3, .mcap, folders of them, .csv or .journal")],
    store: Annotated[
        Path | None, typer.Option(help="keep the robot's past in this SQLite file, and go on from it")
    ] = None,
    report: Annotated[Path | None, typer.Option(help="write a page about its health, HTML")] = None,
    skip_missing: SkipMissing = False,
    horizon: Horizon = None,
    unit: Unit = "1/h",
    as_json: Json = False,
) -> None:
    """A robot's health after what it recorded: drives in the order of their time, however many."""
    from robophm.cli.replay import run

    ahead = horizon_of(horizon)
    _leave(run(design, recordings, store, report, unit, ahead, skip_missing=skip_missing, as_json=as_json))


@app.command()
def watch(
    design: Design,
    ros: Ros = "auto",
    store: Annotated[
        Path | None, typer.Option(help="keep the robot's past in this SQLite file, and go on from it")
    ] = None,
    journal: Annotated[Path | None, typer.Option(help="write every sample to the end of this journal")] = None,
    period: Annotated[
        float, typer.Option(min=0.1, max=3600, help="seconds that are integrated at once, and between two reports")
    ] = 1.0,
    every: Annotated[float, typer.Option(min=0.1, help="seconds between two lines, off a terminal")] = 10.0,
    publish: Annotated[bool, typer.Option(help="publish health as topics")] = True,
    namespace: Annotated[str, typer.Option(help="of the topics that are published")] = "/",
    frame: Annotated[str, typer.Option(help="where the markers for RViz stand")] = "base_link",
    tasks: Annotated[
        list[str] | None, typer.Option(help="topic or action that tells of tasks; default those known by name")
    ] = None,
    speed: Annotated[str | None, typer.Option(help="of planned legs that state none, e.g. '0.3 m/s'")] = None,
    function: Annotated[list[str] | None, typer.Option(help="that tasks need; default the whole robot")] = None,
    unit: Unit = "1/h",
    as_json: Json = False,
) -> None:
    """The health of a robot that runs, from ROS 1 or ROS 2 and back to it, until it is interrupted."""
    from robophm.cli.watch import Watched, run

    asked = Watched(
        ros, store, journal, period, every, namespace, publish, frame, tuple(tasks or ()), speed, tuple(function or ()),
        unit, as_json,
    )  # fmt: skip
    _leave(run(design, asked))


@app.command()
def topics(
    ros: Ros = "auto",
    seconds: Annotated[float, typer.Option(min=0.5, max=3600, help="to listen")] = 3.0,
    as_json: Json = False,
) -> None:
    """What a robot that runs publishes: topics, types, rates, and the last value of each number."""
    from robophm.cli.topics import run

    run(ros, seconds, as_json=as_json)


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
    from robophm.cli.calibrate import run

    _leave(run(predictions, report, controls=controls, jobs=jobs, as_json=as_json))


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
    monte_carlo: Annotated[
        int | None, typer.Option(min=1, max=1_000_000_000, help="only estimate the probability, by so many samples")
    ] = None,
    seed: Chance = 0,
    as_json: Json = False,
) -> None:
    """The probability of a fault tree's top event, and its minimal cut sets; of a robot, also its fault tree."""
    from robophm.cli.fault_tree import estimated, system_of, tree

    may_write(to, source)
    system = system_of(source, function, top, time, by_chance=monte_carlo is not None)
    if monte_carlo:
        estimated(system, monte_carlo, seed, as_json=as_json)
    else:
        tree(system, order=order, most=most, to=to, as_json=as_json)


@app.command()
def importance(
    design: Annotated[Path, typer.Argument(help="the robot's design, or an Open-PSA model", metavar="ROBOT.YAML")],
    tasks: Annotated[Path | None, typer.Argument(help="tasks.yaml or .csv; default: the design's task")] = None,
    store: Store_ = None,
    failed: Failed = None,
    working: Working = None,
    future: Future_ = "recent",
    function: Annotated[str | None, typer.Option(help="of the robot; default the whole robot")] = None,
    after: Annotated[
        str | None, typer.Option(help="time of operation ahead, e.g. '50 h'; default 1000 h, or half its life if less")
    ] = None,
    by: Annotated[str, typer.Option(help="birnbaum, criticality, fussell-vesely, raw, rrw, improvement "
                                         "or barlow-proschan")] = "criticality",
    most: Annotated[int, typer.Option(help="parts to list", min=1, max=100_000)] = 20,
    as_json: Json = False,
) -> None:  # fmt: skip
    """What matters most to a robot's health, and what to replace first."""
    from robophm.cli.importance import Question, hours_ahead, measure, run, run_model
    from robophm.cli.past import kept
    from robophm.cli.task import with_knowledge
    from robophm.design.file import load
    from robophm.design.task import Plan
    from robophm.design.task_file import load_plan

    hours, ranked = hours_ahead(after) if after is not None else None, measure(by)
    if design.suffix.lower() == ".xml":
        run_model(design, hours, ranked, most, as_json=as_json)
        return
    robot = load(design)
    plan = load_plan(tasks, robot) if tasks else Plan((robot.task,) if robot.task else ())
    plan = with_knowledge(plan, robot, failed or (), working or ())
    run(robot, kept(store, robot) if store else None, Question(plan, future, function, hours, ranked, most),
        as_json=as_json)  # fmt: skip


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
