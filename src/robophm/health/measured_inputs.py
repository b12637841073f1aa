"""Inputs of models that the channels of a design measure, and the parts that they belong to."""

from __future__ import annotations

from typing import NamedTuple

from robophm.design.robot import Robot
from robophm.health.stress_groups import channel_key


class MeasuredInput(NamedTuple):
    """A model input that a channel measures, and the part that it belongs to."""

    part: str
    """Path of the part."""
    model: str
    name: str
    unit: str
    own: bool
    """Whether it is the part's own temperature, and not that of its surroundings."""
    around: bool
    """Whether it is the temperature of the part's surroundings."""


def measured_inputs(robot: Robot) -> dict[str, list[MeasuredInput]]:
    """Return what each channel, by its key, measures."""
    found: dict[str, list[MeasuredInput]] = {}
    for component in robot.all_components():
        for stress in (stress for mode in component.modes for stress in mode.measured):
            for name, channel in stress.channels.items():
                entry = stress.model.numbers[name]
                warm = entry.unit == "degC"
                around = warm and (entry.warmth == "ambient" or (entry.warmth == "own" and channel.stress != name))
                one = MeasuredInput(component.path, stress.model.name, name, entry.unit, warm and not around, around)
                found.setdefault(channel_key(channel), []).append(one)
    return found
