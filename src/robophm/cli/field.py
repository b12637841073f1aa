"""The commands about what the field says: failures, life data, wear, maintenance, diagnosis."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Literal

import typer

from robophm.cli import BREACHED
from robophm.cli.output import Json

Design = Annotated[Path, typer.Argument(help="the robot's design file", metavar="ROBOT.YAML")]
Force = Annotated[bool, typer.Option("--force", help="also where that file exists")]


def learn(
    design: Design,
    logs: Annotated[
        list[Path], typer.Argument(help="failure logs (.csv, .yaml), or stores of robots (.db)", metavar="LOG…")
    ],
    prior: Annotated[
        str | None, typer.Option(help="what stated rates count as: '10000 h', '2 failures'; default the design's, or 1")
    ] = None,
    of: Annotated[str | None, typer.Option("--robot", help="rates of this one robot of the fleet")] = None,
    to: Annotated[Path | None, typer.Option(help="write the design with the evidence beside each rate")] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """What failures in the field say of a design's rates."""
    from robophm.cli.learn import run

    run(design, logs, prior, of, to, force=force, as_json=as_json)


def service(
    design: Design,
    part: Annotated[str, typer.Argument(help="path of the component, or of its failure mode")],
    store: Annotated[Path, typer.Option("--store", help="the robot's past, as kept by replay")],
    replaced: Annotated[bool, typer.Option("--replaced", help="a new one was put in")] = False,
    repaired: Annotated[
        float | None,
        typer.Option(help="it was repaired: the share of its age that remains, 0 as new, 1 as before", metavar="SHARE"),
    ] = None,
    failed: Annotated[bool, typer.Option("--failed", help="it had failed; else it was served before")] = False,
    history: Annotated[bool, typer.Option("--history", help="list every service of it so far")] = False,
    as_json: Json = False,
) -> None:
    """Tell a robot's ledger that a part was replaced, or repaired."""
    from robophm.cli.service import run

    run(design, part, store, repaired, replaced=replaced, failed=failed, history=history, as_json=as_json)


def fit(
    lives: Annotated[
        Path, typer.Argument(help="a table of lives: time [h], censored, count, stresses …", metavar="LIVES.CSV")
    ],
    distribution: Annotated[
        str | None, typer.Option(help="exponential, weibull, weibull3, lognormal, normal, gamma, loglogistic, gumbel")
    ] = None,
    by: Annotated[
        Literal["likelihood", "ranks"], typer.Option(help="likelihood, or ranks: a line through median ranks")
    ] = "likelihood",
    use: Annotated[
        list[str] | None, typer.Option(metavar="STRESS=VALUE", help="of use, e.g. temperature='40 degC'")
    ] = None,
    law: Annotated[
        list[str] | None, typer.Option(metavar="STRESS=LAW", help="arrhenius, eyring, q10, inverse_power")
    ] = None,
    repairable: Annotated[bool, typer.Option("--repairable", help="items are repaired and go on: power law")] = False,
    level: Annotated[float, typer.Option(help="of intervals", min=0.01, max=0.999)] = 0.9,
    refits: Annotated[
        int, typer.Option(help="simulate so many fits to say how well the best fits", min=0, max=10_000)
    ] = 0,
    seed: Annotated[int, typer.Option(help="of --refits", min=0)] = 0,
    report: Annotated[Path | None, typer.Option(help="write a page with probability plots, HTML")] = None,
    to: Annotated[Path | None, typer.Option(help="put the life into this design, with --part")] = None,
    part: Annotated[str | None, typer.Option(help="path of the part, or of its failure mode")] = None,
    as_json: Json = False,
) -> None:
    """Fit life data: distributions, lives at stress, repaired systems (needs robophm[fit])."""
    from robophm.cli.fit import Wishes, run

    wishes = Wishes(
        distribution, by, level, tuple(use or ()), tuple(law or ()), repairable, refits, seed, report, to, part,
        as_json,
    )  # fmt: skip
    run(lives, wishes)


def maintain(
    design: Design,
    costs: Annotated[Path, typer.Argument(help="a table: part, preventive, corrective, …", metavar="COSTS.CSV")],
    store: Annotated[
        Path | None, typer.Option("--store", help="the robot's past: what is due, and what to do first")
    ] = None,
    setup: Annotated[float, typer.Option(help="cost of a visit, whatever is done at it", min=0)] = 0.0,
    downtime_cost: Annotated[float, typer.Option(help="of an hour that the robot stands still", min=0)] = 0.0,
    horizon: Annotated[str, typer.Option(help="over which costs are simulated")] = "5 year",
    robots: Annotated[int, typer.Option(help="that share a stock of spares", min=1, max=1_000_000)] = 1,
    level: Annotated[float, typer.Option(help="with which spares are enough", min=0.001, max=0.99999)] = 0.95,
    lead: Annotated[str, typer.Option(help="time for which spares must do")] = "90 day",
    repetitions: Annotated[int, typer.Option(help="of the simulation", min=2, max=1_000_000)] = 2000,
    seed: Annotated[int, typer.Option(help="of the simulation", min=0)] = 0,
    as_json: Json = False,
) -> None:
    """When to replace which part, with which spares, at what cost; whether watching it pays."""
    from robophm.cli.maintain import Wishes, run

    run(design, costs, Wishes(store, setup, downtime_cost, horizon, robots, level, lead, repetitions, seed, as_json))


