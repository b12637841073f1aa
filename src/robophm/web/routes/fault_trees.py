"""Fault trees: of the design, and of a file that is handed in; nothing is changed."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from time import perf_counter
from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response

from robophm.blocks.fault_tree import FaultTree
from robophm.core.errors import DataError, DesignError
from robophm.design.importers import galileo
from robophm.design.importers.open_psa.writing import document
from robophm.health.importance import LONGEST
from robophm.report.fault_trees import (
    EXCHANGED,
    NOTHING_ASKED,
    System,
    answer_of,
    at_means,
    beside_bounds,
    dynamic_text,
    estimated,
    kind_of_sets,
    of_models,
    of_new_robot,
    set_rows,
    sets_alone,
    short_text,
    size_text,
    tree_lines,
)
from robophm.report.minimal_sets import STEPS, counted, left_out
from robophm.web.access.roles import needs
from robophm.web.prepared_robot import PreparedRobot
from robophm.web.routes.analysis import Hours, few_enough
from robophm.web.routes.data import FileName, Upload
from robophm.web.routes.design import REFUSED
from robophm.web.routes.faults import FoundTables, table_of, uploaded
from robophm.web.service import Served
from robophm.web.shapes import Shape

router = APIRouter(prefix="/api/analysis", tags=["analysis"])

SECONDS = 5.0
"""The most time for one answer; the command has more."""

SAMPLES = 100_000
"""Samples of an estimate beside bounds."""

MOST_SETS = 20
MOST_LINES = 1000

Function = Annotated[str | None, Query(max_length=5000)]

_SOLVING = threading.Lock()
"""A tree of a file takes seconds and megabytes: one at a time."""


class XmlResponse(Response):
    """A response that is a file in XML."""

    media_type = "application/xml"


class TreeRow(Shape):
    """A line of a fault tree, listed from its top."""

    depth: int
    text: str
    chance: str
    """The probability of a basic event; "" of a gate."""


class FoundTree(FoundTables):
    """The probability of a top event in words, its tree, and its minimal cut sets as a table."""

    says: str
    tree: list[TreeRow]
    more: int
    """Number of lines of the tree that are left out."""
    tops: list[str] = []
    """Names of the top events and sequences of a model, where it has several."""


@router.get("/fault-tree", responses=REFUSED)
def get_fault_tree(service: Served, hours: Hours = 1000.0, function: Function = None) -> FoundTree:
    """The fault tree of the new robot, or of a function of it, after so many hours of operation."""
    return _found(_bounded(_of_design(service.prepared(), function, hours)))


@router.get("/fault-tree.xml", response_class=XmlResponse, responses=REFUSED)
def get_fault_tree_as_model(service: Served, hours: Hours = 1000.0, function: Function = None) -> XmlResponse:
    """The same tree as a model in the Open-PSA format, as other tools read it."""
    system = _of_design(service.prepared(), function, hours)
    if system.unknown:
        raise DesignError(f"{system.unknown.words} would be written as never failing; expected a rate for each")
    text = document(system.name, system.event.tree, system.event.occurred.tolist(), system.rates)
    return XmlResponse(text, headers={"content-disposition": 'attachment; filename="fault-tree.xml"'})


@router.post("/fault-tree-of-file", responses=REFUSED)
@needs("viewer")
def get_fault_tree_of_file(
    body: Upload,
    name: FileName,
    hours: Annotated[float | None, Query(gt=0, le=LONGEST)] = None,
    top: Annotated[str | None, Query(max_length=5000)] = None,
) -> FoundTree:
    """The fault tree of an Open-PSA model (.xml) or of a Galileo tree (.dft), at a mission time.

    ``top``: one of the top events or sequences of a model that has several.
    """
    expected = "an Open-PSA model, .xml, or a Galileo tree, .dft"
    with uploaded(name, body, ".xml", ".dft", expected=expected) as path, _SOLVING:
        if path.suffix.lower() == ".dft":
            return _dynamic(path, name, hours)
        systems = [_bounded(system) for system in of_models([path], hours, top)]
        if not systems:
            return FoundTree(says=f"{name}: {NOTHING_ASKED}.", tree=[], more=0, tables=[], notes=[])
        return _found(systems[0]) if len(systems) == 1 else _each(systems, name)


def _of_design(prepared: PreparedRobot, function: str | None, hours: float) -> System:
    few_enough(prepared, "fault-tree")
    return of_new_robot(prepared.new, function or None, hours)


def _bounded(system: System) -> System:
    """The same, for a page's time and memory."""
    if system.found is None:
        return system
    tree = system.found.tree
    return replace(system, found=replace(system.found, tree=FaultTree(tree.names, tree.gates, STEPS)))


def _found(system: System) -> FoundTree:
    """One top event: its probability, proved bounds where it is too large for a page, or what is known without one."""
    if system.found is None:
        assert system.model is not None
        return FoundTree(says=f"{system.name}: {system.model.decision}", tree=[], more=0, tables=[], notes=[])
    event = system.found
    answer = event.within(SECONDS)
    if system.no_chance:
        says, listed = f"{system.name}: {system.structure_alone}", sets_alone(answer, MOST_SETS, None)
        notes, chances = [], [float("nan")] * len(event.occurred)
    else:
        says, listed, chances = system.occurs(answer), answer.cut_sets(MOST_SETS), event.occurred.tolist()
        by_chance = estimated(event, answer, SAMPLES)
        notes = [beside_bounds(by_chance)] if by_chance else []
    if system.unknown:
        notes.append(f"{system.unknown.of_sets}.")
    if system.model and system.model.exchanged:
        notes.append(EXCHANGED)
    if said := at_means(system):
        notes.append(f"{said}.")
    if said := left_out(listed):
        notes.append(said)
    notes.append(size_text(event, answer))
    kind = kind_of_sets(event)
    sets = [[names, *figures] for *figures, names in set_rows(listed)]
    table = table_of(counted(listed, kind), [kind, "parts", "probability", "share"], sets, range(1, 4))
    lines = tree_lines(system.name, event.tree, chances)
    rows = [TreeRow(**one._asdict()) for one in islice(lines, MOST_LINES)]
    return FoundTree(says=says, tree=rows, more=sum(1 for _ in lines), tables=[table], notes=notes)


def _each(systems: Sequence[System], name: str) -> FoundTree:
    """A model that answers several questions: each in a row. Raises DesignError where a page has no time for all."""
    until, rows = perf_counter() + SECONDS, []
    for system in systems:
        if (left := until - perf_counter()) < 0:
            raise DesignError(f"{name}: answers {len(systems):,} questions, more than a page has time for: "
                              "`robophm fault-tree` has it")  # fmt: skip
        rows.append([system.name, short_text(answer_of(system, left))])
    table = table_of("What it answers", ["sequence or top event", "occurs with"], rows, [1])
    says = f"{len(systems)} answers, {systems[0].when}; choose one for its tree"
    return FoundTree(says=says, tree=[], more=0, tables=[table], notes=[], tops=[system.name for system in systems])


def _dynamic(path: Path, name: str, hours: float | None) -> FoundTree:
    if hours is None:
        raise DataError(f"{name}: is a dynamic fault tree; expected the time by which its top event occurs")
    tree = galileo.load(path)
    says, *notes = dynamic_text(tree.name, hours, tree.solved(hours, perf_counter() + SECONDS))
    return FoundTree(says=says, tree=[], more=0, tables=[], notes=notes)
