"""A part that may have failed unseen, replaced: what its robot did till now was done with the old one.

That the robot works now says something of the other parts too: if this one has failed, they must work. So that is not
forgotten, the old part stands in what is known, and the new one in what is wanted.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Block, Unit, with_blocks
from robophm.blocks.merging import merge_series
from robophm.blocks.phases import Phases
from robophm.blocks.single_points import single_points_of_failure
from robophm.health.plant import Parts
from robophm.health.prognosis import Outlook

Array = npt.NDArray[np.float64]

_NEW = "\0new"  # no name of a part has a control character


class WhatIfReplaced:
    """Diagrams that must work until the end of phases from 1 on, with some units replaced now.

    Given that the same diagrams work now, with the old units in them, and what else an outlook knows.
    """

    def __init__(self, outlook: Outlook, wanted: Sequence[tuple[int, Block]], units: Sequence[str]) -> None:
        known = list({id(block): block for _, block in wanted}.values())
        renamed: dict[int, Block] = {}
        ahead = [_with_new(block, frozenset(units), renamed) for _, block in wanted]
        diagrams, stands_for = merge_series(*known, *ahead)
        needed = list(zip((phase for phase, _ in wanted), diagrams[len(known) :], strict=True))
        self._phases = Phases([(0, block) for block in diagrams[: len(known)]], needed)
        groups = [stands_for[name] for name in self._phases.names]
        self.parts = Parts(outlook.plant, [[name.removesuffix(_NEW) for name in group] for group in groups])
        """Parts of the plant, old units and new ones."""
        drawn = [name for group in groups for name in group]
        self._new = np.array([name.endswith(_NEW) for name in drawn])
        fatal = single_points_of_failure(*known)
        self._known = outlook.known(self.parts, np.array([name in fatal for name in drawn]))
        self._known[self._new] = 0.0
        nothing = np.zeros((max(phase for phase, _ in wanted), len(groups)))
        self.may_work = bool(self._phases.log_known(self.parts.of_groups(self._known), nothing) > -np.inf)
        """Whether the diagrams can work now, by what is known."""

    def given(self, more: Array, instead: Array) -> tuple[Array, Array]:
        """P(they fail) and P(they work until then), given that they work now; 1 and 0 where they cannot. Shape (...).

        From what each phase adds to the cumulative hazard of each of ``parts``, as an old unit and ``instead`` as a new
        one; shape (units, phases, ...).
        """
        new = self._new.reshape(-1, *[1] * (more.ndim - 1))
        added = np.moveaxis(self.parts.of_groups(np.where(new, instead, more)), 1, 0)
        known = self.parts.of_groups(self._known).reshape(-1, *[1] * (more.ndim - 2))
        return self._phases.given(known, added)


def _with_new(block: Block, units: frozenset[str], done: dict[int, Block]) -> Block:
    """The same diagram with new units in the places of the old; each block once."""
    if id(block) not in done:
        if isinstance(block, Unit):
            done[id(block)] = Unit(block.name + _NEW) if block.name in units else block
        else:
            done[id(block)] = with_blocks(block, [_with_new(one, units, done) for one in block.blocks])
    return done[id(block)]