def wear(
    design: Design,
    signals: Annotated[
        list[Path],
        typer.Argument(
            help="recordings (.bag, .mcap, .db3, .journal, folders) with the signals that the design names at `wear`, "
            "or a table: time [h] or when, value",
            metavar="RECORDING…|SIGNAL.CSV",
        ),
    ],
    part: Annotated[
        str | None,
        typer.Option(help="path of the part, or its failure mode, whose wear it shows; default all with `wear`"),
    ] = None,
    threshold: Annotated[
        float | None, typer.Option(help="of a table: at which it has failed; of a signal that falls, below the first")
    ] = None,
    process: Annotated[Literal["wiener", "gamma"], typer.Option(help="gamma: it only grows")] = "wiener",
    load: Annotated[
        float | None, typer.Option(help="of a table: at which readings are compared, by their column load")
    ] = None,
    baseline: Annotated[int, typer.Option(help="readings at the start that were sound", min=30)] = 100,
    false_alarms: Annotated[float, typer.Option(help="one in so many readings", min=10)] = 1000.0,
    shift: Annotated[float, typer.Option(help="deviations that shall be seen", min=0.1, max=10)] = 1.0,
    store: Annotated[Path | None, typer.Option("--store", help="the robot's past, as kept by replay")] = None,
    skip_missing: Annotated[
        bool, typer.Option("--skip-missing", help="signals that all recordings lack stay silent")
    ] = False,
    seed: Annotated[int, typer.Option(help="of what is drawn", min=0)] = 0,
    as_json: Json = False,
) -> None:
    """The wear that signals show: trend, change, and what remains of parts and robot; exit code 1 at a threshold."""
    from robophm.cli.wear import Wishes, run

    wishes = Wishes(part, threshold, process, load, baseline, false_alarms, shift, store, skip_missing, seed, as_json)
    if run(design, signals, wishes):
        raise typer.Exit(BREACHED)


def fmeca(
    design: Design,
    sensors: Annotated[
        Path | None, typer.Option(help="a table: sensor, part, detects, false alarm, price, fitted")
    ] = None,
    hours: Annotated[float, typer.Option(help="of operation of a new robot", min=1e-6)] = 1000.0,
    severity: Annotated[
        list[str] | None, typer.Option(metavar="WHAT=1…10", help="of robot, redundancy, nothing, a function or a part")
    ] = None,
    to: Annotated[Path | None, typer.Option(help="write all of it, .csv or .html")] = None,
    force: Force = False,
    as_json: Json = False,
) -> None:
    """Failure modes, effects and criticality, the effects from the robot's structure."""
    from robophm.cli.diagnose import fmeca as run

    run(design, sensors, hours, tuple(severity or ()), to, force=force, as_json=as_json)


def diagnose(
    design: Design,
    sensors: Annotated[
        Path, typer.Argument(help="a table: sensor, part, detects, false alarm, price, fitted", metavar="SENSORS.CSV")
    ],
    alarm: Annotated[list[str] | None, typer.Option(metavar="SENSOR", help="is on; the others are off")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="none is on: what may have failed all the same")] = False,
    add: Annotated[int, typer.Option(help="how many sensors to add, of those with fitted: no", min=0, max=16)] = 0,
    hours: Annotated[
        float, typer.Option(help="of operation within which a fault came, or the robot must work", min=0)
    ] = 100.0,
    after: Annotated[
        float | None, typer.Option(help="operating hours that a new robot has worked, unwatched", min=0)
    ] = None,
    store: Annotated[Path | None, typer.Option("--store", help="the robot's past, as kept by replay")] = None,
    function: Annotated[str | None, typer.Option(help="that must work; default the whole robot")] = None,
    as_json: Json = False,
) -> None:
    """What sees which failure, which it is given the alarms, and which sensor would tell most."""
    from robophm.cli.diagnose import Wishes
    from robophm.cli.diagnose import diagnose as run

    alarms = tuple(alarm) if alarm else () if quiet else None
    run(design, sensors, Wishes(alarms, add, hours, after, store, function, as_json))


COMMANDS: tuple[Callable[..., None], ...] = (learn, service, fit, maintain, wear, fmeca, diagnose)
