"""Functions that must work until different times, decided jointly and exactly.

A part fails before now, in one of the phases that follow, or later. It is drawn as a chain of independent
steps, one for each stretch of phases that it must outlive (Esary and Ziehms, "Reliability analysis of phased
missions", Reliability and Fault Tree Analysis, SIAM 1975). Parts do not heal, so that a block that works at the
end of a phase worked before: only the last phase of each block counts. What hangs on different parts folds;
what shares parts is decided jointly, by the difference between what is known and what is wanted.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from robophm.blocks.decision_diagram import Array, Difference
from robophm.blocks.diagram import Block, KOutOfN, Parallel, Series, Unit
from robophm.blocks.folding import in_series
from robophm.blocks.given_it_works import (
    FAINTEST,
    StructureGivenItWorks,
    as_decimals,
    decimals,
    likely_failed,
    log,
    share,
    survival,
)
from robophm.blocks.graph import ALL, ANY, UNIT, Gate, graph, modules
from robophm.blocks.reliability import AT_ONCE, Transition

Needs = Mapping[int, int]
"""Nodes that must work, and at the end of which phase; phase 0 ends now."""

_Stretch = tuple[int, int, int]  # from and to a slice of the hazards, the first being the past; of which row


class Phases:
    """The functions that must work in phases, given which are known to have worked; prepared once, evaluated often.

    ``known`` and ``wanted`` are diagrams with the phase at whose end each works; phase 0 ends now.
    Raises StructureError where the shared parts are too many to solve exactly (decision_diagram.LIMIT).
    """

    names: tuple[str, ...]
    """The distinct units in drawing order: row i of every array below is unit i."""

    def __init__(self, known: Sequence[tuple[int, Block]], wanted: Sequence[tuple[int, Block]]) -> None:
        diagrams = [block for _, block in (*known, *wanted)]
        names, gates, tops = graph(*diagrams)
        self.names = tuple(names)
        at = [phase for phase, _ in (*known, *wanted)]
        given = _last(gates, zip(tops[: len(known)], at, strict=False))
        goals = _last(gates, zip(tops[len(known) :], at[len(known) :], strict=True))
        factors = list(dict.fromkeys((*given, *goals)))
        # A series taken apart hangs on nothing any more: what is in it may be a factor here and an input there.
        alone = modules([*gates, Gate(ALL, factors)])

        units = iter(range(len(names)))
        unit = {node: next(units) for node, gate in enumerate(gates) if gate.k == UNIT}
        self._shapes: dict[tuple[object, ...], tuple[Difference, list[list[_Stretch]]]] = {}
        blocks = _blocks(gates, names, unit)
        below = {node: _variables(gates, alone, node) for node in factors}
        own = sorted({v for vs in below.values() for v in vs} - unit.keys())
        self._modules = StructureGivenItWorks(*(blocks[v] for v in own)) if own else None
        if self._modules:
            self._rows = [self.names.index(name) for name in self._modules.structure.names]
        row = unit | {v: len(names) + i for i, v in enumerate(own)}
        for group in _groups(below):
            self._prepare(gates, row, below, given, goals, group)

    def _prepare(
        self, gates: Sequence[Gate], row: Mapping[int, int], below: Mapping[int, list[int]],
        given: Needs, goals: Needs, group: list[int],
    ) -> None:  # fmt: skip
        """Prepare a group of blocks that share parts: groups of the same shape are evaluated side by side."""
        phases = sorted({0} | {needs[node] for needs in (given, goals) for node in group if node in needs})
        variables = list(dict.fromkeys(v for node in group for v in below[node]))
        step = {(v, i): n for n, (v, i) in enumerate((v, i) for v in variables for i in range(len(phases)))}
        joint: list[tuple[int, Sequence[int]]] = []

        def add(k: int, inputs: Sequence[int]) -> int:
            joint.append((k, tuple(inputs)))
            return len(step) + len(joint) - 1

        works: dict[tuple[int, int], int] = {}  # the number of each node at the end of each phase
        inside = _inside(gates, group, set(variables))
        for i in range(len(phases)):
            for v in variables:
                works[v, i] = add(2, (works[v, i - 1], step[v, i])) if i else step[v, 0]
            for node in inside:
                inputs = [works[inner, i] for inner in gates[node].inputs]
                works[node, i] = add(gates[node].k or len(inputs), inputs)

        before = [works[node, phases.index(given[node])] for node in group if node in given]
        after = [works[node, phases.index(goals[node])] for node in group if node in goals]
        first = add(len(before), before) if before else None
        second = add(len(after) + len(before), (*after, *before))
        shape = (len(step), tuple(joint))
        if shape not in self._shapes:
            self._shapes[shape] = Difference(len(step), joint, first, second), []
        stretch = [(0, 1), *((phases[i - 1] + 1, phases[i] + 1) for i in range(1, len(phases)))]
        self._shapes[shape][1].append([(*stretch[i], row[v]) for v, i in step])

    def transition(self, known: Array, more: Array) -> Transition:
        """Return the outcome of the mission, shape (...): already lost, lost from what is known on, completed.

        ``known``: cumulative hazard of each unit till now, shape (units, ...), 0 where it is known to work and
        infinite where it has failed. ``more``: what each phase adds, shape (phases, units, ...).
        """
        hazard, shape = self._hazard(known, more)
        found = np.empty((3, hazard.shape[2]))
        for columns, (lost, fails, survives) in self._outcomes(hazard):
            found[:, columns] = in_series(np.stack((lost, survives, fails)))
        failed, works, change = found.reshape(3, *shape)
        return Transition(failed, change, works)

    def given(self, known: Array, more: Array) -> tuple[Array, Array]:
        """Return P(the mission is lost) and P(it is completed), given what is known, however unlikely that was.

        1 and 0 where what is known cannot be. Shape (...), arguments as of ``transition``.
        """
        hazard, shape = self._hazard(known, more)
        found = np.empty((3, hazard.shape[2]))
        for columns, (_, fails, survives) in self._told(hazard):
            works = fails + survives
            ahead = np.stack((np.zeros(works.shape), share(survives, works, 0.0), share(fails, works, 1.0)))
            found[:, columns] = in_series(ahead)
        _, works, change = found.reshape(3, *shape)
        return change, works

    def log_known(self, known: Array, more: Array) -> Array:
        """Return ln P(what is known), shape (...); arguments as of ``transition``."""
        hazard, shape = self._hazard(known, more)
        found = np.empty(hazard.shape[2])
        for columns, (_, fails, survives) in self._told(hazard):
            found[columns] = log(fails + survives).sum(axis=0)
        return found.reshape(shape)

    def _hazard(self, known: Array, more: Array) -> tuple[Array, tuple[int, ...]]:
        """The past and then each phase, shape (1 + phases, units, columns), and the shape that the columns had."""
        known, more = np.asarray(known, dtype=float), np.asarray(more, dtype=float)
        hazard = np.concatenate((np.broadcast_to(known, more.shape[1:])[None], more))
        return hazard.reshape(*hazard.shape[:2], -1), hazard.shape[2:]

    def _told(self, hazard: Array) -> Iterator[tuple[slice | NDArray[np.intp], Array]]:
        """The results of ``_outcomes``; columns where what is known was too unlikely come again, in decimals.

        While those are dealt with, decimals have all their exponents.
        """
        for columns, outcomes in self._outcomes(hazard):
            yield columns, outcomes
            works = outcomes[1] + outcomes[2]
            which = np.arange(hazard.shape[2])[columns][np.any(works < FAINTEST, axis=0)]
            if len(which):
                certain = np.where(np.isinf(hazard[..., which]), np.inf, 0.0)
                possible = [np.all(one[1] + one[2] > 0, axis=0) for _, one in self._outcomes(certain)]
                which = which[np.concatenate(possible)]
            if len(which):
                with decimals():
                    for some, exact in self._outcomes(hazard[..., which], exactly=True):
                        yield which[some], exact

    def _outcomes(self, hazard: Array, *, exactly: bool = False) -> Iterator[tuple[slice, Array]]:
        """Columns taking turns, and of each group lost, lost from what is known on, completed; (3, groups, columns)."""
        steps = {stretch: n for n, stretch in enumerate(self._stretches)}
        index = [
            np.array([[steps[stretch] for stretch in group] for group in groups]).T
            for _, groups in self._shapes.values()
        ]
        turn = max(1, AT_ONCE // max(difference.size * len(groups) for difference, groups in self._shapes.values()))
        for start in range(0, hazard.shape[2], turn):
            columns = slice(start, start + turn)
            failed, works = self._steps(hazard[..., columns], exactly=exactly)
            outcomes = []
            for (difference, groups), rows in zip(self._shapes.values(), index, strict=True):
                one = difference.evaluate(failed[rows].reshape(len(rows), -1), works[rows].reshape(len(rows), -1))
                outcomes.append(one.reshape(3, len(groups), -1))
            yield columns, np.concatenate(outcomes, axis=1)

    @cached_property
    def _stretches(self) -> list[_Stretch]:
        """Stretches of phases, and of which unit or module, that the groups are made of."""
        return sorted({stretch for _, groups in self._shapes.values() for group in groups for stretch in group})

    def _steps(self, hazard: Array, *, exactly: bool) -> tuple[Array, Array]:
        """P(fails in a stretch | worked before), and P(outlives it), of every stretch; shape (stretches, columns).

        In decimals where ``exactly``.
        """
        if exactly:  # sums too: of 10⁵ a float has eleven digits after the point
            hazard = as_decimals(hazard)
        failed = np.empty((len(self._stretches), hazard.shape[2]), hazard.dtype)
        works = np.empty_like(failed)
        rows = np.array([row for _, _, row in self._stretches])
        start = 0
        for (a, b), group in groupby(self._stretches, key=lambda stretch: stretch[:2]):
            here = slice(start, start := start + len(list(group)))
            here_rows = rows[here]
            units = here_rows < len(self.names)
            adds = hazard[a:b].sum(axis=0)
            of_units = adds[here_rows[units]]
            failed[here][units] = likely_failed(of_units)
            works[here][units] = survival(of_units)
            if self._modules and not units.all():
                past, adds = hazard[:a, self._rows].sum(axis=0), adds[self._rows]
                ahead = self._modules.exactly if exactly else self._modules.ahead
                fails, survives = ahead(past, adds)
                which = here_rows[~units] - len(self.names)
                failed[here][~units] = fails.reshape(-1, hazard.shape[2])[which]
                works[here][~units] = survives.reshape(-1, hazard.shape[2])[which]
        return failed, works


def _last(gates: Sequence[Gate], needs: Iterable[tuple[int, int]]) -> dict[int, int]:
    """The blocks that must work, with series taken apart, each until its last phase."""
    found: dict[int, int] = {}
    todo = list(needs)
    while todo:
        node, phase = todo.pop()
        if gates[node].k == ALL:
            todo += [(inner, phase) for inner in gates[node].inputs]
        else:
            found[node] = max(phase, found.get(node, 0))
    return found


def _variables(gates: Sequence[Gate], alone: Sequence[bool], top: int) -> list[int]:
    """The largest modules that a block hangs on, in drawing order; what two blocks share is in modules of both."""
    found: dict[int, None] = {}
    seen: set[int] = set()
    todo = [top]
    while todo:
        node = todo.pop()
        if node in seen:
            continue
        seen.add(node)
        if alone[node]:
            found[node] = None
        else:
            todo += reversed(gates[node].inputs)
    return list(found)


def _inside(gates: Sequence[Gate], group: Sequence[int], variables: set[int]) -> list[int]:
    """The blocks between a group and its variables, inputs first."""
    found: set[int] = set()
    todo = list(group)
    while todo:
        node = todo.pop()
        if node not in variables and node not in found:
            found.add(node)
            todo += gates[node].inputs
    return sorted(found)


def _groups(below: Mapping[int, list[int]]) -> list[list[int]]:
    """The blocks, together where they hang on the same modules."""
    leader: dict[int, int] = {}

    def lead(v: int) -> int:
        while leader.setdefault(v, v) != v:
            leader[v] = leader[leader[v]]
            v = leader[v]
        return v

    for variables in below.values():
        for v in variables:
            leader[lead(v)] = lead(variables[0])
    groups: dict[int, list[int]] = defaultdict(list)
    for node, variables in below.items():
        groups[lead(variables[0])].append(node)
    return list(groups.values())


def _blocks(gates: Sequence[Gate], names: Sequence[str], unit: Mapping[int, int]) -> list[Block]:
    """Every node as a block."""
    blocks: list[Block] = []
    for node, gate in enumerate(gates):
        inner = [blocks[i] for i in gate.inputs]
        if node in unit:
            blocks.append(Unit(names[unit[node]]))
        elif gate.k == ALL:
            blocks.append(Series(*inner))
        else:
            blocks.append(Parallel(*inner) if gate.k == ANY else KOutOfN(gate.k, *inner))
    return blocks
