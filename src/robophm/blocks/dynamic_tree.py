"""Dynamic fault trees: gates for which it matters in which order, and in whose use, basic events have failed.

Dugan, Bavuso and Boyd, "Dynamic fault-tree models for fault-tolerant computer systems", IEEE Trans. Reliability 41
(1992); of what they leave open, the semantics of Junges et al., "Uncovering dynamic fault trees", DSN 2016: a spare
gate claims the next input that has not failed and that no other uses; what is in use is active, and what stands by
fails at its dormant rate; a dependency fails its dependents one after the other; a failure that a sequence forbids
cannot occur.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import IntEnum
from itertools import permutations
from typing import Literal, NamedTuple

from robophm.core.errors import StructureError

Kind = Literal["at least", "pand", "pand exclusive", "por", "por exclusive", "spare"]

MOST_ORDERS = 24
"""The most orders of simultaneous failures that are tried, whether they come to the same."""


class Basic(NamedTuple):
    """A basic event: its failure rate in use and, as a factor of it, while it stands by."""

    name: str
    rate: float = 0.0
    dormancy: float = 1.0
    failed: bool = False
    """Whether it has failed from the start."""


class Gate(NamedTuple):
    """A gate of a kind; "at least" ``k`` of its inputs, which are numbers of elements."""

    name: str
    kind: Kind
    inputs: tuple[int, ...]
    k: int = 0


class Dependency(NamedTuple):
    """Each of these basic events fails with a chance when the trigger does."""

    trigger: int
    dependents: tuple[int, ...]
    chance: float = 1.0


class Restriction(NamedTuple):
    """Inputs of which one cannot fail before those left of it, or, ``exclusive``, once another has."""

    inputs: tuple[int, ...]
    exclusive: bool = False


class Status(IntEnum):
    """The status of an element."""

    WORKS = 0
    FAILED = 1
    NEVER = 2
    """The order was wrong, so that it can fail no more."""
    GONE = 3
    """Whatever it does, it does not matter any more."""


State = tuple[bytes, bytes, bytes]
"""The statuses of the elements, the place of the input that each gate uses or has come to, and which elements are
active."""

END: State = (b"", b"", b"")
"""The state in which the top event has occurred."""


@dataclass(frozen=True)
class DynamicTree:
    """Elements in any order, of which one is the top event; what depends on what; what cannot fail before what."""

    elements: tuple[Basic | Gate, ...]
    top: int
    dependencies: tuple[Dependency, ...] = ()
    restrictions: tuple[Restriction, ...] = ()

    def explorer(self) -> Explorer:
        """Return what goes from state to state. Raises StructureError for a loop of gates."""
        return Explorer(self)


class Explorer:
    """The states of a dynamic tree: the first ones, and what leads from each to others, at which rate."""

    def __init__(self, tree: DynamicTree) -> None:
        self._tree = tree
        elements = tree.elements
        self._gates = [i for i in order(elements) if isinstance(elements[i], Gate)]
        self._parents: list[list[int]] = [[] for _ in elements]
        for i in self._gates:
            for one in inputs_of(elements[i]):
                self._parents[one].append(i)
        self._triggered: list[list[Dependency]] = [[] for _ in elements]
        self._triggers: list[list[int]] = [[] for _ in elements]
        for dependency in tree.dependencies:
            self._triggered[dependency.trigger].append(dependency)
            for one in dependency.dependents:
                self._triggers[one].append(dependency.trigger)
        self._owners = self._find_owners()

    def _find_owners(self) -> list[frozenset[int] | None]:
        """Of each element the inputs of spare gates in whose use it is; None where it is always in use."""
        elements = self._tree.elements
        owners: list[set[int] | None] = [set() for _ in elements]
        for i in [*reversed(self._gates), *(i for i, one in enumerate(elements) if isinstance(one, Basic))]:
            if not self._parents[i] or i == self._tree.top:  # which may be used outside
                owners[i] = None
        for i in reversed(self._gates):  # from above
            spare = _is_spare(elements[i])
            for one in inputs_of(elements[i]):
                mine = owners[one]
                if mine is None:
                    continue
                if spare:
                    mine.add(one)
                elif owners[i] is None:
                    owners[one] = None
                else:
                    mine |= owners[i] or set()
        return [None if one is None else frozenset(one) for one in owners]

    def first(self) -> list[tuple[float, State]]:
        """Return the states in which it begins, and the chance of each."""
        n = len(self._tree.elements)
        using, active = bytearray(n), bytearray(n)
        for i in self._gates:
            if _is_spare(self._tree.elements[i]) and self._owners[i] is None:
                self._activate(inputs_of(self._tree.elements[i])[0], using, active)
        begin = _Changing(bytearray(n), using, active)
        failed = [i for i, one in enumerate(self._tree.elements) if isinstance(one, Basic) and one.failed]
        return self._settled([(1.0, begin, tuple(failed))])

    def onward(self, state: State) -> Iterator[tuple[float, list[tuple[float, State]]]]:
        """Yield the rates of the failures that are possible in a state, and where each leads with which chance."""
        statuses, using, active = state
        for i, one in enumerate(self._tree.elements):
            if isinstance(one, Basic) and statuses and statuses[i] == Status.WORKS and one.rate:
                owners = self._owners[i]
                in_use = owners is None or any(active[owner] for owner in owners)
                if rate := one.rate if in_use else one.rate * one.dormancy:
                    begin = _Changing(bytearray(statuses), bytearray(using), bytearray(active))
                    if self._fails(begin, i):
                        yield rate, self._settled([(1.0, begin, ())])

    def _settled(self, pending: list[tuple[float, _Changing, tuple[int, ...]]]) -> list[tuple[float, State]]:
        """The states once all that depends has failed; where their order matters it is refused."""
        found: dict[State, float] = {}
        while pending:
            chance, now, failing = pending.pop()
            if not failing:
                failing, share = self._depending(now)
                if not failing:
                    state = self._state(now)
                    found[state] = found.get(state, 0.0) + chance
                    continue
                if share < 1:  # one at a time: it fails or not
                    first = failing[0]
                    spared = now.copy()
                    spared.decided.add(first)
                    pending.append((chance * (1 - share), spared, ()))
                    if self._fails(now, first):
                        pending.append((chance * share, now, ()))
                    else:
                        pending.append((chance * share, spared.copy(), ()))
                    continue
            pending.append((chance, self._all(now, failing), ()))
        return [(chance, state) for state, chance in found.items()]

    def _all(self, now: _Changing, failing: tuple[int, ...]) -> _Changing:
        """Let several fail at one moment, in any order. Raises StructureError where the order makes a difference."""
        results: dict[State, _Changing] = {}
        for turn, some in enumerate(permutations(failing)):
            if turn == MOST_ORDERS:
                break
            after = now.copy()
            for one in some:
                if after.statuses[one] == Status.WORKS:
                    self._fails(after, one)
                after.decided.add(one)
            results.setdefault(self._state(after), after)
        if len(results) > 1:
            names = " and ".join(f"'{self._tree.elements[i].name}'" for i in failing[:3])
            raise StructureError(f"{names} fail at one moment, and which of them is first decides; expected it stated")
        return next(iter(results.values()))

    def _depending(self, now: _Changing) -> tuple[tuple[int, ...], float]:
        """What fails next because of what has failed, and with which chance; certain ones all at once."""
        certain: list[int] = []
        for dependency in self._tree.dependencies:
            if now.statuses[dependency.trigger] != Status.FAILED or dependency.trigger not in now.failed:
                continue
            for one in dependency.dependents:
                if now.statuses[one] == Status.WORKS and one not in now.decided:
                    if dependency.chance < 1:
                        return (one,), dependency.chance
                    certain.append(one)
        return tuple(dict.fromkeys(certain)), 1.0

    def _fails(self, now: _Changing, event: int) -> bool:
        """Let a basic event fail, with what follows at once; whether it may."""
        elements, before = self._tree.elements, now.copy()
        now.statuses[event] = Status.FAILED
        now.failed.add(event)
        for i in self._gates:
            if now.statuses[i] == Status.WORKS:
                gate = elements[i]
                assert isinstance(gate, Gate)
                self._judge(now, i, gate)
        for restriction in self._tree.restrictions:
            if any(now.statuses[one] == Status.GONE for one in restriction.inputs):
                continue  # none of them can fail any more
            failed = [now.statuses[one] == Status.FAILED for one in restriction.inputs]
            if (restriction.exclusive and sum(failed) > 1) or (
                not restriction.exclusive and failed != sorted(failed)[::-1]
            ):
                now.restore(before)
                return False
        return True

    def _judge(self, now: _Changing, i: int, gate: Gate) -> None:
        statuses = now.statuses
        failed = [statuses[one] == Status.FAILED for one in gate.inputs]
        if gate.kind == "at least":
            if sum(failed) >= gate.k:
                now.fail(i)
            elif sum(statuses[one] != Status.NEVER for one in gate.inputs) < gate.k:
                statuses[i] = Status.NEVER
        elif gate.kind == "spare":
            self._claim(now, i, gate)
        elif gate.kind == "por":
            if failed[0]:
                now.fail(i)
            elif any(failed) or statuses[gate.inputs[0]] == Status.NEVER:
                statuses[i] = Status.NEVER
        elif gate.kind == "por exclusive":
            if any(failed[1:]) or statuses[gate.inputs[0]] == Status.NEVER:
                statuses[i] = Status.NEVER
            elif failed[0]:
                now.fail(i)
        else:
            come = failed.index(False) if False in failed else len(failed)
            at_once = gate.kind == "pand exclusive" and come > now.using[i] + 1
            now.using[i] = come if gate.kind == "pand exclusive" else 0
            if any(failed[come:]) or at_once or any(statuses[one] == Status.NEVER for one in gate.inputs):
                statuses[i] = Status.NEVER
            elif come == len(failed):
                now.fail(i)

    def _claim(self, now: _Changing, i: int, gate: Gate) -> None:
        if now.statuses[gate.inputs[now.using[i]]] != Status.FAILED:
            return
        for place in range(now.using[i] + 1, len(gate.inputs)):
            wanted = gate.inputs[place]
            if now.statuses[wanted] != Status.FAILED and not self._is_used(now, wanted, i):
                now.using[i] = place
                owners = self._owners[i]
                if owners is None or any(now.active[owner] for owner in owners):
                    self._activate(wanted, now.using, now.active)
                return
        now.using[i] = len(gate.inputs) - 1
        now.fail(i)

    def _is_used(self, now: _Changing, wanted: int, by: int) -> bool:
        spares = (i for i in self._parents[wanted] if i != by and _is_spare(self._tree.elements[i]))
        return any(
            now.statuses[i] in (Status.WORKS, Status.GONE)
            and now.using[i] != _NONE
            and inputs_of(self._tree.elements[i])[now.using[i]] == wanted
            for i in spares
        )

    def _activate(self, wanted: int, using: bytearray, active: bytearray) -> None:
        """Take an input of a spare gate into use, with what the spare gates within it use."""
        if active[wanted]:
            return
        active[wanted] = 1
        for i in self._gates:
            gate = self._tree.elements[i]
            if isinstance(gate, Gate) and _is_spare(gate) and wanted in (self._owners[i] or ()) and using[i] != _NONE:
                self._activate(gate.inputs[using[i]], using, active)

    def _state(self, now: _Changing) -> State:
        """The state without what does not matter any more."""
        statuses, elements, tree = now.statuses, self._tree.elements, self._tree
        if statuses[tree.top] == Status.FAILED:
            return END
        matters = bytearray(len(elements))
        todo = [tree.top]
        while todo:
            i = todo.pop()
            if matters[i]:
                continue
            matters[i] = 1
            one = elements[i]
            if statuses[i] == Status.WORKS:
                todo += one.inputs[now.using[i] :] if isinstance(one, Gate) and _is_spare(one) else inputs_of(one)
                todo += self._triggers[i]
                todo += [
                    rival
                    for rival in self._parents[i]
                    if _is_spare(elements[rival]) and statuses[rival] == Status.WORKS
                ]
                todo += [inner for rule in tree.restrictions if i in rule.inputs for inner in rule.inputs]
        using, active = bytearray(now.using), bytearray(now.active)
        kept = bytes(status if matters[i] else Status.GONE for i, status in enumerate(statuses))
        for i in self._gates:
            gate = elements[i]
            if isinstance(gate, Gate) and kept[i] != Status.WORKS:
                used = _is_spare(gate) and using[i] != _NONE and matters[gate.inputs[using[i]]]
                using[i] = using[i] if used and kept[i] == Status.GONE else _NONE
        for i in range(len(elements)):
            active[i] &= matters[i] and kept[i] == Status.WORKS
        return kept, bytes(using), bytes(active)


_NONE = 255


class _Changing:
    """A state that is changing at one moment."""

    def __init__(self, statuses: bytearray, using: bytearray, active: bytearray) -> None:
        self.statuses, self.using, self.active = statuses, using, active
        self.failed: set[int] = set()
        """What has failed at this moment."""
        self.decided: set[int] = set()
        """What depends on what has failed at this moment, and has been looked at."""

    def copy(self) -> _Changing:
        found = _Changing(bytearray(self.statuses), bytearray(self.using), bytearray(self.active))
        found.failed, found.decided = set(self.failed), set(self.decided)
        return found

    def restore(self, other: _Changing) -> None:
        self.statuses, self.using, self.active, self.failed = other.statuses, other.using, other.active, other.failed

    def fail(self, i: int) -> None:
        self.statuses[i] = Status.FAILED
        self.failed.add(i)


def order(elements: Sequence[Basic | Gate]) -> list[int]:
    """Return the numbers of the elements, inputs first. Raises StructureError for a loop."""
    done: dict[int, None] = {}
    for first in range(len(elements)):
        under_way: dict[int, None] = {}
        todo = [first]
        while todo:
            i = todo[-1]
            if i in done:
                todo.pop()
            elif i in under_way:
                done[todo.pop()] = None
            else:
                under_way[i] = None
                for one in inputs_of(elements[i]):
                    if one in under_way and one not in done:
                        raise StructureError(f"loop: '{elements[one].name}' hangs on itself")
                    todo.append(one)
    return list(done)


def inputs_of(one: Basic | Gate) -> tuple[int, ...]:
    """Return the numbers of the inputs of an element: none of a basic event."""
    return one.inputs if isinstance(one, Gate) else ()


def _is_spare(one: Basic | Gate) -> bool:
    return isinstance(one, Gate) and one.kind == "spare"
