"""Exact reliability of a block diagram in which a part may be drawn in several places.

Nothing is ever subtracted: what works and what has failed are carried side by side, so that a probability of
1e-30 of either kind has all its digits. One rule covers the failure density and the failures in a task: let
the units before i be as of now and those after i as of the end, for each i; going from the end to now, the
system changes at exactly one unit, and c = Σᵢ cᵢ · P(i makes the difference) is a sum of positive terms.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from robophm.blocks.decision_diagram import Array, numbers
from robophm.blocks.diagram import Block, as_block
from robophm.blocks.folding import CHANGE, FAILED, FEW, WORKS, Call, counted, counting, exactly, merging, sides
from robophm.blocks.plan import Decision, Fold, Plan, Rows
from robophm.core.errors import StructureError, nearest

AT_ONCE = 200_000
"""Numbers that one array may hold, so that it stays in cache; more columns take turns."""

KEPT = 400_000
"""Numbers of a place of evaluation, so many that it is kept for the next one."""

Kind = np.dtype[Any]
FLOAT = np.dtype(np.float64)
"""Type of the numbers, unless they are objects: decimals, where probabilities are too small for a float."""

Write = Callable[[Array, slice], None]
"""A function that writes the leaves' numbers of some columns into the first rows."""


class State(NamedTuple):
    """The state of a system at a moment; arrays of one shape, e.g. (times, robots)."""

    works: Array
    """Probability that it works: its reliability."""
    failed: Array
    """Probability that it has failed: its unreliability."""
    density: Array
    """Failure density [1/h]; density / works is the hazard rate."""


class Transition(NamedTuple):
    """The transition of a system over a task; arrays of one shape that add up to 1."""

    failed: Array
    """Probability that it has failed by now."""
    fails: Array
    """Probability that it works now and fails during the task."""
    survives: Array
    """Probability that it works at the end of the task."""

    def given_works(self) -> tuple[Array, Array]:
        """Return P(fails in the task) and P(survives it), given that it works now; 1 and 0 where it cannot."""
        works = np.asarray(self.fails + self.survives)
        fails = np.divide(self.fails, works, out=np.ones_like(works), where=works > 0)
        return fails, np.divide(self.survives, works, out=np.zeros_like(works), where=works > 0)


