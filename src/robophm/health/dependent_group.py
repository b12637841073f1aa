"""A group of parts that depend on each other, prepared: its failure modes, and how its members age at first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from robophm.blocks.diagram import Group, Standby
from robophm.groups.member import Mode
from robophm.groups.path import Path
from robophm.groups.solve import solve
from robophm.life.distribution import LifeDistribution

Array = npt.NDArray[np.float64]

ModeOf = tuple[int, LifeDistribution, float, bool]
"""A failure mode of a member: its index among the robot's, its life, how many equal parts in series it is of, and
whether it ages whoever works."""


class DependentGroup:
    """A group of a robot, with the failure modes of its members."""

    def __init__(self, group: Group, members: Sequence[Sequence[ModeOf]]) -> None:
        self.group = group
        self.modes = np.array(sorted({mode for member in members for mode, *_ in member}), dtype=np.intp)
        """Indices among the robot's, ascending; the order of all arrays below."""
        column = {int(mode): i for i, mode in enumerate(self.modes)}
        self._members = [
            [(column[mode], life, count, always) for mode, life, count, always in member] for member in members
        ]
        # The share at which each member ages before anything has failed.
        spares = len(members) - group.active if isinstance(group, Standby) else 0
        self._shares = [1.0] * (len(members) - spares) + [getattr(group, "dormancy", 1.0)] * spares
        nothing = np.zeros(len(self.modes))
        new = self.members(nothing, nothing)
        self.ages = not all(mode.constant_rate for member in new for mode in member)
        """Whether the age of a member matters, because a rate changes with it."""
        solve(group, new, Path(len(self.modes)), 0.0)  # refused if it has to be

    def members(self, new: Array, gained: Array) -> list[list[Mode]]:
        """The members with their failure modes: from ages on, after what would be gained by working all the time."""
        return [
            [
                Mode(i, life, float(new[i] + (1.0 if always else share) * gained[i]), count, always)
                for i, life, count, always in member
            ]
            for member, share in zip(self._members, self._shares, strict=True)
        ]
