"""Which way of solving fits a group; what has none is refused in words."""

from __future__ import annotations

from collections.abc import Sequence

from robophm.blocks.diagram import Group, LoadSharing, Standby
from robophm.core.errors import StructureError
from robophm.groups.chain import Chain
from robophm.groups.member import Member, alike
from robophm.groups.path import Path
from robophm.groups.positions import Positions
from robophm.groups.sequence import InOrder
from robophm.groups.sharing import Sharing
from robophm.groups.state import Solved


def solve(
    group: Group, members: Sequence[Member], path: Path, now: float, status: Sequence[bool | None] | None = None
) -> Solved:
    """A group along a path from its start on; what ``status`` says of each member is known ``now``.

    Raises StructureError where the group has no exact solution.
    """
    status = [None] * len(members) if status is None else status
    assert isinstance(group, Standby | LoadSharing)
    if all(mode.constant_rate for member in members for mode in member):
        return Chain(group, members, path, now, status)
    if isinstance(group, Standby) and group.active == 1:
        return InOrder(group, members, path, now, status)
    cold = not any(mode.always for member in members for mode in member) and getattr(group, "dormancy", 1.0) == 0
    if isinstance(group, Standby) and cold and alike(members, path):
        return Positions(group, members, path, now, status)
    if isinstance(group, LoadSharing) and len(group.factors) == 2 and alike(members, path):
        return Sharing(group, members, path, now, status)
    raise StructureError(
        f"{group.name}: {_words(group)} parts that age, or differ in age, has no exact solution; "
        "expected constant rates, or its chance by simulation: robophm show DESIGN --monte-carlo 100000"
    )


def _words(group: Standby | LoadSharing) -> str:
    if isinstance(group, Standby):
        return f"standby with {group.active} active of {len(group.members)}"
    return f"load shared by {len(group.members)}, {group.k} needed, of"
