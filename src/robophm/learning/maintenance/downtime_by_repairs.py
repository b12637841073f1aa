"""The standstill of a robot: the time in which parts that are down, each for its own repair, leave it down.

Parts are repaired independently of each other and age whether or not the robot stands. Spares in standby and parts that
share a load are taken to age as if they worked as designed: k of n of them must be up.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block, Group, KOutOfN, LoadSharing, Series, Standby, Unit, with_blocks
from robophm.blocks.reliability import Structure

Array = npt.NDArray[np.float64]

_AT_ONCE = 4_000_000  # numbers of an array


class Downtimes(NamedTuple):
    """Downtimes of one unit, over all repetitions; shapes (downtimes,)."""

    repetition: npt.NDArray[np.int64]
    begin: Array
    end: Array


class Standstill:
    """A robot's structure, asked about parts that are down; without a diagram any of them stops it."""

    def __init__(self, diagram: Block | None = None) -> None:
        self._structure = Structure(without_dependence(diagram)) if diagram else None

    def hours(self, units: Mapping[str, Sequence[Downtimes]], horizon: float, repetitions: int) -> Array:
        """Return the time of standstill within a horizon; shape (repetitions,). Units that are not named are up."""
        names = [name for name in units if not self._structure or name in self._structure.names]
        rows = [(k, one) for k, name in enumerate(names) for one in units[name] if len(one.begin)]
        if not rows:
            return np.zeros(repetitions)
        which = np.concatenate([np.full(len(one.begin), k) for k, one in rows])
        repetition, begin, end = (np.concatenate([one[i] for _, one in rows]) for i in range(3))
        # Each begin and end is an event; all are up before the first and after the last of a repetition.
        unit, of = np.tile(which, 2), np.tile(repetition, 2)
        time = np.minimum(np.concatenate((begin, end)), horizon)
        change = np.repeat([1, -1], len(which))
        order = np.lexsort((time, of))
        unit, of, time, change = unit[order], of[order], time[order], change[order]
        lasts = np.where(np.append(of[1:] == of[:-1], False), np.append(time[1:], 0.0) - time, 0.0)
        stands, ends = np.zeros(len(time)), np.flatnonzero(np.append(of[1:] != of[:-1], True)) + 1
        start, most = 0, max(1, _AT_ONCE // len(names))
        while start < len(time):  # whole repetitions at a time
            stop = int(
                ends[max(np.searchsorted(ends, start + most, side="right") - 1, np.searchsorted(ends, start + 1))]
            )
            here = slice(start, stop)
            moved = np.zeros((len(names), stop - start), dtype=np.int32)
            moved[unit[here], np.arange(stop - start)] = change[here]
            stands[here] = self._down(names, np.cumsum(moved, axis=1) > 0)
            start = stop
        return np.asarray(np.bincount(of, stands * lasts, repetitions), dtype=float)

    def stops(self, unit: str, up: Mapping[str, float]) -> float:
        """Return P(the robot stands still | a unit is down), the others up with probabilities ``up``, default 1."""
        if not self._structure:
            return 1.0
        names = self._structure.names
        works = np.array([0.0 if name == unit else up.get(name, 1.0) for name in names])
        if unit not in names:
            return 0.0
        return float(self._structure.probability(works, 1 - works)[1])

    def _down(self, names: Sequence[str], down: npt.NDArray[np.bool_]) -> Array:
        """1 where the robot stands still; shape (moments,)."""
        if not self._structure:
            return np.asarray(down.any(axis=0), dtype=float)
        place = {name: row for row, name in enumerate(names)}
        failed = np.zeros((len(self._structure.names), down.shape[1]))
        for row, name in enumerate(self._structure.names):
            if name in place:
                failed[row] = down[place[name]]
        return np.asarray(self._structure.probability(1 - failed, failed)[1])


def without_dependence(diagram: Block) -> Block:
    """Return a diagram in which groups of parts that depend on each other are k of n of their members."""
    known: dict[int, Block] = {}

    def of(block: Block) -> Block:
        if id(block) not in known:
            if isinstance(block, Group):
                members = [Series(*member) if len(member) > 1 else Unit(member[0]) for member in block.members]
                needed = (
                    block.active if isinstance(block, Standby) else block.k if isinstance(block, LoadSharing) else 1
                )
                known[id(block)] = KOutOfN(needed, *members)
            elif isinstance(block, Unit):
                known[id(block)] = block
            else:
                known[id(block)] = with_blocks(block, [of(one) for one in block.blocks])
        return known[id(block)]

    return of(diagram)
