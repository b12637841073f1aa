"""The probability that a task ahead will be completed, given what is known now.

P(for every leg, its functions work at the end of the leg | the functions that the task needs work now, and what else
is known), jointly over the legs. Robots do not heal within a task, so that only the last leg of each function counts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block
from robophm.core.errors import DesignError
from robophm.design.robot import FailureMode, Stress
from robophm.design.task import Plan, Task
from robophm.health.future import Future
from robophm.health.plant import Mission, Need, column
from robophm.health.prognosis import Outlook
from robophm.health.stress_groups import channel_key

Array = npt.NDArray[np.float64]

_FAINTEST = math.log(1e-290)  # of a probability of which nobody asks any more
_FEW = 256  # repetitions to begin with
_AT_ONCE = 1_000_000  # numbers that one array may hold: more repetitions take turns


@dataclass(frozen=True)
class Completion:
    """Whether a task will be completed, given what is known now. Both probabilities have their own digits."""

    probability: float
    failure: float


@dataclass(frozen=True)
class DecidingComponent:
    """A component that a task hangs on, and how the task would fare if it could not fail."""

    path: str
    failure_without: float
    """Probability that the task fails if this component cannot."""
    share: float
    """Share of the task's probability of failure that would vanish."""


class Steps(NamedTuple):
    """The exposure that legs, or phases of a mission, add to every failure mode; arrays of shape (modes, legs, ...)."""

    advance: Array
    """Advance of each mode's clock."""
    effective: Array
    """The same advance times the mode's stress factor."""

    def phases(self, ends: Sequence[int]) -> Steps:
        """Join the legs of each phase; ``ends`` are the indices of the phases' last legs."""
        starts = [0, *(end + 1 for end in ends[:-1])]
        return Steps(*(np.add.reduceat(one, starts, axis=1) for one in self))


def needs(task: Task) -> tuple[tuple[Need, ...], list[int]]:
    """Return the phase until whose end each function must work, and the leg with which each phase ends."""
    last: dict[str, int] = {}
    for k, leg in enumerate(task.legs):
        last |= dict.fromkeys(leg.functions or ("",), k)
    ends = sorted(set(last.values()))
    return tuple(sorted((ends.index(k) + 1, function) for function, k in last.items())), ends


def completion(outlook: Outlook, task: Task, diagram: Block | None = None) -> Completion:
    """P(the task will be completed | what is known now): the functions that it needs work now.

    Of a ``diagram``: that the parts in it do their share, working throughout.
    """
    if diagram:
        return _given(outlook.ahead(diagram, *(one.sum(axis=1) for one in planned(outlook, task))))
    if not task.legs:
        return Completion(1.0, 0.0)
    return completion_of_steps(outlook, task, planned(outlook, task))


def completion_of_steps(outlook: Outlook, task: Task, steps: Steps) -> Completion:
    """Return the completion of a task whose legs are known to age the robot so, as of a task that was actually done."""
    wanted, ends = needs(task)
    mission = outlook.plant.mission(needed_now(wanted), wanted)
    hazard = outlook.increments(outlook.plant.everything, *steps)
    return _given(_transition(outlook, mission, hazard, ends))


def beginnings(outlook: Outlook, task: Task) -> Callable[[int], Completion]:
    """Return the function that tells how the first so many legs of a task fare: the more, the less likely.

    All functions that the whole task needs work now, so that all legs fare as ``completion`` of the task says.
    """
    hazard = outlook.increments(outlook.plant.everything, *planned(outlook, task))
    now = needed_now(needs(task)[0])

    def first(legs: int) -> Completion:
        if not legs:
            return Completion(1.0, 0.0)
        wanted, ends = needs(Task(task.legs[:legs]))
        mission = outlook.plant.mission(now, wanted)
        return _given(_transition(outlook, mission, hazard[:, :legs], ends))

    return first


