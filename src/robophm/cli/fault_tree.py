"""``robophm fault-tree``: the probability of a top event and its minimal cut sets, of a robot or a model.

Of a model that answers more, the probability of each: several top events, sequences of event trees, phases.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from robophm.blocks.listed_sets import ListedSets
from robophm.blocks.top_event import TopEvent
from robophm.cli.shared.fault_trees import (
    of_robot,
    print_estimate,
    print_sets,
    print_unknown,
    sets_json,
    unknown_json,
)
from robophm.cli.shared.options import ChanceSeed, Json, Limit, MostSets, Order, time_option
from robophm.cli.shared.output import console, may_write, print_json, print_table, table, write
from robophm.cli.shared.unused import refuse_unused
from robophm.core.errors import RobophmError
from robophm.core.json_values import plain
from robophm.design.file import load
from robophm.design.importers import galileo
from robophm.design.importers.open_psa.as_design import as_design
from robophm.design.importers.open_psa.model import Array
from robophm.design.importers.open_psa.writing import document
from robophm.report.fault_trees import (
    EXCHANGED,
    NOTHING_ASKED,
    System,
    answer_json,
    answer_of,
    at_means,
    dynamic_text,
    estimate_text,
    estimated,
    kind_of_sets,
    of_models,
    sets_alone,
    short_text,
    size_text,
    uncertain,
)
from robophm.report.words import number_text

_QUANTILES = (0.05, 0.5, 0.95)

DYNAMIC = ".dft"
"""The suffix of dynamic fault trees in the Galileo format."""


def command(
    sources: Annotated[
        list[Path],
        typer.Argument(
            help="an Open-PSA model of one file or more, a Galileo tree, or a robot's design",
            metavar="MODEL.XML|TREE.DFT|ROBOT.YAML",
        ),
    ],
    function: Annotated[str | None, typer.Option(help="function of a robot; default: the whole robot")] = None,
    top: Annotated[
        str | None, typer.Option(help="only this gate of a model, or this sequence of its event trees")
    ] = None,
    time: Annotated[
        float | None, time_option("--at", "mission time of a model, or time of operation of a new robot")
    ] = None,
    order: Order = None,
    most: MostSets = 20,
    to: Annotated[Path | None, typer.Option(help="write the tree as a model, .xml, or as a design, .yaml")] = None,
    limit: Limit = 60.0,
    monte_carlo: Annotated[
        int | None, typer.Option(min=1, max=1_000_000_000, help="only estimate the probability, by this many samples")
    ] = None,
    draws: Annotated[
        int | None,
        typer.Option(min=2, max=1_000_000, help="number of draws of a model's uncertain values, by a Latin hypercube"),
    ] = None,
    seed: ChanceSeed = 0,
    as_json: Json = False,
) -> None:
    """The probability of a fault tree's top event and its minimal cut sets, also of a robot's own tree.

    Of a model with event trees, the probability of each sequence, given its initiating event.
    """
    may_write(to, *sources)
    if any(source.suffix.lower() == DYNAMIC for source in sources):
        refuse_unused("a dynamic fault tree", ("time", "limit"))
        if len(sources) > 1 or time is None:
            raise RobophmError(f"{sources[0]}: expected it alone, and --at, the time by which its top event occurs")
        dynamic(sources[0], time, limit, as_json=as_json)
        return
    systems = systems_of(sources, function, top, time, by_chance=monte_carlo is not None, drawn=draws is not None)
    if not systems:
        refuse_unused("a model that asks nothing", ("time",))
        nothing_asked(sources, as_json=as_json)
        return
    if len(systems) > 1:
        refuse_unused(f"a model that answers {len(systems)} questions; --top names one", ("time", "top", "limit"))
        each(systems, limit, as_json=as_json)
        return
    (system,) = systems
    if monte_carlo:
        by_samples(system, monte_carlo, seed, as_json=as_json)
    else:
        tree(system, order=order, most=most, to=to, limit=limit, draws=draws, seed=seed, as_json=as_json)


def tree(
    system: System, *, order: int | None, most: int, to: Path | None, limit: float, draws: int | None, seed: int,
    as_json: bool,
) -> None:  # fmt: skip
    """State the probability of the top event, list its minimal cut sets or prime implicants, and write it where wanted.

    Where it is not solved exactly within ``limit`` seconds, it has proved bounds.

    What is written is a model in the Open-PSA format, or where its name ends as a design's does, a design.
    """
    if draws and not (system.model and system.model.chances and system.model.chances.uncertain):
        raise RobophmError(f"--draws: nothing is uncertain in '{system.name}'; expected a model with deviates")
    if system.found is None or system.no_chance:
        _without_chances(system, order=order, most=most, to=to, limit=limit, as_json=as_json)
        return
    if to and system.unknown:
        raise RobophmError(f"{to}: {system.unknown.words} would be written as never failing; expected a rate for each")
    text = _design(system, to) if to and is_design(to) else ""
    event, answer = system.event, system.event.within(limit)
    listed, by_chance = answer.cut_sets(most, order), estimated(event, answer)
    drawn = system.model.drawn(draws, seed) if system.model and draws else None
    if to:
        write(to, text or document(system.name, event.tree, event.occurred.tolist(), system.rates))
    if as_json:
        print_json({
            "top_event": system.name, "when": system.when, **answer_json(answer, by_chance),
            "basic_events": len(event.tree.names), "gates": len(event.tree.gates) - len(event.tree.names),
            "modules": answer.modules, "nodes": answer.nodes, **_uncertain_json(system, drawn, seed),
            "coherent": event.tree.coherent, **_sets(event, listed),
            **unknown_json(system),
        })  # fmt: skip
        return
    out = console()
    out.print(system.occurs(answer), markup=False, soft_wrap=True)
    print_estimate(by_chance)
    print_unknown(system)
    if system.model and system.model.exchanged:
        out.print(EXCHANGED)
    if said := _uncertain_text(system, drawn):
        out.print(said, markup=False, soft_wrap=True)
    out.print(size_text(event, answer), markup=False)
    print_sets(listed, kind_of_sets(event))
    if to:
        out.print(f"Written: {to}", markup=False)


def dynamic(source: Path, time: float, limit: float, *, as_json: bool) -> None:
    """State the probability of a dynamic fault tree's top event by a time, and its mean time."""
    tree = galileo.load(source)
    found = tree.solved(time, clock.perf_counter() + limit)
    if as_json:
        mean = None if found.mean_time is None or math.isinf(found.mean_time) else found.mean_time
        print_json({
            "top_event": tree.name, "when": f"at {number_text(time)} h", "answer": "exact",
            "probability": found.probability, "mean_time": mean, "may_never_occur": found.mean_time == math.inf,
            "states": list(found.states), "basic_events": found.events,
        })  # fmt: skip
        return
    for line in dynamic_text(tree.name, time, found):
        console().print(line, markup=False, soft_wrap=True)