class Structure:
    """A block diagram prepared once and evaluated many times; exact for any nesting and any sharing of parts.

    Of several diagrams, which share no parts, every result has one more axis, the first: the diagrams. Where
    ``kinds`` are given, a number from 0 on for each of ``names``, units of a kind are alike, and every array below has
    a row for each kind instead: equal blocks are then solved once, however many there are.
    Raises StructureError where the shared parts are too many to solve exactly (decision_diagram.LIMIT).
    """

    names: tuple[str, ...]
    """The distinct units in drawing order: row i of every array below is unit i."""
    leaves: Rows
    """The units as often and in the order in which they are evaluated: the rows of what ``lived`` is asked."""

    def __init__(self, *diagrams: Block, kinds: Sequence[int] | None = None) -> None:
        if not diagrams:
            raise StructureError("no diagram; expected at least one")
        self._plan = Plan(*(as_block(diagram, "diagram") for diagram in diagrams), kinds=kinds)
        self.names = self._plan.names
        self._inputs = len(self.names) if kinds is None else max(kinds) + 1
        self.leaves = self._plan.leaves
        self._systems: Rows | int = self._plan.systems if len(diagrams) > 1 else int(self._plan.systems[0])
        wide = (step.diagram.size for step in self._plan.steps if isinstance(step, Decision))
        self._width = max(self._plan.rows, *wide, 1)
        self._idle: deque[_Place] = deque(maxlen=4)

    def state(self, works: ArrayLike, failed: ArrayLike, density: ArrayLike = 0.0) -> State:
        """Return the state of the system, shape (...), from the states of its units, shape (units, ...).

        ``works`` + ``failed`` = 1, each with its own digits; ``density`` [1/h] is finite. Trailing axes
        broadcast. Raises StructureError where a first axis is not the units.
        """
        b, s, c = self._given(failed, works, density, task=False)
        return State(works=s, failed=b, density=c)

    def transition(self, before: ArrayLike, during: ArrayLike, after: ArrayLike) -> Transition:
        """Return the transition of the system over a task, shape (...), from those of its units, shape (units, ...).

        A unit fails ``before`` the task (it has failed by now), ``during`` it, or ``after`` it if at all;
        the three add up to 1. P(the system fails in the task | it works now) = fails / (fails + survives).
        Trailing axes broadcast. Raises StructureError where a first axis is not the units.
        """
        b, s, c = self._given(before, after, during, task=True)
        return Transition(b, c, s)

    def probability(self, works: ArrayLike, failed: ArrayLike) -> tuple[Array, Array]:
        """Return P(works) and P(has failed) of the system, shape (...): a state without its density."""
        b, s = self._given(failed, works, task=False)
        return s, b

    def lived(self, lived: Array, hazard: Array | None = None) -> Array:
        """Return P(has failed), P(works) and, given hazards, the density of the system; shape (numbers, ..., columns).

        From the cumulative hazard that each of ``leaves`` has lived and its ``hazard`` [1/h], shape (leaves, columns);
        one column of either is that of all.
        """
        columns = lived.shape[1] if hazard is None else max(lived.shape[1], hazard.shape[1])

        def write(rows: Array, turn: slice) -> None:
            failed, works = rows[FAILED, : len(lived)], rows[WORKS, : len(lived)]
            np.negative(lived if lived.shape[1] == 1 else lived[:, turn], failed)
            np.exp(failed, works)
            np.expm1(failed, failed)
            np.negative(failed, failed)
            if hazard is not None:
                own = hazard if hazard.shape[1] == 1 else hazard[:, turn]
                np.multiply(own, works, rows[CHANGE, : len(lived)])

        return self._evaluate(write, 2 if hazard is None else 3, columns, task=False)

    def birnbaum(self, works: ArrayLike, failed: ArrayLike) -> Array:
        """Return ∂R/∂pᵢ of every unit, shape (units, ...): P(the system works if i does, and has failed if i has).

        Of one diagram; of a kind, the sum over its units. One sweep back over a state; every term is positive.
        """
        columns, shape = self._columns(failed, works)
        _check_chances(columns)
        found, total = np.empty(columns[0].shape, columns[0].dtype), columns[0].size // self._inputs
        for turn, rows in self._turns(self._writing(columns), 2, total, task=False, kind=found.dtype):
            found[:, turn] = self._back(rows)
        return found.reshape(self._inputs, *shape)

    def moment(self) -> Moment:
        """Return a Moment, which follows one system and can be asked what one unit would change."""
        return Moment(self._plan)

    def _given(self, *units: ArrayLike, task: bool) -> Array:
        columns, shape = self._columns(*units)
        _check_chances(columns if task else columns[:2])
        system = self._evaluate(self._writing(columns), len(columns), columns[0].shape[1], task, columns[0].dtype)
        return system.reshape(*system.shape[:-1], *shape)

    def _evaluate(self, write: Write, numbers: int, columns: int, task: bool, kind: Kind = FLOAT) -> Array:
        several = (len(self._plan.systems),) if isinstance(self._systems, np.ndarray) else ()
        system = np.empty((numbers, *several, columns), kind)
        for turn, rows in self._turns(write, numbers, columns, task, kind):
            system[..., turn] = rows[:, self._systems]
        return system

    def _writing(self, columns: Sequence[Array]) -> Write:
        def write(rows: Array, turn: slice) -> None:
            for own, array in zip(rows, columns, strict=True):
                own[: len(self.leaves)] = array[:, turn][self.leaves]

        return write

    def _columns(self, *units: ArrayLike) -> tuple[list[Array], tuple[int, ...]]:
        """The units' numbers, each of shape (units, columns), and the shape that the columns had."""
        arrays = [numbers(array) for array in units]
        if any(array.dtype != FLOAT for array in arrays):
            arrays = [array.astype(object, copy=False) for array in arrays]
        for array in arrays:
            if array.dtype == FLOAT and not array.min(initial=0.0) >= 0:  # nor not a number
                raise StructureError("units: a number is negative or none; expected probabilities, and finite rates")
            if array.ndim and len(array) != self._inputs:
                raise StructureError(f"first axis of {array.shape}: expected the {self._inputs} units of the diagram")
        axes = max(1, *(array.ndim for array in arrays))
        arrays = [array.reshape(array.shape + (1,) * (axes - array.ndim)) for array in arrays]
        try:
            shape = (self._inputs, *np.broadcast(*arrays).shape[1:])
        except ValueError:
            raise StructureError(
                f"units: shapes {', '.join(str(one.shape) for one in arrays)} do not go together"
            ) from None
        columns = [
            (array if array.shape == shape else np.broadcast_to(array, shape)).reshape(self._inputs, -1)
            for array in arrays
        ]
        return columns, shape[1:]

    def _turns(
        self, write: Write, numbers: int, total: int, task: bool, kind: Kind = FLOAT
    ) -> Iterator[tuple[slice, Array]]:
        """Columns taking turns, and the rows of each turn; they lie in one place, so that it stays in cache."""
        most = max(1, min(total, AT_ONCE // self._width))
        for start in range(0, total, most):
            turn = slice(start, min(start + most, total))
            place = self._place(numbers, turn.stop - start, task, kind)
            write(place.rows, turn)
            for call in place.program:
                call()
            yield turn, place.rows
            if place.rows.size <= KEPT:
                self._idle.append(place)

    def _place(self, numbers: int, columns: int, task: bool, kind: Kind) -> _Place:
        """A place for an evaluation: the one of last time that fits, of which no other thread makes use now."""
        for _ in range(len(self._idle)):
            try:
                place = self._idle.pop()
            except IndexError:
                break
            if place.rows.shape[::2] == (numbers, columns) and place.task == task and place.rows.dtype == kind:
                return place
            self._idle.appendleft(place)
        rows = np.zeros((numbers, self._plan.rows, columns), kind)
        return _Place(rows, task, list(_program(self._plan, rows, task)))

    def _back(self, rows: Array) -> Array:
        """How much the system's chance to work grows with each unit's; shape (units, columns)."""
        weight = np.zeros(rows.shape[1:], rows.dtype)
        weight[self._systems] = 1
        for step in reversed(self._plan.steps):
            inputs = rows[:, step.inputs]
            np.add.at(weight, step.made, weight[step.to])
            if isinstance(step, Decision):
                weight[step.inputs] = step.diagram.sensitivity(*inputs[:2]) * weight[step.out]
            elif step.stages:
                other = rows[WORKS] if step.k == step.n else rows[FAILED]
                for left, right, out, size in reversed(step.stages):
                    one, two, made = (slice(at, at + size) for at in (left, right, out))
                    np.multiply(weight[made], other[two], out=weight[one])
                    np.multiply(weight[made], other[one], out=weight[two])
            else:
                decides = exactly(step.k - 1, inputs.reshape(len(rows), step.n, -1))
                weighed = decides.reshape(step.n, step.gates, -1) * weight[step.out : step.out + step.gates]
                weight[step.inputs] = weighed.reshape(step.n * step.gates, -1)
        weight[self._plan.taken] = weight[self._plan.to]
        found = np.zeros((self._inputs, rows.shape[2]), rows.dtype)
        np.add.at(found, self.leaves, weight[: len(self.leaves)])
        return found


def _check_chances(columns: Sequence[Array]) -> None:
    """Raise StructureError where what can become of a unit does not add up to 1."""
    total = sum(columns[1:], columns[0])
    if total.dtype == FLOAT and total.size and not (total.min() > 1 - _ADDS_UP and total.max() < 1 + _ADDS_UP):
        raise StructureError("units: probabilities of a unit do not add up to 1; expected all that can become of it")


_ADDS_UP = 1e-6


class Moment:
    """A system at one moment after the other: units are written into ``works``, ``failed`` and ``density``.

    In what it is asked about one unit, only what hangs on that unit is made anew; answers are those of a full
    evaluation to the last bit. Not to be shared by threads.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._rows = np.zeros((3, plan.rows, 1))
        self._program = list(_program(plan, self._rows, task=False))
        self._system = int(plan.systems[0])
        self._unit = {name: i for i, name in enumerate(plan.names)}
        self._row = np.empty(len(plan.leaves), dtype=np.intp)
        self._row[plan.leaves] = np.arange(len(plan.leaves))
        self._entry = dict(zip(plan.taken.tolist(), plan.to.tolist(), strict=True))
        self._steps = {step.start + i: step for step in plan.steps for i in range(step.inputs.stop - step.start)}
        self._paths: dict[str, list[_Merge | _Solve]] = {}
        self._numbers: list[list[float]] = []

    def set(self, works: Array, failed: Array, density: Array | float = 0.0) -> State:
        """Set the units, arrays of shape (units,), and return the state of the system."""
        row = self._row
        self._rows[WORKS, row, 0], self._rows[FAILED, row, 0], self._rows[CHANGE, row, 0] = works, failed, density
        for call in self._program:
            call()
        self._numbers = []
        return self.state

    @property
    def state(self) -> State:
        """Return the state of the system as it is."""
        failed, works, density = self._rows[:, self._system, 0]
        return State(works, failed, density)

    def what_if(self, unit: str, works: float, failed: float, density: float = 0.0) -> State:
        """Return the state of the system as it would be if one unit were as given.

        Raises StructureError where there is no such unit.
        """
        path = self._paths.get(unit)
        if path is None:
            if unit not in self._unit:
                raise StructureError(f"no unit '{unit}'{nearest(unit, self._unit)}")
            path = self._paths[unit] = list(self._path(int(self._row[self._unit[unit]])))
        if not self._numbers:
            self._numbers = self._rows[:, :, 0].tolist()
        all_failed, all_works, all_density = self._numbers
        for step in path:
            if isinstance(step, _Merge):
                b, s, c = all_failed[step.other], all_works[step.other], all_density[step.other]
                if step.first:
                    if step.series:
                        failed, works, density = works * b + failed, works * s, works * c + density * s
                    else:
                        failed, works, density = failed * b, failed * s + works, failed * c + density * b
                elif step.series:
                    failed, works, density = s * failed + b, s * works, s * density + c * works
                else:
                    failed, works, density = b * failed, b * works + s, b * density + c * failed
            else:
                inputs = self._rows[:, step.rows]
                inputs[:, step.place, 0] = failed, works, density
                failed, works, density = step(inputs)
        return State(*np.array((works, failed, density)))

    def _path(self, row: int) -> Iterator[_Merge | _Solve]:
        """The steps from the row of a unit up to the system."""
        row = self._entry.get(row, row)
        while row != self._plan.systems[0]:
            step = self._steps[row]
            if isinstance(step, Decision) or not step.stages:
                count = 1 if isinstance(step, Decision) else step.gates
                place, gate = divmod(row - step.start, count)
                yield _Solve(step, list(range(step.start + gate, step.inputs.stop, count)), place)
            else:
                for left, right, out, size in step.stages:
                    for one, other in ((left, right), (right, left)):
                        if one <= row < one + size:
                            yield _Merge(step.k == step.n, one == left, other + row - one)
                            row = out + row - one
                            break
                gate = row - step.out
            row = int(step.to[np.searchsorted(step.made, step.out + gate)]) if len(step.to) else step.out + gate


def _program(plan: Plan, rows: Array, task: bool) -> Iterator[Call]:
    """The arithmetic that makes every block; ``rows`` of (failed, works[, change]), shape (2 or 3, rows, columns)."""
    widest = max((stage.size for step in plan.steps if isinstance(step, Fold) for stage in step.stages), default=0)
    scratch = np.empty((widest, rows.shape[2]), rows.dtype)
    yield from _copying(rows, plan.taken, plan.to)
    for step in plan.steps:
        inputs = rows[:, step.inputs]
        if isinstance(step, Decision):
            yield partial(_decide, step, inputs, rows[:, step.out], task)
            yield from _copying(rows, step.made, step.to)
            continue
        made = rows[:, step.out : step.out + step.gates]
        if step.stages:
            lost, held = (FAILED, WORKS) if step.k == step.n else (WORKS, FAILED)
            for at, size in ((stage[:3], stage.size) for stage in step.stages):
                one, other, out = (rows[:, start : start + size] for start in at)
                yield from merging(one, other, out, scratch[:size], lost, held, task)
        else:
            by_gate = inputs.reshape(len(rows), step.n, -1)
            yield from counting(step.k, by_gate, made.reshape(len(rows), -1), task)
        yield from _copying(rows, step.made, step.to)


class _Place(NamedTuple):
    """Rows, and what makes every block from those in it there."""

    rows: Array
    """Rows of (failed, works[, change]), shape (2 or 3, rows, columns)."""
    task: bool
    program: list[Call]


class _Merge(NamedTuple):
    """A row meets another in a pair."""

    series: bool
    first: bool
    other: int


class _Solve(NamedTuple):
    """A row is an input of a step that is done anew as a whole."""

    step: Fold | Decision
    rows: list[int]
    """Rows of the step's inputs."""
    place: int
    """The row among them."""

    def __call__(self, inputs: Array) -> tuple[float, float, float]:
        """Evaluate the step for inputs of shape (numbers, inputs, 1)."""
        if isinstance(self.step, Fold) and self.step.n <= FEW:
            return counted(self.step.k, inputs[:, :, 0].T.tolist())
        made = np.empty((len(inputs), 1))
        if isinstance(self.step, Decision):
            _decide(self.step, inputs, made, task=False)
        else:
            for call in counting(self.step.k, inputs, made, task=False):
                call()
        failed, works, density = made[:, 0].tolist()
        return failed, works, density


def _copying(rows: Array, of: Rows, to: Rows) -> Iterator[Call]:
    if not len(of):
        return
    if np.all(np.diff(of) == 1) and np.all(np.diff(to) == 1):  # side by side: nothing is to be looked up
        yield partial(np.copyto, rows[:, to[0] : to[-1] + 1], rows[:, of[0] : of[-1] + 1])
    else:
        yield partial(_copy, rows, of, to)


def _copy(rows: Array, of: Rows, to: Rows) -> None:
    rows[:, to] = rows[:, of]


def _decide(step: Decision, inputs: Array, out: Array, task: bool) -> None:
    change = inputs[2] if len(inputs) > 2 else np.zeros_like(inputs[0])
    made = step.diagram.evaluate(inputs[FAILED], change, inputs[WORKS], *sides(inputs, task))
    out[...] = np.stack((made[0], made[2], made[1]))[: len(inputs)]
