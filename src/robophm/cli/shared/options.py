"""Options that several commands have, and how what is written there is read."""

from __future__ import annotations

from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from robophm.core.argument_checks import number
from robophm.core.errors import RobophmError, StoreError, UnitError
from robophm.core.signal import SECOND
from robophm.core.units import quantity
from robophm.core.waiting_time import LONGEST
from robophm.report.words import rate_text


def _known_unit(unit: str) -> str:
    try:
        rate_text(0.0, unit)
    except UnitError as error:
        raise typer.BadParameter(str(error)) from None
    return unit


Design = Annotated[Path, typer.Argument(help="the robot's design file", metavar="ROBOT.YAML")]

Prior = Annotated[
    str | None, typer.Option(help="weight of the stated rates: '10000 h', '2 failures'; default: the design's, or 1")
]
Json = Annotated[bool, typer.Option("--json", help="print one JSON document on stdout")]
"""The option of every command."""

Horizon = Annotated[
    str | None,
    typer.Option(
        help="how far ahead to look for parts that will fail, e.g. '1 year'; default: the median remaining life"
    ),
]

Unit = Annotated[str, typer.Option(help="unit of hazard rates: 1/h, FIT or FPMH", callback=_known_unit)]
Legacy = Annotated[bool, typer.Option("--legacy", help="also give the figures of the 2020 tool")]
Force = Annotated[bool, typer.Option("--force", help="overwrite a file that exists")]
Via = Annotated[
    str,
    typer.Option(
        "--via",
        help="how to listen: auto, ros1, ros2, dds, rclpy, zenoh[://robot], mqtt://broker/topic, foxglove://robot or rosbridge://robot",
    ),
]
ChanceSeed = Annotated[int, typer.Option(help="random seed of --monte-carlo", min=0)]


def stated_store(address: str | None) -> str | None:
    """The address of a store as it was given to ``--store``, or None without that option.

    Raises StoreError where the address is empty.
    """
    if address == "":
        raise StoreError("--store '': expected the path of a store, or its kind and where it is, sqlite:robot.db")
    return address


Store = Annotated[
    str | None,
    typer.Option(
        "--store", help="store with the robot's past, as replay, watch and serve keep it", callback=stated_store
    ),
]
Notify = Annotated[
    list[str] | None,
    typer.Option(
        help="send alarms to http://host/path (a webhook, as Alertmanager's), or "
        "smtp://user@host/?from=robot@example.org&to=team@example.org; may be repeated",
        metavar="ADDRESS",
    ),
]
GrowingStore = Annotated[
    str | None,
    typer.Option(
        help="store for the robot's past: a SQLite file, or KIND:WHERE; an existing one is continued",
        callback=stated_store,
    ),
]
StoreOfRobot = Annotated[
    str,
    typer.Option(
        "--store", help="store with the robot's past, as replay, watch and serve keep it", callback=stated_store
    ),
]
SkipMissing = Annotated[
    bool,
    typer.Option("--skip-missing", help="continue without bound topics that are not recorded; they count as silent"),
]

Failed = Annotated[list[str] | None, typer.Option(metavar="PART", help="a part that is known to have failed")]
Working = Annotated[list[str] | None, typer.Option(metavar="PART", help="a part that is known to work now")]
Draws = Annotated[int, typer.Option(help="number of draws of uncertain rates and loads; 0: none", min=0, max=100_000)]
Future = Annotated[
    Literal["recent", "last", "nominal"], typer.Option("--future", help="stress and usage assumed from now on")
]

Order = Annotated[int | None, typer.Option(help="list the sets of at most this many parts, smallest first", min=1)]
Limit = Annotated[
    float,
    typer.Option(
        "--limit", help="seconds after which proved bounds are given instead, if the tree is too large", min=0.1
    ),
]
MostSets = Annotated[int, typer.Option("--most", help="number of sets to list", min=1, max=100_000)]


def operating_time(option: str, text: str | float, *, above: bool = False) -> float:
    """Return hours of operation as an option states them, "50 h", "2 week" or a bare number of hours.

    Raises RobophmError, with the option's name, for what is none, is below 0, or ``above`` it where that is asked for.
    """
    try:
        hours = float(text)
    except ValueError:
        try:
            hours = quantity(str(text), "h")
        except UnitError as error:
            raise RobophmError(f"{option}: {error}") from None
    if not 0 <= hours <= LONGEST or (above and hours == 0):
        least = "above 0" if above else "of at least 0"
        raise RobophmError(f"{option} {text}: expected hours {least}, at most {LONGEST:g}, e.g. 50, or '2 week'")
    return hours


def time_option(option: str, text: str, *, above: bool = False) -> Any:
    """Return an option for a time of operation: --at is how old a robot is, --within how far is looked ahead."""
    return typer.Option(option, parser=partial(operating_time, option, above=above), metavar="TIME", help=text)


def share_of(option: str, text: str) -> float:
    """Return the share above 0 and below 1 that an option states, "0.9" or "90 %". Raises RobophmError."""
    try:
        share = quantity(text, "")
    except UnitError as error:
        raise RobophmError(f"{option}: {error}") from None
    if not 0 < share < 1:
        raise RobophmError(f"{option} {text}: expected a share above 0 and below 1, e.g. 0.9 or '90 %'")
    return share


def horizon_of(text: str | None) -> float | None:
    """Return how far ahead failures to come are looked for [h]; None: the usual. Raises RobophmError."""
    if text is None:
        return None
    return number(quantity(text, "h"), "--horizon [h]", above=True, high=LONGEST)


def moment_of(option: str, text: str) -> int:
    """Return the time [ns since the epoch] that an option states as a date, or with a time; UTC unless it has a zone.

    Raises RobophmError where it is none.
    """
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise RobophmError(
            f"{option} {text!r:.80}: expected a date and time, such as 2026-03-04 or 2026-03-04T12:00"
        ) from None
    since = (moment if moment.tzinfo else moment.replace(tzinfo=UTC)) - datetime(1970, 1, 1, tzinfo=UTC)
    return (since.days * 86_400 + since.seconds) * SECOND + since.microseconds * 1000
