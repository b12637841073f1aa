"""The choice of an exact solution for a group; a group that has none is refused in words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from robophm.blocks.diagram import Group, LoadSharing, Standby
from robophm.core.errors import StructureError
from robophm.groups.markov_chain import Chain
from robophm.groups.member import Member, alike
from robophm.groups.path import Path
from robophm.groups.series_of_parts import SeriesOfParts
from robophm.groups.shared_load import SharedLoad
from robophm.groups.solved_group import SolvedGroup
from robophm.groups.standby_one_active import OneActiveStandby
from robophm.groups.standby_several_active import SeveralActiveStandby

Way = Callable[[Sequence[Member], Path, float, Sequence[bool | None] | None], SolvedGroup]
"""A way of solving a group: from its members, a path, and what is known of each member at some time of it."""


def solve(
    group: Group, members: Sequence[Member], path: Path, now: float, status: Sequence[bool | None] | None = None
) -> SolvedGroup:
    """Solve a group along a path from its start on; what ``status`` says of each member is known ``now``.

    Raises StructureError where the group has no exact solution.
    """
    status = [None] * len(members) if status is None else status
    assert isinstance(group, Standby | LoadSharing)
    if all(mode.constant_rate for member in members for mode in member):
        return Chain(group, members, path, now, status)
    if isinstance(group, Standby) and group.active == 1:
        return OneActiveStandby(group, members, path, now, status)
    cold = not any(mode.always for member in members for mode in member) and getattr(group, "dormancy", 1.0) == 0
    if isinstance(group, Standby) and cold and alike(members[group.active :], path):
        return SeveralActiveStandby(group, members, path, now, status)
    if isinstance(group, LoadSharing) and len(group.factors) == 2 and alike(members, path):
        return SharedLoad(group, members, path, now, status)
    raise StructureError(
        f"{group.name}: {_words(group)} parts that age, or differ in age, has no exact solution; "
        "expected constant rates, or an estimate by simulation"
    )


def left(group: Group, failed: frozenset[int]) -> Way:
    """Return the way of solving what is left of a group that works although these of its members have failed."""
    assert isinstance(group, Standby | LoadSharing)
    alive = tuple(member for i, member in enumerate(group.members) if i not in failed)
    factor = group.factors[len(failed)] if isinstance(group, LoadSharing) else 1.0
    if len(alive) == (group.k if isinstance(group, LoadSharing) else group.active):
        return lambda members, path, now, status: SeriesOfParts(factor, members, path)
    if isinstance(group, LoadSharing):
        return partial(solve, replace(group, members=alive, factors=group.factors[len(failed) :]))
    return partial(solve, replace(group, members=alive))


def fewest_failed(group: Group, members: Sequence[Member], status: Sequence[bool | None]) -> frozenset[int] | None:
    """Return the fewest members that have failed if ``status`` is so; None where the group then has, or it cannot be.

    A spare that does not age while it waits fails only where it was called: then those before it have failed, too.
    """
    failed = {i for i, said in enumerate(status) if said is False}
    if isinstance(group, LoadSharing):
        return frozenset(failed) if len(members) - len(failed) >= group.k else None
    assert isinstance(group, Standby)
    rests = [not group.dormancy and not any(mode.always for mode in member) for member in members]

    def idle() -> int | None:
        return next((i for t, i in enumerate(sorted(failed)) if rests[i] and i - t >= group.active), None)

    while (spare := idle()) is not None:
        before = [i for i in range(spare) if status[i] is None and i not in failed]
        if not before:
            return None
        failed.add(before[0])
    called = min(failed, default=len(members)) < group.active
    works = len(members) - len(failed) >= group.active and (group.switch > 0 or not called)
    return frozenset(failed) if works else None


def _words(group: Standby | LoadSharing) -> str:
    if isinstance(group, Standby):
        return f"standby with {group.active} active of {len(group.members)}"
    return f"load shared by {len(group.members)}, {group.k} needed, of"