def each(systems: Sequence[System], limit: float, *, as_json: bool) -> None:
    """State the probability of each top event and each sequence, and of all sequences of an initiating event."""
    answers = [answer_of(system, limit) for system in systems]
    sums: dict[str, float] = {}
    for system, answer in zip(systems, answers, strict=True):
        if system.model and (initiating := system.model.initiating):
            known = answer["probability"]
            sums[initiating] = sums.get(initiating, 0.0) + (math.nan if known is None else known)
    if as_json:
        print_json({
            "when": systems[0].when,
            "answers": [{"name": system.name, **answer} for system, answer in zip(systems, answers, strict=True)],
            "sequences_together": plain(sums),
        })  # fmt: skip
        return
    out = console()
    out.print(f"{len(systems)} answers, {systems[0].when}; --top NAME says more of one", markup=False)
    rows = [(short_text(answer), system.name) for system, answer in zip(systems, answers, strict=True)]
    print_table(out, table("", ("occurs with", "sequence or top event"), rows))
    for initiating, total in sums.items():
        if not math.isnan(total):
            out.print(f"The sequences of {initiating} together: {total:.6g}", markup=False)


def nothing_asked(sources: Sequence[Path], *, as_json: bool) -> None:
    """State that a model is in order, and what it lacks to answer anything."""
    names = ", ".join(map(str, sources))
    if as_json:
        print_json({"note": NOTHING_ASKED, "answers": []})
        return
    console().print(f"{names}: {NOTHING_ASKED}. Nothing in it is wrong.", markup=False, soft_wrap=True)


