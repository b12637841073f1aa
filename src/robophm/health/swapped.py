"""A robot of which a part that may have failed unseen is put in new: what it did till now was done with the old part.

That the robot works now says something of the other parts too: if this one has failed, they must work. So that is not
forgotten, the old part stands in what is known, and the new one in what is wanted.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block, Unit, with_blocks
from robophm.blocks.merging import merge_series, single_points_of_failure
from robophm.blocks.phases import Phases
from robophm.blocks.reliability import Transition
from robophm.core.waiting_time import mean_time, time_at
from robophm.design.task import Task
from robophm.health.mission import needs, planned
from robophm.health.plant import Parts
from robophm.health.prognosis import Outlook

Array = npt.NDArray[np.float64]

_NEW = "\0new"  # no name of a part has a control character


class Swapped:
    """An outlook with one component, by its index, put in new now; ``fresh`` is that of all parts new."""

    def __init__(self, outlook: Outlook, fresh: Outlook, component: int) -> None:
        self._outlook, self._fresh = outlook, fresh
        self._units = frozenset(outlook.plant.components[component].units)

    def failure(self, task: Task) -> float | None:
        """P(the task fails | the functions that it needs work now, with the old part); None where they cannot."""
        plant = self._outlook.plant
        wanted, ends = needs(task)
        diagrams = {function: plant.diagram(function) for _, function in wanted}
        joint = _Joint(self, [(phase, diagrams[function]) for phase, function in wanted])
        starts = [0, *(end + 1 for end in ends[:-1])]
        steps = planned(self._outlook, task)
        more = [
            np.add.reduceat(joint.parts.of_units(one.increments(joint.parts, *steps)), starts, axis=1)
            for one in (self._outlook, self._fresh)
        ]
        found = joint.transition(*(np.moveaxis(one, 1, 0)[..., None] for one in more))
        return float(found.given_works()[0][0]) if found.failed[0] < 1 else None

    def life(self, diagram: Block) -> tuple[float, float] | None:
        """Median and mean remaining life; None where the system cannot work now with the old part."""
        joint = _Joint(self, [(1, diagram)])
        course, parts = self._outlook.course, joint.parts
        along = [one.along(parts, course) for one in (self._outlook, self._fresh)]
        groups = self._outlook.groups_along(parts, course)

        def ahead(hours: Array) -> Transition:
            both = (np.concatenate((one(hours)[..., 0], groups(hours))) for one in along)
            return joint.transition(*(parts.of_units(one)[None] for one in both))

        def curve(hours: Array) -> tuple[Array, Array]:
            return ahead(hours).given_works()

        if not ahead(np.zeros(1)).survives[0] > 0:
            return None
        return float(time_at(curve, [0.5], [0.5])[0]), mean_time(curve)


class _Joint:
    """What must work, with the new part, given that the same works now with the old one."""

    def __init__(self, swapped: Swapped, wanted: Sequence[tuple[int, Block]]) -> None:
        outlook, new = swapped._outlook, swapped._units
        plant = outlook.plant
        known = list({id(block): block for _, block in wanted}.values())
        renamed: dict[int, Block] = {}
        ahead = [_with_new(block, new, renamed) for _, block in wanted]
        diagrams, stands_for = merge_series(*known, *ahead)
        needed = list(zip((phase for phase, _ in wanted), diagrams[len(known) :], strict=True))
        self.phases = Phases([(0, block) for block in diagrams[: len(known)]], needed)
        groups = [stands_for[name] for name in self.phases.names]
        self.parts = Parts(plant, [[name.removesuffix(_NEW) for name in group] for group in groups])
        drawn = [name for group in groups for name in group]
        self._new = np.array([name.endswith(_NEW) for name in drawn])
        fatal = single_points_of_failure(*known)
        self._known = outlook.known(self.parts, np.array([name in fatal for name in drawn]))
        self._known[self._new] = 0.0

    def transition(self, more: Array, instead: Array) -> Transition:
        """What becomes of it, from what each phase adds to each unit, old and new; shape (phases, units, columns)."""
        added = self.parts.of_groups(np.moveaxis(np.where(self._new[:, None], instead, more), 1, 0))
        known = self.parts.of_groups(self._known)[:, None]
        return self.phases.transition(known, np.moveaxis(added, 1, 0))


def _with_new(block: Block, units: frozenset[str], done: dict[int, Block]) -> Block:
    """The same diagram with the new part in the places of the old; each block once."""
    if id(block) not in done:
        if isinstance(block, Unit):
            done[id(block)] = Unit(block.name + _NEW) if block.name in units else block
        else:
            done[id(block)] = with_blocks(block, [_with_new(one, units, done) for one in block.blocks])
    return done[id(block)]