def consecutive_completions(outlook: Outlook, tasks: Sequence[Task]) -> list[Completion]:
    """Return the completion of tasks in a row, exposure carried on: each given that those before it were completed.

    All functions that any of them needs work now, so that the product over the tasks is that all are completed.
    """
    legs = Task.joined(tasks)
    hazard = outlook.increments(outlook.plant.everything, *planned(outlook, legs))
    start_with = {(0, function) for leg in legs.legs for function in leg.functions or ("",)}
    found, last = [], dict[str, int]()  # the last leg of each function so far
    start = 0
    for task in tasks:
        if not task.legs:
            found.append(Completion(1.0, 0.0))
            continue
        wanted, ends = needs(task)
        until = {function: start + ends[phase - 1] for phase, function in wanted}
        cuts = sorted({*last.values(), *until.values()})
        phase = {k: i for i, k in enumerate(cuts, 1)}
        known = {(phase[k], function) for function, k in last.items()} | start_with
        needed = ((phase[k], function) for function, k in until.items())
        mission = outlook.plant.mission(tuple(sorted(known)), tuple(sorted(needed)))
        found.append(_given(_transition(outlook, mission, hazard[:, : cuts[-1] + 1], cuts)))
        last |= until
        start += len(task.legs)
    return found


def planned(outlook: Outlook, task: Task) -> Steps:
    """Return the exposure that legs of a task will add: stresses as stated, else as recently; nominal as designed."""
    plant, legs = outlook.plant, task.legs
    if not legs:
        return Steps(*np.zeros((2, len(plant.robot.modes), 1)))
    hours, metres = (np.array([getattr(leg, name) for leg in legs]) for name in ("duration", "distance"))
    usage = outlook.future.usage
    advance = np.where(plant.calendar, 1.0, usage)[:, None] * hours
    advance[plant.clock == "operating"] = hours
    advance[plant.clock == "kilometres"] = metres / 1000
    for clock in ("cycles", "starts"):
        stated = np.array([np.nan if (count := getattr(leg, clock)) is None else count for leg in legs])
        rows = plant.clock == clock
        advance[rows] = np.where(np.isnan(stated), advance[rows], stated)
    needed = {functions: plant.needed(functions) for functions in {leg.functions for leg in legs}}
    idle = ~np.array([needed[leg.functions] for leg in legs]).T
    advance *= np.where(idle, plant.duty[:, None], 1.0)
    return Steps(advance, _factors(outlook, task) * advance)


def plan_future(outlook: Outlook, plan: Plan) -> Future:
    """Make a future of tasks repeated for ever, the robot off in between. Raises DesignError where they take no
    time."""
    legs = plan.joined
    takes = plan.every if plan.every is not None else legs.duration / outlook.plant.robot.usage.operating
    if not takes > 0:
        raise DesignError("tasks that take no time cannot go on for ever; expected a duration, or every")
    rest = max(takes - legs.duration, 0.0)
    idle = np.where(outlook.plant.calendar, rest, 0.0)[:, None]
    hours = [leg.duration for leg in legs.legs]
    steps = (np.concatenate((one, idle), axis=1) for one in planned(outlook, legs))
    return Future.of_steps("plan", [*hours, rest], [*hours, 0.0], *steps)