def _without_chances(
    system: System, *, order: int | None, most: int, to: Path | None, limit: float, as_json: bool
) -> None:  # fmt: skip
    """State what constants decide, or of a tree without probabilities its smallest cut sets."""
    if to:
        raise RobophmError(f"{to}: '{system.name}' has no basic events with probabilities, which would be written")
    listed = None
    if system.found is None:
        assert system.model is not None
        sure, words = system.model.decided, system.model.decision
        document = {"answer": "exact", "probability": sure, "at_least": sure, "at_most": sure}
    else:
        words = system.structure_alone
        document = {"answer": "structure alone", "probability": None, "at_least": None, "at_most": None,
                    "without_probability": system.no_chance, "coherent": system.found.tree.coherent}  # fmt: skip
        listed = sets_alone(system.found.within(limit), most, order)
    if as_json:
        sets = _sets(system.found, listed) if system.found and listed else {"cut_sets": None}
        print_json({"top_event": system.name, "when": system.when, **document, **sets})
        return
    console().print(f"{system.name}: {words}", markup=False, soft_wrap=True)
    if system.found and listed:
        print_sets(listed, kind_of_sets(system.found))


def _uncertain_json(system: System, drawn: Array | None, seed: int) -> dict[str, Any]:
    count = uncertain(system)
    if drawn is None:
        return {"uncertain": count} if count else {}
    low, median, high = np.quantile(drawn, _QUANTILES)
    spread = {"draws": len(drawn), "seed": seed, "mean": drawn.mean(), "p05": low, "median": median, "p95": high}
    return {"uncertain": count, "uncertainty": plain(spread)}


def _uncertain_text(system: System, drawn: Array | None) -> str:
    if not uncertain(system):
        return ""
    if drawn is None:
        return f"{at_means(system)}; --draws 1000 says how far that may be off."
    low, median, high = np.quantile(drawn, _QUANTILES)
    return (
        f"Of {len(drawn):,} draws of what is uncertain 90 % lie between {low:.4g} and {high:.4g}: "
        f"median {median:.4g}, mean {drawn.mean():.4g}."
    )


def _sets(event: TopEvent, listed: ListedSets) -> dict[str, Any]:
    """The entries of a tree's minimal cut sets, or of its prime implicants where it is not coherent."""
    found = sets_json(listed)
    return {"cut_sets": found} if event.tree.coherent else {"cut_sets": None, "prime_implicants": found}


def by_samples(system: System, samples: int, seed: int, *, as_json: bool) -> None:
    """State how often the top event occurred in so many samples of the basic events."""
    from robophm.groups.monte_carlo import simulate_tree

    found = simulate_tree(system.event.tree, system.event.occurred.tolist(), samples, seed=seed)
    if as_json:
        print_json(
            {"top_event": system.name, "when": system.when, "seed": seed, **asdict(found), **unknown_json(system)}
        )
        return
    console().print(
        f"{system.name}, {system.when}: occurs with {system.fails(estimate_text(found))} ({found.samples:,} samples)",
        markup=False, soft_wrap=True,
    )  # fmt: skip
    print_unknown(system)


def systems_of(
    sources: list[Path], function: str | None, top: str | None, time: float | None, *, by_chance: bool, drawn: bool
) -> list[System]:
    """Read a robot's design or a model; options that do not go with that, or with --monte-carlo, are refused."""
    robot = any(is_design(source) for source in sources)
    if robot and len(sources) > 1:
        raise RobophmError(f"{len(sources)} files with a robot's design; expected it alone, or the files of one model")
    path = "a robot, whose top event is of --function" if robot else "a model, whose top event is of --top"
    path += ", only estimated (--monte-carlo)" if by_chance else ""
    given = ("monte_carlo", "seed") if by_chance else ("order", "most", "to", "limit")
    draws = () if robot or by_chance else ("draws", "seed") if drawn else ("draws",)
    refuse_unused(path, ("time", "function" if robot else "top", *given, *draws))
    if robot:
        return [of_robot(load(sources[0]), function, 1000.0 if time is None else time)]
    return of_models(sources, time, top)


def is_design(path: Path) -> bool:
    """Whether a file is a design by its name."""
    return path.suffix.lower() in (".yaml", ".yml")


def _design(system: System, to: Path) -> str:
    if system.model is None:
        raise RobophmError(f"{to}: of a robot its fault tree is written; expected a name that ends in .xml")
    if to.exists():
        raise RobophmError(f"{to}: exists already; expected the name of a new design")
    return as_design(system.model, system.source, system.time)
