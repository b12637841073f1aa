"""The fault tree of a robot or of a model in the Open-PSA format, and how its minimal sets are shown."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from robophm.blocks.cut_sets import MinimalSet
from robophm.blocks.listed_sets import ListedSets
from robophm.blocks.top_event import Answer, TopEvent
from robophm.cli.shared.output import console, estimate_text, print_table, table
from robophm.core.json_values import plain
from robophm.design.importers.open_psa import Model, load, load_all
from robophm.design.robot import Robot
from robophm.health.fault_tree import fault_tree
from robophm.health.outlooks import as_designed
from robophm.health.plant import Plant
from robophm.health.unknown_rates import PartsOfUnknownRate
from robophm.report.minimal_sets import counted, left_out
from robophm.report.words import number_text, share_text

if TYPE_CHECKING:
    from robophm.groups.monte_carlo import Estimate

BESIDE_BOUNDS = 1_000_000
"""Samples of an estimate beside bounds: a second or two."""

MOST_EVENTS = 1_000_000
"""A number of events that no minimal cut set has, so that the smallest are listed whatever their number."""

_MOST_WRITTEN = 10**4000  # Python writes no number of more than 4,300 digits


@dataclass(frozen=True)
class System:
    """The system that is asked about."""

    name: str
    when: str
    found: TopEvent | None
    """The top event; None where constants and house events decide it."""
    rates: Mapping[str, float] = field(default_factory=dict)
    """Hazard rates of events that fail at a constant one [1/h]."""
    unknown: PartsOfUnknownRate | None = None
    """Parts of unknown rate in it."""
    model: Model | None = None
    """Model that it was read from; None where it is of a robot."""
    source: str = ""
    time: float | None = None
    no_chance: int = 0
    """Number of basic events without a probability: where there are any, the event's probabilities mean nothing."""

    @property
    def event(self) -> TopEvent:
        """Return its top event. Raises RobophmError where it is decided, or where its events have no probabilities."""
        if self.model and (self.found is None or self.no_chance):
            return self.model.top_event()
        assert self.found is not None
        return self.found

    def fails(self, text: str) -> str:
        """Return in words how likely it has failed."""
        return self.unknown.said("at least", text) if self.unknown else text

    @property
    def json(self) -> dict[str, Any]:
        """Return the entry on parts of unknown rate of every JSON document about it."""
        return {"unknown": asdict(self.unknown)} if self.unknown else {}

    def print_unknown(self) -> None:
        """Print the note on parts of unknown rate, for people."""
        if self.unknown:
            console().print(self.unknown.of_sets, style="yellow", markup=False, soft_wrap=True)


def of_robot(robot: Robot, function: str | None, hours: float) -> System:
    """Return the system of a robot, or a function of it, new and as designed, after so many operating hours."""
    found = fault_tree(as_designed(Plant(robot)), function, hours)
    when = f"after {number_text(hours)} h of operation, new and as designed"
    return System(f"{robot.name}: {function}" if function else robot.name, when, found, found.rates, found.unknown)


def of_model(path: Path, time: float | None) -> System:
    """Return the system of a model in the Open-PSA format that answers one question, at a mission time."""
    return _of(load(path, time), [path], time)


def of_models(paths: Sequence[Path], time: float | None, top: str | None) -> list[System]:
    """Return the top events of a model, of one file or several, and the sequences of its event trees; or those named
    ``top`` alone."""
    return [_of(model, paths, time) for model in load_all(paths, time, top)]


def _of(model: Model, paths: Sequence[Path], time: float | None) -> System:
    event = model.structure() if model.tree else None
    when = f"at {number_text(time)} h" if time is not None else "as given"
    names = ", ".join(path.name for path in paths)
    return System(model.name, when, event, model=model, source=names, time=time, no_chance=len(model.no_chance))


def answer_text(answer: Answer) -> str:
    """Return in words how likely a top event is, and what kind of answer that is."""
    chance = answer.chance
    if answer.exact:
        return f"{chance.low:.6g} (exact)"
    apart = f"proved bounds {100 * chance.width:.2g} % apart"
    return (
        f"a probability between {chance.low:.6g} and {chance.high:.6g} ({apart}; too large to be solved exactly in "
        "this time)"
    )


def answer_json(answer: Answer, estimate: Estimate | None = None) -> dict[str, Any]:
    """Return for machines how likely a top event is; ``probability`` is null where only bounds are known."""
    return {
        "answer": "exact" if answer.exact else "proved bounds",
        "probability": answer.chance.low if answer.exact else None,
        "at_least": answer.chance.low,
        "at_most": answer.chance.high,
        **({"estimate": asdict(estimate)} if estimate else {}),
    }


def estimated(event: TopEvent, answer: Answer) -> Estimate | None:
    """Return an estimate by chance beside bounds that are apart; none where the answer is exact."""
    if answer.exact:
        return None
    from robophm.groups.monte_carlo import simulate_tree

    return simulate_tree(event.tree, event.occurred.tolist(), BESIDE_BOUNDS)


def print_estimate(estimate: Estimate | None) -> None:
    """Print an estimate beside bounds, for people."""
    if estimate:
        console().print(f"By chance: {estimate_text(estimate)} ({estimate.samples:,} samples).", soft_wrap=True)


def sets_json(listed: ListedSets) -> dict[str, Any]:
    """Return sets for machines. What is beyond the numbers of JSON or Python's words is null."""
    counts = [n if n < _MOST_WRITTEN else None for n in (listed.count, *listed.by_order)]
    found: dict[str, Any] = {
        "count": counts[0],
        "count_by_order": {str(i): n for i, n in enumerate(counts[1:], 1)},
        "sum_of_probabilities": listed.mass,
        "sum_of_those_not_listed": listed.neglected,
        "listed": [
            {"parts": list(one.names), "probability": one.probability, "share": listed.share(one)}
            for one in listed.sets
        ],
    }
    if listed.cut_off:
        found["missing"] = "unlikely sets" if math.isfinite(listed.cut_off) else "all that were not found"
        found["cut_off"] = listed.cut_off if math.isfinite(listed.cut_off) else None
        found["count"] = found["count"] if math.isfinite(listed.cut_off) else None
    return {key: plain(value) for key, value in found.items()}


def sets_alone(answer: Answer, most: int, order: int | None) -> ListedSets:
    """Return the smallest cut sets of a tree whose probabilities mean nothing: the sets have none."""
    found = answer.cut_sets(most, order or MOST_EVENTS)
    sets = tuple(MinimalSet(one.names, math.nan) for one in found.sets)
    return replace(found, mass=math.nan, sets=sets, neglected=math.nan, whole=math.nan)


def kind_of_sets(event: TopEvent) -> str:
    """Return what the smallest sets that bring about a top event are called."""
    return "minimal cut set" if event.tree.coherent else "prime implicant"


def print_sets(listed: ListedSets, kind: str) -> None:
    """Print sets of a kind, "minimal cut set" or such, for people."""
    out = console()
    out.print(counted(listed, kind), markup=False)
    rows = [
        (str(len(one.names)), _chance_text(one.probability), share_text(listed.share(one)), ", ".join(one.names))
        for one in listed.sets
    ]
    print_table(out, table("", ("parts", "probability", "share", kind), rows, figures=(0, 1, 2)))
    if rest := left_out(listed):
        out.print(rest, markup=False)


def _chance_text(p: float) -> str:
    return "–" if math.isnan(p) else f"{p:.4g}"
