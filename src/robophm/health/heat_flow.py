"""Temperatures that contradict each other: heat flows outwards from what works, and one air has one temperature."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, combinations, product
from typing import NamedTuple

from robophm.design.robot import Channel
from robophm.health.measured_inputs import MeasuredInput

TEMPERATURE_ACCURACY = 3.0
"""Difference of two temperature sensors that is no news [K]: each of them may be off by half of it."""

ONE_AIR = 10.0
"""Difference that two sensors of the same surroundings may have [K]: warmer here, colder there.

Eight rooms of a house were never further apart than 7.6 K over 137 days, the air at its wall never further from that
at an airport 12 km away than 6.7 K (``python -m benchmarks.lying_sensors``).
"""

CORES = frozenset(("junction", "winding", "windings", "hot", "spot", "die", "core", "coil"))
"""Words of what is hottest in a machine or a chip, in the names of parts and inputs."""

SURFACES = frozenset(("case", "housing", "frame", "surface", "shell", "heat", "sink", "heatsink", "skin"))
"""Words of its outside."""


class Contradiction(NamedTuple):
    """A temperature of a channel that cannot be true together with something else."""

    key: str
    """The key of the channel."""
    why: str
    """A sentence without its subject."""
    otherwise: str
    """The condition under which ``instead`` is what is true."""
    instead: float | None
    """The value that would fit, in the unit of the model's input; None: that it is silent."""


Inputs = Mapping[str, Sequence[MeasuredInput]]


class _Place(NamedTuple):
    """What a temperature is measured of."""

    key: str
    reading: float
    """The temperature where the sensor is [degC]."""
    rise: float
    """How much warmer the input of the channel's key is [K]."""


def against_heat_flow(
    inputs: Inputs, channels: Mapping[str, Channel], recent: Mapping[str, float]
) -> list[Contradiction]:
    """Return the temperatures of a robot that works that contradict each other.

    One of two is then colder than what is around it, or they are of one air and far apart. ``recent``: means of
    channels, by their keys, over the last minutes.
    """
    places = {
        key: _Place(key, recent[key] - (own[0].rise or 0.0), own[0].rise or 0.0)
        for key, own in inputs.items()
        if own[0].unit == "degC" and key in recent
    }
    found: dict[tuple[str, str], list[Contradiction]] = {}
    for nested, pairs in ((True, chain(_around(inputs), _cases(inputs))), (False, _same_air(inputs))):
        for one, other in pairs:
            signals = channels[one].signal, channels[other].signal
            if one not in places or other not in places or signals[0] == signals[1] or signals in found:
                continue
            inside, outside = places[one], places[other]
            if nested and inside.reading < outside.reading - TEMPERATURE_ACCURACY:
                found[signals] = [*_colder(inside, outside, *signals)]
            elif not nested and abs(inside.reading - outside.reading) > ONE_AIR:
                found[signals] = [_apart(inside, outside, signals[1]), _apart(outside, inside, signals[0])]
    return [one for both in found.values() for one in both]


def _colder(inside: _Place, outside: _Place, inner: str, outer: str) -> Iterator[Contradiction]:
    less, right = f"{outside.reading - inside.reading:.3g} °C", "if {} is right".format
    yield Contradiction(
        inside.key, f"reads {less} less than what is around it, {outer}", right(outer), outside.reading + inside.rise
    )
    yield Contradiction(
        outside.key, f"reads {less} more than what is inside, {inner}", right(inner), inside.reading + outside.rise
    )


def _apart(one: _Place, other: _Place, signal: str) -> Contradiction:
    by = one.reading - other.reading
    why = f"reads {abs(by):.3g} °C {'more' if by > 0 else 'less'} than {signal}, which is in the same surroundings"
    return Contradiction(one.key, why, f"if {signal} is right", other.reading + one.rise)


def _airs(inputs: Inputs) -> dict[str, dict[str, bool]]:
    """Sensors of the air of each level, by their keys, and whether they are the level's, not those of one part."""
    found: dict[str, dict[str, bool]] = {}
    for key, own in inputs.items():
        shared = len({one.part for one in own}) > 1
        for one in own:
            if one.rise is not None:
                found.setdefault(one.level, {})[key] = shared
    return found


def _around(inputs: Inputs) -> Iterator[tuple[str, str]]:
    """What lies in the air that a sensor measures: parts of its level, and parts and the air of the levels below it."""
    airs = _airs(inputs)
    for key, own in inputs.items():
        for one in dict.fromkeys(one for one in own if one.unit == "degC"):
            levels = [level for level in airs if _within(one.level, level)]
            for level in levels:
                if level == one.level:
                    yield from ((key, outer) for outer in airs[level] if one.own)
                else:  # the sensor of one part tells nothing of levels below
                    yield from (
                        (key, outer) for outer, shared in airs[level].items() if shared and key not in airs[level]
                    )


def _within(level: str, outer: str) -> bool:
    return not outer or level == outer or level.startswith(f"{outer}/")


def _cases(inputs: Inputs) -> Iterator[tuple[str, str]]:
    """What is hottest in something, and its outside: names of parts and inputs that are otherwise the same."""
    found: dict[tuple[str, frozenset[str]], tuple[dict[str, None], dict[str, None]]] = {}
    for key, own in inputs.items():
        for one in (one for one in own if one.own):
            words = frozenset(
                re.split(r"[\s_.-]+", f"{one.part.removeprefix(one.level).strip('/')} {one.name}".casefold())
            )
            for place, names in enumerate((CORES, SURFACES)):
                if words & names:
                    found.setdefault((one.level, words - names), ({}, {}))[place][key] = None
    for cores, surfaces in found.values():
        yield from product(cores, surfaces)


def _same_air(inputs: Inputs) -> Iterator[tuple[str, str]]:
    for keys in _airs(inputs).values():
        yield from combinations(keys, 2)