def repetitions(outlook: Outlook, tasks: Sequence[Task], count: int, gap: float = 0.0) -> Iterator[Array]:
    """Repeat a list of tasks again and again, the exposure carried on: the prognostic analysis.

    Yields (probability, failure) of the next repetitions, shape (2, some), given that all before succeeded, until
    ``count`` are done; whoever has seen enough stops asking. It ends before where it is too unlikely, e⁻⁶⁶⁷, that all
    before succeeded. ``gap``: hours of calendar time between two. Raises DesignError where there are no legs.
    """
    task = Task.joined(tasks)
    if not task.legs:
        raise DesignError("tasks: no legs; expected tasks that take time")
    plant = outlook.plant
    wanted, ends = needs(task)
    mission = plant.mission(wanted, tuple((phase + len(ends), function) for phase, function in wanted))
    legs = planned(outlook, task)
    if plant.by_age.all():
        legs, ends = legs.phases(ends), list(range(len(ends)))
    between = np.where(plant.calendar, gap, 0.0)[:, None, None]
    starts = [0, 1, *(end + 3 for end in ends[:-1])]  # what lies before a repetition; its phases, with the gap first
    known = column(mission.of_groups(outlook.known(mission, mission.needed)), 2)
    # What lies before the repetition before, and what that adds in each phase. The first has nothing before it.
    lived, again = np.zeros((len(known), 1)), np.zeros((len(known), len(ends), 1))
    alone = mission.of_groups(mission.needed.astype(float)) > 0  # it has worked till now, or none succeeded
    first, lost = 0.0, False  # ln P(works now); whether it cannot
    most, start = max(1, _AT_ONCE // (2 * legs.advance.size)), 0
    while start < count:
        turn = min(most, max(_FEW, 3 * start))  # what nobody is told is not to be worked out
        k = np.arange(start, min(start + turn, count), dtype=float)
        before, pause, every = np.maximum(k - 1, 0), between * np.minimum(k, 1), np.ones(len(k))
        steps = (
            np.concatenate(
                (one.sum(axis=1)[:, None, None] * k + between * before, pause, one[..., None] * every), axis=1
            )
            for one in legs
        )
        more = mission.of_groups(np.add.reduceat(outlook.gathered(mission, *steps), starts, axis=1))[:, 1:]
        rounds = np.concatenate((again, more), axis=2)
        past = np.cumsum(np.concatenate((lived, rounds.sum(axis=1)[:, :-1]), axis=1), axis=1)
        past[alone] = 0.0
        lived, again = past[:, -1:], rounds[..., -1:]
        earlier = rounds[..., :-1].copy()
        earlier[:, 0] += past[:, :-1]
        phases = np.moveaxis(np.concatenate((earlier, more), axis=1), 1, 0)
        fails, survives = mission.phases.given(known, phases)
        given = np.stack((survives, fails))
        likely = mission.phases.log_known(known, phases)  # that all before succeeded
        if start == 0:
            first = likely[0]
            lost = first == -math.inf
        told = np.full(len(k), True) if lost else likely - first > _FAINTEST
        yield given if told.all() else given[:, : int(np.argmin(told))]
        if not told.all():
            return
        start += turn


def deciding_components(outlook: Outlook, task: Task) -> list[DecidingComponent]:
    """Return the components that a task hangs on, the one that decides most first."""
    if not task.legs:
        return []
    plant = outlook.plant
    wanted, ends = needs(task)
    mission = plant.mission(needed_now(wanted), wanted)
    hazard = outlook.increments(plant.everything, *planned(outlook, task))
    whole = _given(_transition(outlook, mission, hazard, ends)).failure
    found = []
    parts = np.unique(plant.component_of[mission.units])
    turn = max(1, _AT_ONCE // (len(mission.units) * (len(ends) + 1)))
    for start in range(0, len(parts), turn):
        some = parts[start : start + turn]
        failures, _ = _transition(outlook, mission, hazard, ends, without=some)
        for i, failure in zip(some, failures, strict=True):
            share = (whole - float(failure)) / whole if whole > 0 else 0.0
            found.append(DecidingComponent(plant.paths[i], float(failure), max(share, 0.0)))
    return sorted(found, key=lambda one: -one.share)


def with_new_parts(outlook: Outlook, new: Outlook, task: Task, parts: npt.NDArray[np.intp]) -> tuple[Array, Array]:
    """Return P(the task fails) and P(it is completed) with each component in turn replaced; shape (components,).

    ``parts`` are indices of components, none of which is in a group of dependent parts; ``new`` is the outlook of a
    robot whose parts are all new.
    """
    plant = outlook.plant
    if not task.legs:
        return np.zeros(len(parts)), np.ones(len(parts))
    wanted, ends = needs(task)
    mission = plant.mission(needed_now(wanted), wanted)
    steps = planned(outlook, task)
    hazard, instead = (one.increments(plant.everything, *steps) for one in (outlook, new))
    found = np.empty((2, len(parts)))
    turn = max(1, _AT_ONCE // (len(mission.units) * (len(ends) + 1)))
    for start in range(0, len(parts), turn):
        some = parts[start : start + turn]
        found[:, start : start + turn] = _transition(outlook, mission, hazard, ends, some, instead)
    return found[0], found[1]


def needed_now(wanted: Sequence[Need]) -> tuple[Need, ...]:
    """Return the same functions as needed at the start, in phase 0."""
    return tuple(sorted({(0, function) for _, function in wanted}))


def _given(found: tuple[Array, Array]) -> Completion:
    fails, survives = found
    return Completion(float(survives), float(fails))


def _transition(
    outlook: Outlook, mission: Mission, hazard: Array, ends: Sequence[int],
    without: npt.NDArray[np.intp] | None = None, instead: Array | None = None,
) -> tuple[Array, Array]:  # fmt: skip
    """P(a mission is lost) and P(it is completed), given what is known, from what each leg adds to every mode.

    ``ends`` are the last legs of its phases;
    ``without`` the failures of one component after the other, shape (components,); or, of that one, with what each leg
    adds ``instead`` to every mode.
    """
    starts = [0, *(end + 1 for end in ends[:-1])]
    more = mission.of_units(np.add.reduceat(hazard[mission.rows], starts, axis=1))
    known = outlook.known(mission, mission.needed)
    if without is not None:
        others = outlook.plant.component_of[mission.units][:, None] != without
        known = np.where(others, known[:, None], 0.0)
        other = 0.0 if instead is None else mission.of_units(np.add.reduceat(instead[mission.rows], starts, axis=1))
        more = np.where(others[:, None], more[..., None], np.asarray(other)[..., None])
    return mission.phases.given(mission.of_groups(known), np.moveaxis(mission.of_groups(more), 1, 0))


def _factors(outlook: Outlook, task: Task) -> Array:
    """Stress factor of every mode in every leg, shape (modes, legs): as stated, else as recently."""
    plant, legs = outlook.plant, task.legs
    if outlook.inputs is None:
        return np.ones((len(plant.robot.modes), len(legs)))
    factor = np.repeat(outlook.future.factor[:, None], len(legs), axis=1)
    names = {key.rpartition("/")[2] for leg in legs for key in leg.stresses}
    known: dict[object, Array] = {}
    for i, mode in enumerate(plant.robot.modes) if names else ():
        part = plant.robot.part_of(mode)
        stated = {
            (k, name): tuple(leg.stated(mode.origin, part, drivers) for leg in legs)
            for k, stress in enumerate(mode.stresses) for name, drivers in stress.drivers.items()
            if any(driver.name in names for driver in drivers)
        }  # fmt: skip
        somewhere = [any(values[k] is not None for values in stated.values()) for k in range(len(legs))]
        if any(somewhere):
            key = tuple(stress.key for stress in mode.stresses), tuple(sorted(stated.items()))
            if key not in known:
                known[key] = _stated_factor(mode, stated, outlook.inputs)
            factor[i, somewhere] = known[key][somewhere]
    return factor


def _stated_factor(
    mode: FailureMode, stated: Mapping[tuple[int, str], Sequence[float | None]], recent: Mapping[str, float]
) -> Array:
    """Stress factor ψ in every leg: from the inputs that it states, else those measured of late, else the design's."""
    product = np.ones(())
    for k, stress in enumerate(mode.stresses):
        own = {name: values for (of, name), values in stated.items() if of == k}
        product = product * stress.factor(dict(_inputs(stress, own, recent))).value
    return product


def _inputs(
    stress: Stress, stated: Mapping[str, Sequence[float | None]], recent: Mapping[str, float]
) -> Iterator[tuple[str, Array]]:
    for name, at_design in stress.design.items():
        channel = stress.channels.get(name)
        otherwise = recent.get(channel_key(channel), at_design) if channel else at_design
        if name in stated:
            yield name, np.array([otherwise if one is None else one for one in stated[name]], dtype=float)
        elif channel:
            yield name, np.array(float(otherwise))
