"""Identities and traits of parts, by which they are told from one another when a design has changed."""

from __future__ import annotations

import hashlib
from typing import NamedTuple

from robophm.design.robot import Component, Robot, Stress

TRAITS = (
    "description", "number of parts", "names of failure modes", "rate", "life, clock or scaling",
    "initial exposure or uncertainty", "model", "inputs of models", "sensors", "wear signal or measured clock",
)  # fmt: skip
"""Names of a part's traits, in their order."""

DIGITS = 6
"""Hexadecimal digits by which each trait of a part is kept."""


class PartIdentity(NamedTuple):
    """A part, or a common cause, as a ledger knows it from one design to the next."""

    path: str
    identity: str
    identified: bool
    """Whether the design states the identity itself, so that there is nothing to be asked about it."""
    modes: tuple[str, ...]
    """Keys of its failure modes."""
    members: tuple[str, ...]
    """Keys of the members' modes as which the modes of a common cause age, in their order; empty for a part."""
    traits: tuple[str, ...]
    """Digests of its traits: two parts are the more alike, the more of these are equal. Empty for a common cause."""


def identities(robot: Robot) -> tuple[PartIdentity, ...]:
    """Return the identities of a robot's parts and common causes, in design order."""
    keys = {mode.path: mode.key for mode in robot.modes}
    said: dict[int, str] = {}  # equal parts share their stresses
    return tuple(
        PartIdentity(
            part.path,
            part.identity,
            part.identified,
            tuple(mode.key for mode in part.modes),
            tuple(keys[mode.member] for mode in part.modes) if part.members else (),
            () if part.members else _traits(part, said),
        )
        for part in robot.all_components()
    )


def _traits(part: Component, said: dict[int, str]) -> tuple[str, ...]:
    """Digests of what a part is, apart from its place and its names."""
    modes = part.modes
    stresses = [stress for mode in modes for stress in mode.stresses]
    return tuple(
        hashlib.sha256(repr(trait).encode()).hexdigest()[:DIGITS]
        for trait in (
            part.description,
            (part.quantity, part.required),
            [mode.path.removeprefix(part.path) for mode in modes],
            [mode.rate for mode in modes],
            [(repr(mode.life), mode.clock, mode.scaling) for mode in modes],
            [(mode.initial_exposure, mode.uncertainty) for mode in modes],
            [(stress.model.name, stress.model.formula) for stress in stresses],
            [_inputs(stress, said) for stress in stresses],
            [sorted(stress.channels.items()) for stress in stresses],
            [(mode.wear, mode.measured_clock) for mode in modes],
        )
    )


def _inputs(stress: Stress, said: dict[int, str]) -> str:
    found = said.get(id(stress))
    if found is None:
        found = said[id(stress)] = repr(sorted(stress.design.items()))
    return found
