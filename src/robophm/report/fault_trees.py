"""Fault trees of a robot, of a model in the Open-PSA format and of one in the Galileo format, in words and rows."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from robophm.blocks.cut_sets import MinimalSet
from robophm.blocks.dynamic_modules import DynamicAnswer
from robophm.blocks.fault_tree import FaultTree
from robophm.blocks.graph import ALL, ANY, NOT, ODD, UNIT
from robophm.blocks.listed_sets import ListedSets
from robophm.blocks.top_event import Answer, TopEvent
from robophm.design.importers.open_psa import LACKS_A_QUESTION, Model, load, load_all
from robophm.health.fault_tree import fault_tree
from robophm.health.prognosis import Outlook
from robophm.health.unknown_rates import PartsOfUnknownRate
from robophm.report.words import number_text, share_text

if TYPE_CHECKING:
    from robophm.groups.monte_carlo import Estimate

BESIDE_BOUNDS = 1_000_000
"""Samples of an estimate beside bounds: a second or two."""

NOTHING_ASKED = f"{LACKS_A_QUESTION}: there is nothing to compute"
"""A note on a model in which nothing is wrong and nothing asked."""

EXCHANGED = "Substitutions exchange events in its minimal cut sets: this is the tree of those that are left."
"""A note on a model with substitutions."""

MOST_EVENTS = 1_000_000
"""A number of events that no minimal cut set has, so that the smallest are listed whatever their number."""


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

    @property
    def structure_alone(self) -> str:
        """Return in words that no probability follows, where basic events have none."""
        return f"{self.no_chance} basic events have no probability, so that it has none; its structure alone:"

    def fails(self, text: str) -> str:
        """Return in words how likely it has failed."""
        return self.unknown.said("at least", text) if self.unknown else text

    def occurs(self, answer: Answer) -> str:
        """Return in a line how likely its top event is."""
        return f"{self.name}, {self.when}: occurs with {self.fails(answer_text(answer))}"


def of_new_robot(new: Outlook, function: str | None, hours: float) -> System:
    """Return the system of a robot, or a function of it, new and as designed, after so many operating hours."""
    found = fault_tree(new, function, hours)
    when = f"after {number_text(hours)} h of operation, new and as designed"
    name = new.plant.robot.name
    return System(f"{name}: {function}" if function else name, when, found, found.rates, found.unknown)


def of_model(path: Path, time: float | None) -> System:
    """Return the system of a model in the Open-PSA format that answers one question, at a mission time."""
    return _of(load(path, time), [path])


def of_models(paths: Sequence[Path], time: float | None, top: str | None) -> list[System]:
    """Return the top events of a model, of one file or several, and the sequences of its event trees; or those named
    ``top`` alone; nothing where it has none."""
    return [_of(model, paths) for model in load_all(paths, time, top)]


def _of(model: Model, paths: Sequence[Path]) -> System:
    event, time = model.structure() if model.tree else None, model.time
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


def answer_of(system: System, seconds: float) -> dict[str, Any]:
    """Return the same of any system, also of one whose events have no probabilities, within so many seconds."""
    if system.no_chance:
        return {"answer": "structure alone", "probability": None, "at_least": None, "at_most": None,
                "without_probability": system.no_chance}  # fmt: skip
    if system.found is None:
        sure = system.model.decided if system.model else 0.0
        return {"answer": "exact", "probability": sure, "at_least": sure, "at_most": sure}
    return answer_json(system.event.within(seconds))


def short_text(answer: Mapping[str, Any]) -> str:
    """Return such an answer in a few words."""
    if "without_probability" in answer:
        return f"no probability: {answer['without_probability']} basic events have none"
    if answer["probability"] is None:
        return f"between {answer['at_least']:.6g} and {answer['at_most']:.6g} (proved bounds)"
    return f"{answer['probability']:.6g} (exact)"


def size_text(event: TopEvent, answer: Answer) -> str:
    """Return in words how large a tree is, and by what it was solved."""
    events, gates = len(event.tree.names), len(event.tree.gates) - len(event.tree.names)
    return f"{events} basic events, {gates} gates; solved as {answer.modules} modules by {answer.nodes} nodes"


def uncertain(system: System) -> int:
    """Return how many expressions of a model are uncertain."""
    return system.model.chances.uncertain if system.model and system.model.chances else 0


def at_means(system: System) -> str:
    """Return in words that uncertain expressions are at their means; "" where none is uncertain."""
    count = uncertain(system)
    said = (
        "1 uncertain expression is at its mean" if count == 1 else f"{count} uncertain expressions are at their means"
    )
    return said if count else ""


def estimated(event: TopEvent, answer: Answer, samples: int = BESIDE_BOUNDS) -> Estimate | None:
    """Return an estimate by chance beside bounds that are apart; none where the answer is exact."""
    if answer.exact:
        return None
    from robophm.groups.monte_carlo import simulate_tree

    return simulate_tree(event.tree, event.occurred.tolist(), samples)


def beside_bounds(found: Estimate) -> str:
    """Return in a line an estimate that stands beside bounds."""
    return f"By chance: {estimate_text(found)} ({found.samples:,} samples)."


def estimate_text(found: Estimate) -> str:
    """Return an estimated probability and its interval as text."""
    return f"{found.probability:.6g}, with 95 % confidence between {found.low:.6g} and {found.high:.6g}"


def dynamic_text(name: str, time: float, found: DynamicAnswer) -> list[str]:
    """Return in a few lines how likely the top event of a dynamic tree is by a time, and when it occurs on average."""
    lines = [f"{name}, at {number_text(time)} h: occurs with {found.probability:.6g} (exact)"]
    if found.mean_time == math.inf:
        lines.append("It may never occur.")
    elif found.mean_time is not None:
        lines.append(f"It occurs after {number_text(found.mean_time)} h on average.")
    chains = f"Markov chains of {', '.join(map(str, found.states))} states" if found.states else "no Markov chains"
    return [*lines, f"solved by {chains}, and a static tree of {found.events} events over them"]


def sets_alone(answer: Answer, most: int, order: int | None) -> ListedSets:
    """Return the smallest cut sets of a tree whose probabilities mean nothing: the sets have none."""
    found = answer.cut_sets(most, order or MOST_EVENTS)
    sets = tuple(MinimalSet(one.names, math.nan) for one in found.sets)
    return replace(found, mass=math.nan, sets=sets, neglected=math.nan, whole=math.nan)


def kind_of_sets(event: TopEvent) -> str:
    """Return what the smallest sets that bring about a top event are called."""
    return "minimal cut set" if event.tree.coherent else "prime implicant"


def set_rows(listed: ListedSets) -> list[list[str]]:
    """Return the rows of a table of sets: number of parts, probability, share of the whole, and the parts."""
    return [
        [str(len(one.names)), _chance_text(one.probability), share_text(listed.share(one)), ", ".join(one.names)]
        for one in listed.sets
    ]


def _chance_text(p: float) -> str:
    return "–" if math.isnan(p) else f"{p:.4g}"


class TreeLine(NamedTuple):
    """A line of a fault tree that is listed from its top, below each gate what goes into it."""

    depth: int
    """Number of gates above it."""
    text: str
    chance: str
    """The probability of a basic event in words; "" of a gate."""


def tree_lines(name: str, tree: FaultTree, occurred: Sequence[float]) -> Iterator[TreeLine]:
    """List a tree from its top, which has a name; ``occurred``: P(basic event). A gate is listed below once alone."""
    events = iter(zip(tree.names, occurred, strict=True))
    leaf = {i: next(events) for i, gate in enumerate(tree.gates) if gate.k == UNIT}
    uses = [0] * len(tree.gates)
    for gate in tree.gates:
        for i in gate.inputs:
            uses[i] += 1
    seen: set[int] = set()
    top = len(tree.gates) - 1
    todo = [(0, top)]
    while todo:
        depth, i = todo.pop()
        if i in leaf:
            yield TreeLine(depth, leaf[i][0], _chance_text(leaf[i][1]))
            continue
        title = name if i == top else f"gate {i}" if uses[i] > 1 else ""
        words = _gate_text(*tree.gates[i])
        if i in seen:
            yield TreeLine(depth, f"{title}, as above", "")
            continue
        seen.add(i)
        yield TreeLine(depth, f"{title}: {words}" if title else words, "")
        todo += [(depth + 1, j) for j in reversed(tree.gates[i].inputs)]


def _gate_text(k: int, inputs: Sequence[int]) -> str:
    words = {ALL: f"all {len(inputs)} of", ANY: f"any one of {len(inputs)}", NOT: "not", ODD: "an odd number of"}
    return words.get(k, f"at least {k} of {len(inputs)}")
