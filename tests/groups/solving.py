"""Groups put along a straight path, for the tests here."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robophm.blocks.diagram import LoadSharing, Standby, equal_share
from robophm.groups.member import Mode
from robophm.groups.path import Path
from robophm.groups.solve import solve
from robophm.groups.solved_group import SolvedGroup
from robophm.life.distribution import LifeDistribution


def names(n: int) -> tuple[tuple[str, ...], ...]:
    return tuple((f"part {i}",) for i in range(n))


def standby(n: int, active: int = 1, dormancy: float = 0.0, switch: float = 1.0) -> Standby:
    return Standby("standby", names(n), active, dormancy, switch)


def sharing(n: int, k: int, exponent: float) -> LoadSharing:
    return LoadSharing("load sharing", names(n), k, equal_share(n, k, exponent))


def solved(
    group: Standby | LoadSharing, lives: Sequence[LifeDistribution], *, now: float = 0.0,
    status: Sequence[bool | None] | None = None, way: type | None = None,
) -> SolvedGroup:  # fmt: skip
    """All age by one hour in each hour."""
    path = Path(len(lives))
    path.add(np.ones(len(lives)))
    members = [[Mode(i, life)] for i, life in enumerate(lives)]
    if way:
        found: SolvedGroup = way(group, members, path, now, status or [None] * len(lives))
        return found
    return solve(group, members, path, now, status)


def works(of: SolvedGroup, *times: float) -> np.ndarray:
    return np.exp(of.log_works(np.array(times)))


def fails(of: SolvedGroup, *times: float) -> np.ndarray:
    return np.exp(of.log_fails_in(np.zeros(len(times)), np.array(times)))
